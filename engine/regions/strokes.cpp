#include "regions/strokes.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kSteppedOver = 8;  // neighbours of a point that a walk may step on

class Marker {
 public:
  Marker(const PointSet& points, const Neighborhoods& neighborhoods, std::vector<StrokeMark>& marks)
      : points_(points), neighborhoods_(neighborhoods), marks_(marks) {}

  void draw(const Stroke& stroke) {
    const std::size_t m = stroke.points.size();
    for (std::size_t i = 0; i < m; ++i) {
      const vec3& here = stroke.positions[i];
      const vec3& next = stroke.positions[std::min(i + 1, m - 1)];
      mark(stroke, stroke.points[i], next - stroke.positions[i == 0 ? 0 : i - 1]);
      if (i + 1 < m) walk(stroke, stroke.points[i], stroke.points[i + 1], next - here);
    }
  }

 private:
  void mark(const Stroke& stroke, Index point, const vec3& along) {
    const vec3& n = points_.normals[point];
    const vec3 flat = along - n * glm::dot(n, along);
    const float length = glm::length(flat);
    if (length > 0)
      marks_.push_back({point, flat / length, stroke.weight, stroke.scale.value_or(1.f)});
  }

  // Over the points in between, always to the neighbour that lies nearest to the end: a line of
  // single points would hardly hold the directions beside it.
  void walk(const Stroke& stroke, Index from, Index to, const vec3& along) {
    while (from != to) {
      const Index next = nearestTo(to, from);
      if (next == from || next == to) return;
      mark(stroke, next, along);
      from = next;
    }
  }

  Index nearestTo(Index to, Index from) const {
    const vec3& end = points_.positions[to];
    Index best = from;
    float nearest = distanceBetween(points_.positions[from], end);
    const std::size_t used = std::min(neighborhoods_.k, kSteppedOver);
    for (const Index j : neighborhoods_.of(from).first(used)) {
      const float distance = distanceBetween(points_.positions[j], end);
      if (distance < nearest) nearest = distance, best = j;
    }
    return best;
  }

  const PointSet& points_;
  const Neighborhoods& neighborhoods_;
  std::vector<StrokeMark>& marks_;
};

}  // namespace

std::vector<Index> startsOf(std::span<const Stroke> strokes) {
  std::vector<Index> starts;
  for (const Stroke& stroke : strokes) starts.push_back(stroke.points.front());
  return starts;
}

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

std::vector<StrokeMark> strokeMarks(const PointSet& points, const Neighborhoods& neighborhoods,
                                    std::span<const Stroke> strokes) {
  std::vector<StrokeMark> marks;
  Marker marker(points, neighborhoods, marks);
  for (const Stroke& stroke : strokes) {
    validate(stroke, points.size());
    marker.draw(stroke);
  }
  return marks;
}

}  // namespace dapple
