// Everything the user can do, in one table: menus, shortcuts, help, command search and tests read
// it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "app/gui/icons.h"
#include "app/gui/shortcut.h"

namespace dapple {

struct Action {
  std::string id;     // "edit.undo"; never changes, keymaps name it
  std::string label;  // "Undo"; ends in "..." when it asks more
  std::string menu;   // "Edit", or "View/Shading" for a submenu; empty: only by key and search
  std::vector<Shortcut> shortcuts = {};  // defaults; the first is shown
  std::string help = {};                 // a sentence for tooltip and search
  Icon icon = Icon::none;
  std::string group = {};              // heading on the F1 sheet; empty: the menu's first part
  bool repeats = false;                // while its key is held
  bool separatorBefore = false;        // in its menu
  std::function<bool()> enabled = {};  // empty: always
  std::function<bool()> checked = {};  // empty: no check mark
  std::function<void()> run = {};
};

// "Ctrl+Z, Ctrl+Y" for a table written in code. Throws Bug for what is no shortcut.
std::vector<Shortcut> shortcuts(std::string_view commaSeparated);

class ActionTable {
 public:
  // In the order of the menus. Throws Bug for an id twice.
  void add(Action action);

  const std::vector<Action>& all() const { return actions_; }
  const Action* find(std::string_view id) const;
  // As remapped; empty without one.
  const std::vector<Shortcut>& shortcutsOf(std::string_view id) const;
  // The first, "" for none: what menus and tooltips show.
  std::string keysOf(std::string_view id) const;
  void setShortcuts(std::string_view id, std::vector<Shortcut> keys);
  void resetShortcuts();  // to the defaults
  // For an action that is about something else now. Empty: neither menus nor search have it.
  void setLabel(std::string_view id, std::string label);
  // Ids of others that have one of the action's shortcuts.
  std::vector<std::string> conflictsOf(std::string_view id) const;

  bool isEnabled(std::string_view id) const;
  bool isChecked(std::string_view id) const;
  // Runs it if it is there and enabled; tells whether. Remembers it as used.
  bool run(std::string_view id);
  // Newest first, at most 16 ids.
  const std::vector<std::string>& recent() const { return recent_; }

  // Runs what the keys of this frame ask for: one action at most, none while text is typed or
  // `blocked` (a dialog is open). Returns its id or "". Call it once a frame.
  std::string dispatch(bool blocked = false);

 private:
  std::size_t indexOf(std::string_view id) const;

  std::vector<Action> actions_;
  std::vector<std::vector<Shortcut>> keys_;  // parallel to actions_
  std::vector<std::string> recent_;
};

}  // namespace dapple
