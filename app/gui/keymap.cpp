#include "app/gui/keymap.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

namespace dapple {
namespace {

using nlohmann::json;

// Nothing when the value is neither a string nor a list of strings.
std::optional<std::vector<std::string>> names(const json& value) {
  if (value.is_string()) return std::vector<std::string>{value.get<std::string>()};
  if (!value.is_array()) return {};
  std::vector<std::string> result;
  for (const json& name : value) {
    if (!name.is_string()) return {};
    result.push_back(name.get<std::string>());
  }
  return result;
}

void applyEntry(ActionTable& table, const std::string& id, const json& value,
                std::vector<std::string>& warnings) {
  if (table.find(id) == nullptr) {
    warnings.push_back(fmt::format("keymap: there is no action \"{}\"; left out", id));
    return;
  }
  const auto texts = names(value);
  if (!texts) {
    warnings.push_back(
        fmt::format("keymap: \"{}\" needs a list of keys such as [\"Ctrl+Z\"]; left out", id));
    return;
  }
  std::vector<Shortcut> keys;
  for (const std::string& text : *texts) {
    if (const std::optional<Shortcut> key = parseShortcut(text))
      keys.push_back(*key);
    else
      warnings.push_back(
          fmt::format("keymap: \"{}\" is no key that can be had, for \"{}\"; write "
                      "it like Ctrl+Shift+Z, F1, [ or Numpad 1",
                      text, id));
  }
  if (keys.empty() && !texts->empty()) return;  // nothing usable: the keys it had are better
  table.setShortcuts(id, std::move(keys));
}

}  // namespace

std::vector<std::string> applyKeymap(ActionTable& table, std::string_view text) {
  std::vector<std::string> warnings;
  const json root = json::parse(text, nullptr, false, true);
  if (root.is_discarded() || !root.is_object()) {
    warnings.push_back(
        "keymap: it is no JSON object like {\"edit.undo\": [\"Ctrl+Z\"]}; the keys stay as they "
        "are");
    return warnings;
  }
  for (const auto& [id, value] : root.items()) applyEntry(table, id, value, warnings);

  std::set<std::pair<std::string, std::string>> told;
  for (const auto& [id, value] : root.items())
    for (const std::string& other : table.conflictsOf(id))
      if (told.insert(std::minmax(id, other)).second)
        warnings.push_back(
            fmt::format("keymap: \"{}\" and \"{}\" share a key ({}); the one that can be done "
                        "first in the menus gets it",
                        id, other, table.keysOf(id)));
  return warnings;
}

std::string keymapJson(const ActionTable& table, bool all) {
  nlohmann::ordered_json root = nlohmann::ordered_json::object();
  for (const Action& action : table.all()) {
    const std::vector<Shortcut>& keys = table.shortcutsOf(action.id);
    if (!all && keys == action.shortcuts) continue;
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Shortcut& key : keys) list.push_back(toString(key));
    root[action.id] = std::move(list);
  }
  return root.dump(2) + "\n";
}

}  // namespace dapple
