// What is drawn over the picture: lines in pixels, made from things on the surface, without what
// the traced surface hides. A window hands them to its draw list, the command line to drawLines().
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "app/render/camera.h"
#include "app/render/cpu_splatter.h"

namespace dapple {

struct OverlayLine {
  std::vector<vec2> points;  // pixels of the picture, as in PixelView
  glm::vec4 colour{1};       // 0..1, the last: opacity
  float width = 1;           // pixels
  bool closed = false;       // the last point is joined to the first
};
using OverlayLines = std::vector<OverlayLine>;

// The picture that is drawn over.
struct OverlayView {
  OverlayView(const Camera& camera, const Raster& picture, float splat, float uiScale = 1)
      : pixels(camera, picture.width, picture.height),
        traced(picture),
        radius(splat),
        scale(uiScale) {}

  PixelView pixels;
  const Raster& traced;  // by the same camera, with trace
  float radius;          // local units: most splats'; what lies this much deeper is still seen
  float scale;           // of widths and distances: the user interface's (framebuffer) scale
};

// Where a place on the surface is seen; none where it is hidden or outside the picture.
std::optional<vec2> placeOf(const OverlayView& view, const vec3& at);

// Drawn on the surface, from the first point to the last, local coordinates.
struct SurfaceStroke {
  std::span<const vec3> points;
  vec3 colour{1.0f, 0.84f, 0.35f};
};
// The strokes' visible parts, each with an arrow head where it ends and on its way there.
OverlayLines strokeLines(const OverlayView& view, std::span<const SurfaceStroke> strokes);

// Short arrows along the directions (n, local, any length; zero: none): one in each cell of
// `cell` pixels (times the scale) for the visible point nearest to its centre.
OverlayLines directionLines(const OverlayView& view, std::span<const vec3> positions,
                            std::span<const vec3> directions, float cell = 14);

// A point round which directions turn, by `index` (not 0) N-ths of a turn.
struct SingularMark {
  vec3 at;  // on the surface, local coordinates
  int index = 1;
};
inline constexpr float kMarkRadius = 8;  // pixels, times the scale
// A ring with a plus where the index is above 0, a diamond with a minus where it is below, around
// the places that are seen; a second and a third outline for so many N-ths.
OverlayLines singularityLines(const OverlayView& view, std::span<const SingularMark> marks);

// Smooth borders between visible points of different ids (n; kNone is one of them).
OverlayLines outlineLines(const OverlayView& view, std::span<const Index> region,
                          const vec3& colour = vec3(1));

struct BrushCursor {
  vec3 centre, normal;   // of the surface, as Picked
  float radius;          // local units
  float core = 0;        // 0..1 of the radius: a second circle, where the brush begins to fall off
  bool through = false;  // it reaches what is hidden: drawn whole
  vec3 colour{1};
};
// The circle in the tangent plane: what the surface hides of it is faint and dashed.
OverlayLines brushLines(const OverlayView& view, const BrushCursor& brush);

// Lines on any background: the same, wider, dark and half transparent, below all of them.
OverlayLines withCasing(const OverlayLines& lines, float scale);

// Smooth lines with round ends, in their order, into the picture's colours.
void drawLines(std::span<const OverlayLine> lines, Image& picture);

}  // namespace dapple
