#include "app/gui/actions.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kRecentActions = 16;

}  // namespace

std::vector<Shortcut> shortcuts(std::string_view commaSeparated) {
  std::vector<Shortcut> result;
  while (!commaSeparated.empty()) {
    // A comma may be the key itself: it is no separator where a shortcut must begin.
    std::size_t comma = commaSeparated.find(',', 1);
    if (comma == std::string_view::npos) comma = commaSeparated.size();
    const std::string_view text = commaSeparated.substr(0, comma);
    const std::optional<Shortcut> shortcut = parseShortcut(text);
    if (!shortcut) throw Bug(fmt::format("\"{}\" is no shortcut", text));
    result.push_back(*shortcut);
    commaSeparated.remove_prefix(std::min(comma + 1, commaSeparated.size()));
  }
  return result;
}

void ActionTable::add(Action action) {
  if (find(action.id) != nullptr) throw Bug(fmt::format("the action {} is there twice", action.id));
  keys_.push_back(action.shortcuts);
  actions_.push_back(std::move(action));
}

std::size_t ActionTable::indexOf(std::string_view id) const {
  const auto found = std::find_if(actions_.begin(), actions_.end(),
                                  [&](const Action& action) { return action.id == id; });
  return static_cast<std::size_t>(found - actions_.begin());
}

const Action* ActionTable::find(std::string_view id) const {
  const std::size_t index = indexOf(id);
  return index < actions_.size() ? &actions_[index] : nullptr;
}

const std::vector<Shortcut>& ActionTable::shortcutsOf(std::string_view id) const {
  static const std::vector<Shortcut> none;
  const std::size_t index = indexOf(id);
  return index < actions_.size() ? keys_[index] : none;
}

std::string ActionTable::keysOf(std::string_view id) const {
  const std::vector<Shortcut>& keys = shortcutsOf(id);
  return keys.empty() ? std::string() : toString(keys.front());
}

void ActionTable::setShortcuts(std::string_view id, std::vector<Shortcut> keys) {
  const std::size_t index = indexOf(id);
  if (index == actions_.size()) throw Bug(fmt::format("there is no action {}", id));
  keys_[index] = std::move(keys);
}

void ActionTable::setLabel(std::string_view id, std::string label) {
  const std::size_t index = indexOf(id);
  if (index == actions_.size()) throw Bug(fmt::format("there is no action {}", id));
  actions_[index].label = std::move(label);
}

void ActionTable::resetShortcuts() {
  for (std::size_t i = 0; i < actions_.size(); ++i) keys_[i] = actions_[i].shortcuts;
}

std::vector<std::string> ActionTable::conflictsOf(std::string_view id) const {
  const std::vector<Shortcut>& own = shortcutsOf(id);
  std::vector<std::string> others;
  for (std::size_t i = 0; i < actions_.size(); ++i) {
    if (actions_[i].id == id) continue;
    const bool shared = std::any_of(own.begin(), own.end(), [&](const Shortcut& key) {
      return std::find(keys_[i].begin(), keys_[i].end(), key) != keys_[i].end();
    });
    if (shared) others.push_back(actions_[i].id);
  }
  return others;
}

bool ActionTable::isEnabled(std::string_view id) const {
  const Action* action = find(id);
  return action != nullptr && action->run && (!action->enabled || action->enabled());
}

bool ActionTable::isChecked(std::string_view id) const {
  const Action* action = find(id);
  return action != nullptr && action->checked && action->checked();
}

bool ActionTable::run(std::string_view id) {
  if (!isEnabled(id)) return false;
  const std::string name(id);
  recent_.erase(std::remove(recent_.begin(), recent_.end(), name), recent_.end());
  recent_.insert(recent_.begin(), name);
  if (recent_.size() > kRecentActions) recent_.pop_back();
  // A copy: what it runs may add actions.
  const std::function<void()> run = find(id)->run;
  run();
  return true;
}

std::string ActionTable::dispatch(bool blocked) {
  const ImGuiIO& io = ImGui::GetIO();
  if (blocked || io.WantTextInput) return {};
  for (std::size_t i = 0; i < actions_.size(); ++i)
    for (const Shortcut& key : keys_[i])
      if (pressed(key, io, actions_[i].repeats)) {
        // Two actions may share a key when only one of them is enabled at a time.
        const std::string id = actions_[i].id;
        if (run(id)) return id;
      }
  return {};
}

}  // namespace dapple
