// [Zeng] Texture Synthesis from Samples for Point-Sampled Geometry, section 2.3.
//
// Departure: the paper averages over a ball of fixed radius; here over the neighbours that are
// already settled, which needs no radius and gives every reached point a direction.
#include "regions/spread_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "base/errors.h"
#include "points/tangent_frames.h"
#include "regions/field_levels.h"
#include "regions/tangent_numbers.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 1024;

struct Scene {
  const PointSet& points;
  const Neighborhoods& neighborhoods;
  float facing;
};

class Spreader {
 public:
  Spreader(const Scene& scene, std::vector<TangentFrame>& frames, Monitor& monitor)
      : points_(scene.points),
        neighborhoods_(scene.neighborhoods),
        facing_(scene.facing),
        frames_(frames),
        monitor_(monitor),
        distance_(points_.size(), std::numeric_limits<float>::infinity()),
        settled_(points_.size(), 0),
        drawn_(points_.size(), vec3(0)) {}

  void draw(const StrokeMark& mark) {
    drawn_[mark.point] += mark.weight * mark.direction;
    enter(mark.point, 0);
  }

  void run() {
    std::size_t done = 0;
    while (!queue_.empty()) {
      const auto [distance, i] = queue_.top();
      queue_.pop();
      if (settled_[i]) continue;
      settle(i);
      for (const Index j : neighborhoods_.of(i))
        if (faces(i, j)) enter(j, distance + distanceTo(i, j));
      if (++done % kCheckpointEvery == 0) monitor_.checkpoint();
    }
  }

 private:
  using Entry = std::pair<float, Index>;

  bool faces(Index i, Index j) const {
    return glm::dot(points_.normals[i], points_.normals[j]) >= facing_;
  }

  float distanceTo(Index from, Index to) const {
    return distanceBetween(points_.positions[from], points_.positions[to]);
  }

  void enter(Index i, float distance) {
    if (settled_[i] || !(distance < distance_[i])) return;
    distance_[i] = distance;
    queue_.push({distance, i});
  }

  void settle(Index i) {
    const vec3& n = points_.normals[i];
    vec3 t = drawn_[i];
    if (t == vec3(0)) {
      vec2 sum(0);
      for (const Index j : neighborhoods_.of(i)) {
        if (!settled_[j] || !faces(i, j)) continue;
        const vec3& from = points_.normals[j];
        const float weight = 1 / std::max(distanceTo(i, j), 1e-12f);
        sum += weight * product(transport(from, n), tangentNumber(from, frames_[j].t));
      }
      t = tangentDirection(n, sum);
    }
    settled_[i] = 1;
    if (glm::dot(t, t) > 0) frames_[i] = orthonormalFrame(n, t);
  }

  const PointSet& points_;
  const Neighborhoods& neighborhoods_;
  float facing_;
  std::vector<TangentFrame>& frames_;
  Monitor& monitor_;
  std::vector<float> distance_;
  std::vector<std::uint8_t> settled_;
  std::vector<vec3> drawn_;  // sum of the marks at a point, 0 away from them
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

std::vector<TangentFrame> spreadMarks(const PointSet& points, const Neighborhoods& neighborhoods,
                                      std::span<const StrokeMark> marks,
                                      const FieldOptions& options, Monitor& monitor) {
  std::vector<TangentFrame> frames = framesTowards(points, options.up);
  Spreader spreader({points, neighborhoods, facingOf(options.creases)}, frames, monitor);
  for (const StrokeMark& mark : marks) spreader.draw(mark);
  spreader.run();
  return frames;
}

}  // namespace dapple
