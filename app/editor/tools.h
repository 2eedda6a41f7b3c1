// What the left mouse button does in the 3D view: selecting points, and strokes of direction.
#pragma once

#include <imgui.h>

#include <optional>
#include <utility>
#include <vector>

#include "app/editor/scene_view.h"
#include "app/render/overlay.h"
#include "document/engine.h"

namespace dapple {

enum class Tool { Brush, Rectangle, Lasso, Polygon, Wand, Stroke };

struct ToolSettings {
  Tool tool = Tool::Brush;
  float brushRadius = 40;  // logical pixels
  bool through = false;    // also what is hidden
  WandOptions wand;
  bool field = true;       // the stroke tool shows what the strokes make of it
  bool wholePart = false;  // the wand takes all that is connected, whatever it is like
};

// The cursor in the view in one frame, in pixels of the picture.
struct ToolInput {
  vec2 cursor{0};
  bool hovered = false;  // nothing else takes the mouse
  bool pressed = false, released = false, down = false, doubleClicked = false;  // left button
  bool shift = false, ctrl = false;
  float uiScale = 1;
};

class ToolHand {
 public:
  // Follows the mouse; what is finished goes to the engine as one command. A stroke is for the
  // region where it begins.
  void update(const ToolInput& input, const ToolSettings& settings, SceneView& view,
              Engine& engine);
  // The gesture is given up: nothing has happened.
  void abort(SceneView& view);
  // The last corner of a polygon is taken back. False: there is none.
  bool takeBack();
  bool active() const { return active_; }
  // Where the stroke tool was clicked without being drawn with, since the last call.
  std::optional<vec2> takeClick() { return std::exchange(click_, std::nullopt); }

  // In pixels of the picture: what the hand draws, above everything.
  OverlayLines overlay(const ToolSettings& settings, const SceneView& view) const;

 private:
  void forget();
  void brush(const ToolInput& input, const ToolSettings& settings, SceneView& view);
  void stroke(const ToolInput& input, SceneView& view);
  void finish(const ToolSettings& settings, SceneView& view, Engine& engine);
  std::vector<Index> outlined(const ToolSettings& settings, const SceneView& view) const;

  bool active_ = false;
  SelectMode mode_ = SelectMode::Replace;
  std::vector<vec2> path_;       // of the cursor, or the polygon's corners
  std::vector<Index> gathered_;  // by the brush, ascending
  Stroke stroke_;
  std::optional<Picked> under_;  // what the cursor is on
  std::optional<vec2> click_;
  vec2 cursor_{0};
  float uiScale_ = 1;
};

}  // namespace dapple
