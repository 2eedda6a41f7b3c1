// The lines over the picture: outlines of regions, directions, strokes, and what the hand draws.
#pragma once

#include <imgui.h>

#include "app/editor/scene_view.h"
#include "app/editor/strokes_view.h"

namespace dapple {

class ViewOverlays {
 public:
  struct Extra {
    std::optional<StrokeId> stroke;  // the chosen one
    OverlayLines hand;               // the tool's
  };
  // Over the view's picture, whose upper left corner is at `min`, into the present window.
  void draw(const SceneView& view, const ViewSettings& settings, const Extra& extra, ImVec2 min);

 private:
  const OverlayLines& resting(const SceneView& view, const ViewSettings& settings,
                              const OverlayView& over);

  // Outlines and directions, which take as long as a picture: made when the camera rests.
  struct Of {
    Camera camera;
    int width = 0, height = 0;
    bool outlines = false, directions = false;
    std::shared_ptr<const void> labels, regions, frames;
    bool operator==(const Of&) const = default;
  };
  Of of_;
  OverlayLines lines_;
};

}  // namespace dapple
