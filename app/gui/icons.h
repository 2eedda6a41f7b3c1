// Pictures for buttons, drawn as lines at any size.
#pragma once

#include <imgui.h>

#include <cstdint>

namespace dapple {

enum class Icon : std::uint8_t {
  none,
  brush,
  rectangle,
  lasso,
  polygon,
  wand,
  orientation,  // stroke with an arrow
  eye,
  eyeOff,
  lock,
  unlock,
  plus,
  minus,
  trash,
  undo,
  redo,
  play,
  pause,
  stop,
  folder,
  file,
  save,
  camera,
  search,
  gear,
  grid,  // swatch
  layers,
  frame,
  close,
  chevronRight,
  chevronDown,
  warning,
  error,
  info,
  check,
  up,
  home,
  clock,
  copy,
  points,  // a scan
  eraser,
  fill,
  pick,
  grow,
  shrink,
  invert,
  split,
  exportFile,
  reset,
};
constexpr int kIconCount = static_cast<int>(Icon::reset) + 1;

// Fills the square at `min` of `size` pixels; the drawing keeps a margin of 1/12 of it. Works from
// 12 pixels up.
void drawIcon(ImDrawList& list, Icon icon, ImVec2 min, float size, ImU32 colour);

// An icon as an item of the layout, kIconSize at the UI scale when `size` is 0 pixels.
void iconItem(Icon icon, const ImVec4& colour, float size = 0);

}  // namespace dapple
