#include "app/editor/tools.h"

#include <algorithm>

namespace dapple {
namespace {

constexpr float kBrushStep = 0.25f;  // of the radius: from dab to dab of a drag
constexpr int kMostDabs = 16;        // a frame
constexpr float kPathStep = 3;       // pixels, of a lasso
constexpr float kStrokeStep = 6;     // pixels
constexpr float kTolerance = 6;      // logical pixels, of a click
constexpr float kCloseCorner = 10;   // logical pixels: a click on the first corner ends it
constexpr glm::vec4 kHand{1.0f, 0.84f, 0.55f, 1.0f};

SelectMode modeOf(const ToolInput& input) {
  if (input.shift && input.ctrl) return SelectMode::Intersect;
  if (input.shift) return SelectMode::Add;
  return input.ctrl ? SelectMode::Subtract : SelectMode::Replace;
}

std::vector<Index> unionOf(const std::vector<Index>& a, const std::vector<Index>& b) {
  std::vector<Index> out;
  out.reserve(a.size() + b.size());
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out));
  return out;
}

// The brush on the surface has the radius that it has on the screen.
float surfaceRadius(const SceneView& view, const Camera& camera, const vec3& at, float pixels) {
  const PixelView pixelView(camera, view.picture().width, view.picture().height);
  return pixels * pixelView.unitsPerPixel(pixelView.project(at).z);
}

}  // namespace

void ToolHand::forget() {
  active_ = false;
  path_.clear(), gathered_.clear();
  stroke_ = {};
}

void ToolHand::abort(SceneView& view) {
  forget();
  view.setPending({});
}

bool ToolHand::takeBack() {
  if (!active_ || path_.empty()) return false;
  path_.pop_back();
  active_ = !path_.empty();
  return true;
}

void ToolHand::brush(const ToolInput& input, const ToolSettings& settings, SceneView& view) {
  const Camera camera = view.pictureCamera();
  const PickView pick = view.pickView(camera, false);
  const float radius = settings.brushRadius * input.uiScale;
  const vec2 from = path_.empty() ? input.cursor : path_.back();
  const float length = glm::distance(from, input.cursor);
  const int dabs = std::clamp(static_cast<int>(length / (kBrushStep * radius)) + 1, 1, kMostDabs);
  if (!path_.empty() && length < 1) return;
  for (int k = 1; k <= dabs; ++k) {
    const vec2 at = glm::mix(from, input.cursor, static_cast<float>(k) / static_cast<float>(dabs));
    const auto found = view.picker().pointAt(pick, at, kTolerance * input.uiScale);
    if (!found) continue;
    const Ball ball{found->position, surfaceRadius(view, camera, found->position, radius)};
    gathered_ = unionOf(gathered_, view.picker().inBall(ball, settings.through ? nullptr : &pick));
  }
  path_.push_back(input.cursor);
  view.setPending(gathered_);
}

void ToolHand::stroke(const ToolInput& input, SceneView& view) {
  if (!path_.empty() && glm::distance(path_.back(), input.cursor) < kStrokeStep) return;
  const Camera camera = view.pictureCamera();
  const auto found =
      view.picker().pointAt(view.pickView(camera, false), input.cursor, kTolerance * input.uiScale);
  if (!found) return;
  path_.push_back(input.cursor);
  stroke_.positions.push_back(found->position);
  stroke_.points.push_back(found->point);
}

std::vector<Index> ToolHand::outlined(const ToolSettings& settings, const SceneView& view) const {
  const Camera camera = view.pictureCamera();
  const PickView pick = view.pickView(camera, settings.through);
  if (settings.tool == Tool::Rectangle)
    return view.picker().inRectangle(pick, path_.front(), path_.back());
  if (path_.size() < 3) return {};
  return view.picker().inPolygon(pick, path_);
}

void ToolHand::finish(const ToolSettings& settings, SceneView& view, Engine& engine) {
  if (settings.tool == Tool::Stroke) {
    const auto& labels = *view.snapshot().document.labels;
    if (stroke_.positions.size() < 2)
      click_ = cursor_;
    else if (stroke_.points.front() < labels.size())
      engine.submit(AddStroke{labels[stroke_.points.front()], stroke_});
  } else if (settings.tool == Tool::Brush) {
    engine.submit(Select{gathered_, mode_});
    view.submitPending();
  } else {
    engine.submit(Select{outlined(settings, view), mode_});
  }
  forget();
}

void ToolHand::update(const ToolInput& input, const ToolSettings& settings, SceneView& view,
                      Engine& engine) {
  cursor_ = input.cursor, uiScale_ = input.uiScale;
  under_.reset();
  if (view.empty() || view.picture().width == 0) return;
  const Camera camera = view.pictureCamera();
  if (input.hovered)
    under_ = view.picker().pointAt(view.pickView(camera, false), input.cursor,
                                   kTolerance * input.uiScale);
  if (settings.tool == Tool::Wand) {
    if (input.hovered && input.pressed && under_)
      engine.submit(settings.wholePart
                        ? Command(SelectConnected{under_->point, modeOf(input)})
                        : Command(SelectWand{under_->point, settings.wand, modeOf(input)}));
    return;
  }
  if (settings.tool == Tool::Polygon) {
    if (!input.hovered || !input.pressed) return;
    const bool closes = path_.size() >= 3 &&
                        glm::distance(path_.front(), input.cursor) < kCloseCorner * input.uiScale;
    if (!active_) mode_ = modeOf(input);
    active_ = true;
    if (closes || (input.doubleClicked && path_.size() >= 3))
      finish(settings, view, engine);
    else
      path_.push_back(input.cursor);
    return;
  }
  if (input.hovered && input.pressed) {
    abort(view);
    active_ = true;
    mode_ = modeOf(input);
    path_.clear();
    if (settings.tool == Tool::Rectangle) path_ = {input.cursor, input.cursor};
  }
  if (!active_) return;
  switch (settings.tool) {
    case Tool::Brush:
      brush(input, settings, view);
      break;
    case Tool::Stroke:
      stroke(input, view);
      break;
    case Tool::Rectangle:
      path_.back() = input.cursor;
      break;
    default:
      if (path_.empty() || glm::distance(path_.back(), input.cursor) > kPathStep)
        path_.push_back(input.cursor);
  }
  if (input.released || !input.down) finish(settings, view, engine);
}

OverlayLines ToolHand::overlay(const ToolSettings& settings, const SceneView& view) const {
  OverlayLines lines;
  if (view.empty() || view.picture().width == 0) return lines;
  const Camera camera = view.pictureCamera();
  const OverlayView over(camera, view.picture(), view.splatRadius(), uiScale_);
  const auto outline = [&](std::vector<vec2> points, bool closed) {
    lines.push_back(
        {.points = std::move(points), .colour = kHand, .width = 1.5f * uiScale_, .closed = closed});
  };
  if (settings.tool == Tool::Brush && under_) {
    lines = brushLines(over, {.centre = under_->position,
                              .normal = under_->normal,
                              .radius = surfaceRadius(view, camera, under_->position,
                                                      settings.brushRadius * uiScale_),
                              .through = settings.through});
  } else if (settings.tool == Tool::Stroke && active_) {
    const SurfaceStroke stroke{stroke_.positions};
    lines = strokeLines(over, {&stroke, 1});
  } else if (active_ && settings.tool == Tool::Rectangle) {
    const vec2 a = path_.front(), b = path_.back();
    outline({a, {b.x, a.y}, b, {a.x, b.y}}, true);
  } else if (active_ && settings.tool == Tool::Lasso) {
    outline(path_, true);
  } else if (active_ && settings.tool == Tool::Polygon) {
    std::vector<vec2> corners = path_;
    corners.push_back(cursor_);
    outline(corners, false);
  }
  return lines;
}

}  // namespace dapple
