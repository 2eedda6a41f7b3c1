// The action table on the screen: menus, buttons, the F1 sheet and the command search.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/gui/actions.h"

namespace dapple {

// The menus inside a menu bar, in the order in which the table first names them. Marks:
// "menu.Edit", "menu-item.edit.undo".
void actionMenus(ActionTable& table);
// One item of a menu or context menu; chosen?
bool actionMenuItem(ActionTable& table, std::string_view id);
// A square button with the action's icon, tooltip, keys and state; the mark is the id. `size` in
// logical pixels, 0 for the usual.
bool actionButton(ActionTable& table, std::string_view id, float size = 0);
// A button with the action's label.
bool actionTextButton(ActionTable& table, std::string_view id, bool primary = false,
                      float width = 0);

// How well `query` matches `text` as a subsequence, case aside: higher is better, 0 is no match.
// Beginnings of words and runs count more.
int fuzzyScore(std::string_view query, std::string_view text);
// Ids that match, best first; recently used first where equal, and with an empty query. Only those
// with a label.
std::vector<std::string> searchActions(const ActionTable& table, std::string_view query);

// F1: every action with a key, by group, searchable. Rows that are no action ("RMB-drag", "Orbit")
// may be added.
class ShortcutSheet {
 public:
  struct Extra {
    std::string group, keys, label;
  };
  void open() { wanted_ = true; }
  bool isOpen() const { return open_; }
  void draw(const ActionTable& table, const std::vector<Extra>& extras = {});

 private:
  bool wanted_ = false, open_ = false;
  std::string query_;
};

// Ctrl+K: type, arrows, Enter.
class CommandSearch {
 public:
  void open() { wanted_ = true; }
  bool isOpen() const { return open_; }
  void draw(ActionTable& table);

 private:
  void drawRow(const ActionTable& table, const Action& action, int index);

  bool wanted_ = false, open_ = false, scroll_ = false;
  std::string query_;
  int chosen_ = 0;
  std::string run_;
};

}  // namespace dapple
