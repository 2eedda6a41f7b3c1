// Names for widgets, so that tests (and coach marks) find them on the screen at any size.
#pragma once

#include <imgui.h>

#include <string>
#include <string_view>
#include <unordered_map>

namespace dapple {

struct ItemMark {
  ImVec2 min, max;  // pixels; what of the item can be seen
  bool visible;     // something can be
  bool enabled;
};

// The marks of one frame; GuiContext keeps them.
class ItemMarks {
 public:
  void clear() { marks_.clear(); }
  void set(std::string_view id, const ItemMark& mark) { marks_[std::string(id)] = mark; }
  // Null when no item of this name was drawn.
  const ItemMark* find(std::string_view id) const {
    const auto found = marks_.find(std::string(id));
    return found == marks_.end() ? nullptr : &found->second;
  }
  const std::unordered_map<std::string, ItemMark>& all() const { return marks_; }

 private:
  std::unordered_map<std::string, ItemMark> marks_;
};

// Names the item just drawn: markItem("start.open-sample").
void markItem(std::string_view id);
// Names a rectangle that is no item of ImGui's, such as the viewport.
void markRectangle(std::string_view id, const ImVec2& min, const ImVec2& max);

}  // namespace dapple
