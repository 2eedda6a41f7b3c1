// [Zeng] Texture Synthesis from Samples for Point-Sampled Geometry, section 2.3.
//
// Departure: the paper averages over a ball of fixed radius; here over the neighbours that are
// already settled, which needs no radius and gives every reached point a direction.
#include "regions/strokes.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 1024;
constexpr float kFacing = -0.2f;  // normals that look further apart are of another sheet

class Spreader {
 public:
  Spreader(const PointSet& points, const Neighborhoods& neighborhoods,
           std::vector<TangentFrame>& frames, Monitor& monitor)
      : points_(points),
        neighborhoods_(neighborhoods),
        frames_(frames),
        monitor_(monitor),
        distance_(points.size(), std::numeric_limits<float>::infinity()),
        settled_(points.size(), 0),
        drawn_(points.size(), vec3(0)) {}

  void draw(const Stroke& stroke) {
    const std::size_t m = stroke.points.size();
    for (std::size_t i = 0; i < m; ++i) {
      const vec3 along =
          stroke.positions[std::min(i + 1, m - 1)] - stroke.positions[i == 0 ? 0 : i - 1];
      const Index p = stroke.points[i];
      const vec3& n = points_.normals[p];
      const vec3 flat = along - n * glm::dot(n, along);
      const float length = glm::length(flat);
      if (length > 0) drawn_[p] += flat * (stroke.weight / length);
      enter(p, 0);
    }
  }

  void run() {
    std::size_t done = 0;
    while (!queue_.empty()) {
      const auto [distance, i] = queue_.top();
      queue_.pop();
      if (settled_[i]) continue;
      settle(i);
      for (std::size_t c = 0; c < neighborhoods_.k; ++c)
        enter(neighborhoods_.of(i)[c], distance + distanceTo(i, neighborhoods_.of(i)[c]));
      if (++done % kCheckpointEvery == 0) monitor_.checkpoint();
    }
  }

 private:
  using Entry = std::pair<float, Index>;

  float distanceTo(Index from, Index to) const {
    return distanceBetween(points_.positions[from], points_.positions[to]);
  }

  void enter(Index i, float distance) {
    if (settled_[i] || !(distance < distance_[i])) return;
    distance_[i] = distance;
    queue_.push({distance, i});
  }

  void settle(Index i) {
    const vec3 n = points_.normals[i];
    vec3 t = drawn_[i];
    for (std::size_t c = 0; c < neighborhoods_.k && drawn_[i] == vec3(0); ++c) {
      const Index j = neighborhoods_.of(i)[c];
      if (!settled_[j] || glm::dot(points_.normals[j], n) < kFacing) continue;
      const float weight = 1 / std::max(distanceTo(i, j), 1e-12f);
      t += weight * transported(frames_[j].t, points_.normals[j], n);
    }
    settled_[i] = 1;
    if (glm::dot(t, t) > 0) frames_[i] = orthonormalFrame(n, t);
  }

  const PointSet& points_;
  const Neighborhoods& neighborhoods_;
  std::vector<TangentFrame>& frames_;
  Monitor& monitor_;
  std::vector<float> distance_;
  std::vector<std::uint8_t> settled_;
  std::vector<vec3> drawn_;  // sum of the strokes at a point, 0 away from them
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

void validate(const Stroke& stroke, std::size_t points) {
  if (stroke.positions.size() < 2 || stroke.points.size() != stroke.positions.size())
    throw InvalidInput(fmt::format(
        "a stroke has {} positions and {} points; it needs 2 or more, and as many of each",
        stroke.positions.size(), stroke.points.size()));
  for (const Index p : stroke.points)
    if (p >= points)
      throw InvalidInput(
          fmt::format("a stroke runs over point {}, but the scan has {} points", p, points));
  for (const vec3& p : stroke.positions)
    if (!std::isfinite(p.x + p.y + p.z))
      throw InvalidInput("a stroke has a position that is not a number; draw it again");
  if (!(stroke.weight > 0 && std::isfinite(stroke.weight)))
    throw InvalidInput(
        fmt::format("a stroke's weight is {}; it must be above 0 and finite", stroke.weight));
  if (stroke.scale && !(*stroke.scale > 0 && std::isfinite(*stroke.scale)))
    throw InvalidInput(
        fmt::format("a stroke's scale is {}; it must be above 0 and finite", *stroke.scale));
}

std::vector<TangentFrame> spreadStrokes(const PointSet& points, const Neighborhoods& neighborhoods,
                                        std::span<const Stroke> strokes,
                                        std::vector<TangentFrame> otherwise, Monitor& monitor) {
  DAPPLE_CHECK(otherwise.size(), ==, points.size());
  if (strokes.empty()) return otherwise;
  Spreader spreader(points, neighborhoods, otherwise, monitor);
  for (const Stroke& stroke : strokes) {
    validate(stroke, points.size());
    spreader.draw(stroke);
  }
  spreader.run();
  return otherwise;
}

}  // namespace dapple
