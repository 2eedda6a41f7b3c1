// Where everything is in a frame, and what all parts of the editor's window are made of.
#pragma once

#include <imgui.h>

#include <algorithm>

#include "app/editor/editor.h"

namespace dapple {

// Pixels.
struct Editor::Layout {
  float width, height, menu, status, left, right, uiScale;

  ImVec2 viewMin() const { return {left, menu}; }
  ImVec2 viewSize() const {
    return {std::max(1.f, width - left - right), std::max(1.f, height - menu - status)};
  }
  Viewport viewport() const {
    return {static_cast<int>(viewSize().x), static_cast<int>(viewSize().y)};
  }
  vec2 viewCentre() const { return {viewSize().x / 2, viewSize().y / 2}; }
  // A place on the screen in the picture's pixels.
  vec2 inView(ImVec2 at) const { return {at.x - left, at.y - menu}; }
};

inline constexpr ImGuiWindowFlags kFixedWindow =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
    ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNavFocus;

}  // namespace dapple
