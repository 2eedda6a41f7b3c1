#include "regions/singularities.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/errors.h"
#include "regions/field_levels.h"
#include "regions/tangent_numbers.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr std::size_t kRingNeighbours = 16;
constexpr float kTau = 2 * std::numbers::pi_v<float>;
constexpr float kWidestGap = 2.1f;  // radians without a point on a way round

struct RingPoint {
  float angle;
  vec2 direction;  // power, carried to the centre
  Index id;
  bool operator<(const RingPoint& other) const { return angle < other.angle; }
};

float angleOf(const vec2& a) {
  return std::atan2(a.y, a.x);
}

// Turns of the direction along a ring, which is sorted here; none when it is not closed.
std::optional<int> turnsAlong(std::vector<RingPoint>& ring) {
  if (ring.size() < 4) return std::nullopt;
  std::sort(ring.begin(), ring.end());
  float sum = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const bool last = k + 1 == ring.size();
    const RingPoint& next = ring[last ? 0 : k + 1];
    if (next.angle - ring[k].angle + (last ? kTau : 0) > kWidestGap) return std::nullopt;
    sum += angleOf(product(next.direction, conjugate(ring[k].direction)));
  }
  return static_cast<int>(std::lround(sum / kTau));
}

// The points within `radius` of `centre` that are reached over such points from `start`, ascending.
std::vector<Index> pointsWithin(const PointSet& points, const Neighborhoods& neighborhoods,
                                std::vector<Index> start, const vec3& centre, float radius) {
  std::vector<Index> found = std::move(start), fresh = found;
  std::sort(found.begin(), found.end());
  while (!fresh.empty()) {
    std::vector<Index> next;
    for (const Index i : fresh)
      for (const Index j : neighborhoods.of(i))
        if (distanceBetween(points.positions[j], centre) <= radius &&
            glm::dot(points.normals[i], points.normals[j]) >= kFacing &&
            !std::binary_search(found.begin(), found.end(), j))
          next.push_back(j);
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    const auto middle = static_cast<std::ptrdiff_t>(found.size());
    found.insert(found.end(), next.begin(), next.end());
    std::inplace_merge(found.begin(), found.begin() + middle, found.end());
    fresh = std::move(next);
  }
  return found;
}

class Finder {
 public:
  Finder(const PointSet& points, const Neighborhoods& neighborhoods,
         std::span<const TangentFrame> frames, int folds)
      : points_(points),
        neighborhoods_(neighborhoods),
        used_(std::min(neighborhoods.k, kRingNeighbours)),
        folds_(folds),
        power_(frames.size()) {
    for (std::size_t i = 0; i < frames.size(); ++i)
      power_[i] = power(unit(tangentNumber(points.normals[i], frames[i].t)), folds);
  }

  // Round the neighbours of i; 0 where that cannot be told.
  int turnsAround(Index i, std::vector<RingPoint>& ring) const {
    const vec3& n = points_.normals[i];
    bool calm = true;  // all within a right angle: no need to sort them
    ring.clear();
    for (const Index j : neighborhoods_.of(i).first(used_)) {
      if (glm::dot(points_.normals[j], n) < kFacing) continue;
      const vec2 direction = directionAt(j, n);
      calm = calm && glm::dot(direction, power_[i]) > 0;
      ring.push_back({0, direction, j});
    }
    if (calm) return 0;
    for (RingPoint& p : ring) p.angle = angleAt(p.id, points_.positions[i], n);
    return turnsAlong(ring).value_or(0);
  }

  // The singularity that all points of `group` see, which have counted `turns` at the first.
  Singularity merged(const std::vector<Index>& group, int turns) const {
    vec3 centre(0), normal(0);
    for (const Index i : group) centre += points_.positions[i], normal += points_.normals[i];
    centre /= static_cast<float>(group.size());
    Singularity out{centre, group[0], turns};
    const auto distance = [&](Index i) { return distanceBetween(points_.positions[i], centre); };
    float radius = 0, step = 0;
    for (const Index i : group) {
      if (distance(i) < distance(out.point)) out.point = i;
      radius = std::max(radius, distance(i));
      step = std::max(step, distanceBetween(points_.positions[i],
                                            points_.positions[neighborhoods_.of(i)[used_ - 1]]));
    }
    normal = glm::length(normal) > 0 ? glm::normalize(normal) : points_.normals[out.point];
    std::vector<RingPoint> ring;
    for (const Index j : pointsWithin(points_, neighborhoods_, group, centre, radius + step))
      if (distance(j) > radius)
        ring.push_back({angleAt(j, centre, normal), directionAt(j, normal), j});
    out.index = turnsAlong(ring).value_or(turns);
    return out;
  }

 private:
  float angleAt(Index j, const vec3& centre, const vec3& normal) const {
    return angleOf(tangentNumber(normal, points_.positions[j] - centre));
  }
  vec2 directionAt(Index j, const vec3& normal) const {
    return product(power(transport(points_.normals[j], normal), folds_), power_[j]);
  }

  const PointSet& points_;
  const Neighborhoods& neighborhoods_;
  std::size_t used_;
  int folds_;
  std::vector<vec2> power_;
};

// All points with turns round them that hang together with `first`; they are taken out.
std::vector<Index> takeGroup(const Neighborhoods& neighborhoods, Index first,
                             std::vector<std::int8_t>& turns) {
  std::vector<Index> group{first};
  turns[first] = 0;
  for (std::size_t g = 0; g < group.size(); ++g)
    for (const Index j : neighborhoods.of(group[g])) {
      if (turns[j] == 0) continue;
      turns[j] = 0;
      group.push_back(j);
    }
  return group;
}

}  // namespace

std::vector<Singularity> singularities(const PointSet& points, const Neighborhoods& neighborhoods,
                                       std::span<const TangentFrame> frames, FieldSymmetry symmetry,
                                       Monitor& monitor) {
  DAPPLE_CHECK(frames.size(), ==, points.size());
  std::vector<Singularity> out;
  if (neighborhoods.k == 0) return out;
  const Finder finder(points, neighborhoods, frames, foldsOf(symmetry));
  std::vector<std::int8_t> turns(points.size(), 0);
  parallelFor(monitor, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<RingPoint> ring;
    for (std::size_t i = begin; i < end; ++i)
      turns[i] = static_cast<std::int8_t>(finder.turnsAround(static_cast<Index>(i), ring));
  });
  for (Index i = 0; i < points.size(); ++i) {
    if (turns[i] == 0) continue;
    monitor.checkpoint();
    const int seen = turns[i];
    const Singularity found = finder.merged(takeGroup(neighborhoods, i, turns), seen);
    if (found.index != 0) out.push_back(found);
  }
  return out;
}

double kinkedShare(const PointSet& points, const Neighborhoods& neighborhoods,
                   std::span<const TangentFrame> frames, FieldSymmetry symmetry,
                   const KinkBounds& bounds) {
  const int folds = foldsOf(symmetry);
  const float cosine =
      std::cos(static_cast<float>(folds) * bounds.degrees * std::numbers::pi_v<float> / 180);
  std::vector<std::uint8_t> near(points.size(), 0);
  for (const Singularity& s : bounds.singularities)
    for (const Index i :
         pointsWithin(points, neighborhoods, {s.point}, s.position, bounds.clearance))
      near[i] = 1;
  std::size_t links = 0, kinked = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (near[i]) continue;
    const vec3& n = points.normals[i];
    const vec2 own = power(unit(tangentNumber(n, frames[i].t)), folds);
    for (const Index j : neighborhoods.of(i).first(std::min(neighborhoods.k, kMostLinked))) {
      const vec3& from = points.normals[j];
      if (near[j] || glm::dot(from, n) < kFacing) continue;
      const vec2 there = product(transport(from, n), unit(tangentNumber(from, frames[j].t)));
      ++links;
      kinked += glm::dot(own, power(there, folds)) < cosine;
    }
  }
  return links == 0 ? 0 : static_cast<double>(kinked) / static_cast<double>(links);
}

}  // namespace dapple
