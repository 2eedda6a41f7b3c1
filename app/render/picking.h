// Which points lie under the cursor, a brush or an outline drawn on the picture. All pixels are
// those of the picture (framebuffer pixels: multiply a window's coordinates by its content scale
// first), as in camera.h's PixelView. Points outside the picture are never picked.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/render/camera.h"
#include "app/render/cpu_splatter.h"
#include "base/parallel.h"
#include "points/neighborhoods.h"

namespace dapple {

struct PickView {
  const Camera& camera;
  int width, height;  // pixels
  // The same points drawn by the same camera in this size, with trace: then only what is seen there
  // is picked. Without: through everything.
  const Raster* traced = nullptr;
};

struct Picked {
  Index point;
  vec3 position;  // of the surface under the pixel, or of the point when that is beside it
  vec3 normal;    // of the point, turned towards the eye; without one: towards the eye
};

// What lies around a place on the surface.
struct Ball {
  vec3 centre;  // local units, as radius
  float radius;
  // With these only what is connected to `seed` inside the ball: not the other side of a thin wall.
  Index seed = kNone;
  const Neighborhoods* neighborhoods = nullptr;
};

// The points as the picker looks for them; made on any thread.
struct PickColumns;
// n elements each; normals may be empty. Points with a radius of 0 are not there.
std::shared_ptr<const PickColumns> makePickColumns(const std::vector<vec3>& positions,
                                                   const std::vector<vec3>& normals,
                                                   const std::vector<float>& radii);

// Keeps its own columns of the points. All results are ascending and the same at any number of
// threads. A point is seen when it lies no deeper than the traced surface at its pixel by about its
// splat's radius, more where the surface is seen edge-on, and on the same side of it: points under
// their neighbours' splats are picked, those of the back are not.
class Picker {
 public:
  explicit Picker(Workers& workers);
  ~Picker();

  void show(std::shared_ptr<const PickColumns> columns);
  // show(makePickColumns(...)).
  void update(const std::vector<vec3>& positions, const std::vector<vec3>& normals,
              const std::vector<float>& radii);

  // The point whose splat is seen at the pixel, or else the nearest to it in the picture, up to
  // `tolerance` pixels away.
  std::optional<Picked> pointAt(const PickView& view, vec2 pixel, float tolerance) const;
  std::vector<Index> inDisc(const PickView& view, vec2 centre, float radius) const;
  // Between two opposite corners.
  std::vector<Index> inRectangle(const PickView& view, vec2 a, vec2 b) const;
  // Inside by the even-odd rule; the outline closes itself and may cross itself.
  std::vector<Index> inPolygon(const PickView& view, std::span<const vec2> corners) const;
  // In a ball; with a view only what is seen in it.
  std::vector<Index> inBall(const Ball& ball, const PickView* view = nullptr) const;

  // Of these points (ascending) those that are seen.
  std::vector<Index> visible(const PickView& view, std::span<const Index> points) const;

 private:
  struct Query;
  std::vector<Index> find(const PickView& view, const Query& query) const;
  Index nearestUntraced(const PickView& view, vec2 pixel, float tolerance) const;
  std::vector<Index> connected(const Ball& ball, std::span<const Index> inside) const;

  Workers& workers_;
  std::shared_ptr<const PickColumns> columns_;
};

}  // namespace dapple
