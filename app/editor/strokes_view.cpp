#include "app/editor/strokes_view.h"

#include <fmt/format.h>

#include <algorithm>

namespace dapple {
namespace {

constexpr vec3 kStroke = SurfaceStroke{}.colour;
constexpr vec3 kChosen{1.0f, 0.45f, 0.20f};
constexpr float kChosenWidth = 1.6f;  // times the others'

float distanceTo(const OverlayLine& line, vec2 place) {
  float nearest = std::numeric_limits<float>::max();
  for (std::size_t p = 0; p + 1 < line.points.size(); ++p) {
    const vec2 a = line.points[p], along = line.points[p + 1] - a;
    const float length2 = glm::dot(along, along);
    const float t = length2 > 0 ? std::clamp(glm::dot(place - a, along) / length2, 0.f, 1.f) : 0.f;
    nearest = std::min(nearest, glm::distance(place, a + t * along));
  }
  return nearest;
}

template <class F>
void forEachStroke(const Document& document, F&& visit) {
  for (const Region& region : *document.regions) {
    if (!region.visible || !region.strokes) continue;
    for (std::size_t s = 0; s < region.strokes->size(); ++s)
      visit(StrokeId{region.id, s}, (*region.strokes)[s]);
  }
}

}  // namespace

const Stroke* findStroke(const Document& document, const StrokeId& id) {
  const Region* region = findRegion(document, id.region);
  if (!region || !region->strokes || id.index >= region->strokes->size()) return nullptr;
  return &(*region->strokes)[id.index];
}

OverlayLines strokesOverlay(const OverlayView& view, const Document& document,
                            const std::optional<StrokeId>& chosen) {
  std::vector<SurfaceStroke> others;
  OverlayLines marked;
  forEachStroke(document, [&](const StrokeId& id, const Stroke& stroke) {
    if (id != chosen) {
      others.push_back({stroke.positions, kStroke});
      return;
    }
    const SurfaceStroke shown{stroke.positions, kChosen};
    marked = strokeLines(view, {&shown, 1});
    for (OverlayLine& line : marked) line.width *= kChosenWidth;
  });
  OverlayLines lines = strokeLines(view, others);
  lines.insert(lines.end(), marked.begin(), marked.end());
  return lines;
}

std::vector<OverlayLabel> strokeLabels(const OverlayView& view, const Document& document) {
  std::vector<OverlayLabel> labels;
  forEachStroke(document, [&](const StrokeId&, const Stroke& stroke) {
    if (!stroke.scale || *stroke.scale == 1) return;
    const SurfaceStroke one{stroke.positions};
    const OverlayLines lines = strokeLines(view, {&one, 1});
    if (lines.empty()) return;
    const std::vector<vec2>& shaft = lines.front().points;
    labels.push_back({shaft[shaft.size() / 2], fmt::format("\u00d7{:.2g}", *stroke.scale)});
  });
  return labels;
}

std::optional<StrokeId> strokeAt(const OverlayView& view, const Document& document, vec2 place,
                                 float reach) {
  std::optional<StrokeId> found;
  float nearest = reach;
  forEachStroke(document, [&](const StrokeId& id, const Stroke& stroke) {
    const SurfaceStroke one{stroke.positions};
    for (const OverlayLine& line : strokeLines(view, {&one, 1}))
      if (const float d = distanceTo(line, place); d <= nearest) nearest = d, found = id;
  });
  return found;
}

}  // namespace dapple
