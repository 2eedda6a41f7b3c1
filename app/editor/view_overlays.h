// The lines over the picture: outlines of regions, directions and their singularities, strokes, and
// what the hand draws.
#pragma once

#include <imgui.h>

#include <string>

#include "app/editor/field_finder.h"
#include "app/editor/scene_view.h"
#include "app/editor/strokes_view.h"

namespace dapple {

class ViewOverlays {
 public:
  struct Extra {
    std::optional<StrokeId> stroke;  // the chosen one
    OverlayLines hand;               // the tool's
    bool field = false;              // strokes are being drawn: their directions are to be seen
    std::optional<vec2> cursor;      // in pixels of the picture, while nothing else has it
  };
  // `ready`, if any, is called from another thread when there is something new to draw().
  explicit ViewOverlays(std::function<void()> ready) : finder_(std::move(ready)) {}

  // Over the view's picture, whose upper left corner is at `min`, into the present window.
  void draw(const SceneView& view, const ViewSettings& settings, const Extra& extra, ImVec2 min);

  // Of what was drawn last: the singularities in a line of words. Empty: they are not shown.
  const std::string& note() const { return note_; }
  // Null: not shown, or not found yet.
  const ShownField* field() const { return shown_.get(); }
  // Directions are shown that are not those of the strokes yet.
  bool finding() const { return wanted_ && finder_.finding(); }
  // They are, and nobody will tell when they are found.
  bool due() const { return wanted_ && finder_.due(); }

 private:
  void followField(const Document& document, const ViewSettings& settings, const Extra& extra);
  void makeResting(const SceneView& view, const ViewSettings& settings, const Extra& extra,
                   const OverlayView& over);
  void drawSingularities(const Document& document, const OverlayView& over, const Extra& extra,
                         ImVec2 min);

  FieldFinder finder_;
  bool wanted_ = false;                      // directions or singularities are to be seen
  std::shared_ptr<const ShownField> shown_;  // of the scan that is shown
  std::string note_;

  // Outlines and directions, which take as long as a picture: made when the camera rests.
  struct Of {
    Camera camera;
    int width = 0, height = 0;
    float cell = 0;  // of directions; 0: none
    bool outlines = false;
    std::shared_ptr<const void> labels, regions, field;
    bool operator==(const Of&) const = default;
  };
  Of of_;
  OverlayLines outlines_, directions_;
};

}  // namespace dapple
