// The user's own keys: a JSON file {"edit.undo": ["Ctrl+Z"], "view.frame": []}.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/gui/actions.h"

namespace dapple {

// Sets what the text names over the defaults; a single string stands for a list of one, an empty
// list takes all keys away. What cannot be used is left out and told: unknown actions and keys, a
// value of the wrong kind, text that is no JSON, a key of two actions (both keep it).
std::vector<std::string> applyKeymap(ActionTable& table, std::string_view json);
// The actions whose keys are not the defaults, or all of them, as applyKeymap() reads them.
std::string keymapJson(const ActionTable& table, bool all = false);

}  // namespace dapple
