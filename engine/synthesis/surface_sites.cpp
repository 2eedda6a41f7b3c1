// Departures from methods 3.4 and [Zhang] 4.1: a coarse site is one of the points, not the mean of
// four, so that it keeps a normal and axes that belong to it and never lies between two sheets; and
// levels are thinned by distance, so that they have the same scale everywhere.
#include "synthesis/surface_sites.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr std::size_t kFewestSites = 16;
constexpr std::size_t kCandidates = 20;  // nearest of coarse sites, of which some face away
constexpr float kApart = 0.83f;          // of a step: least distance between sites that are left
constexpr float kDense = 0.7f;           // of a pixel: spacing below which points are thinned
constexpr double kDenseShare = 0.05;     // of the points that makes it worth while
constexpr float kSparse = 1.7f;          // of a step: spacing beyond which a site is frozen
constexpr float kGrazing = 0.05f;        // least sine of a direction to the normal
constexpr float kUnfiltered = 1.25f;  // of a pixel: spacing up to which the swatch itself is read

// Spacing over the size of a pixel there, for every point.
std::vector<float> densities(const SynthesisInput& input) {
  std::vector<float> spacing = localSpacing(input.neighborhoods, input.points.positions);
  for (std::size_t i = 0; i < spacing.size(); ++i) spacing[i] /= input.unitAt(i);
  return spacing;
}

float quantile(std::vector<float> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

class Thinning {
 public:
  Thinning(const SynthesisInput& input, Monitor& monitor) : in_(input), monitor_(monitor) {}

  // The next level above `fine`, whose parents are set. Empty when too few are left.
  SurfaceLevel next(SurfaceLevel& fine, int level) {
    const std::vector<Index> number = keep(fine, std::ldexp(kApart, level));
    SurfaceLevel out{.level = level};
    for (std::size_t i = 0; i < number.size(); ++i)
      if (number[i] != kNone) out.points.push_back(pointAt(fine, i));
    if (out.points.size() < kFewestSites) return {};
    setParents(fine, number);
    std::vector<vec3> positions(out.points.size());
    for (std::size_t s = 0; s < positions.size(); ++s)
      positions[s] = in_.points.positions[out.points[s]];
    out.near = buildNeighborhoods(positions, std::min(kCandidates, positions.size() - 1), monitor_);
    return out;
  }

 private:
  float squaredDistance(Index a, Index b) const {
    const vec3 d = in_.points.positions[b] - in_.points.positions[a];
    return glm::dot(d, d);
  }
  bool sameSheet(Index a, Index b) const {
    return glm::dot(in_.points.normals[a], in_.points.normals[b]) > 0;
  }

  // One after the other, unless one that was kept is near: the new number of those kept.
  std::vector<Index> keep(const SurfaceLevel& fine, float apart) const {
    const Neighborhoods& near = nearOf(fine, in_);
    std::vector<Index> number(near.size(), kNone);
    Index count = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
      if (i % kGrain == 0) monitor_.checkpoint();
      const Index point = pointAt(fine, i);
      const float radius = apart * in_.unitAt(point), least = radius * radius;
      bool free = true;
      for (const Index j : near.of(i)) {
        const Index other = pointAt(fine, j);
        if (squaredDistance(point, other) >= least) break;  // the others are no nearer
        if (number[j] != kNone && sameSheet(point, other)) {
          free = false;
          break;
        }
      }
      if (free) number[i] = count++;
    }
    return number;
  }

  // Itself, or the nearest one that was kept.
  void setParents(SurfaceLevel& fine, const std::vector<Index>& number) const {
    const Neighborhoods& near = nearOf(fine, in_);
    fine.parent.resize(near.size());
    parallelFor(monitor_, near.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        fine.parent[i] = number[i];
        if (number[i] != kNone) continue;
        for (const Index j : near.of(i))
          if (number[j] != kNone && sameSheet(pointAt(fine, i), pointAt(fine, j))) {
            fine.parent[i] = number[j];
            break;
          }
      }
    });
  }

  const SynthesisInput& in_;
  Monitor& monitor_;
};

// Of the first level that all points take part in.
int firstLevel(const SynthesisInput& input) {
  std::vector<float> spacing = densities(input);
  const auto dense =
      std::count_if(spacing.begin(), spacing.end(), [](float s) { return s < kDense; });
  if (static_cast<double>(dense) > kDenseShare * static_cast<double>(spacing.size()))
    return static_cast<int>(std::floor(std::log2(std::max(quantile(spacing, 0.05), 1e-3f))));
  return std::max(0, static_cast<int>(std::floor(std::log2(quantile(spacing, 0.25)) + 0.3f)));
}

[[gnu::always_inline]] inline SurfaceWays::Offset offsetBetween(const SynthesisInput& input,
                                                                Index from, Index to) {
  const std::vector<vec3>& positions = input.chart ? *input.chart : input.points.positions;
  const TangentFrame &a = input.frames[from], &b = input.frames[to];
  SurfaceWays::Offset out;
  if (!(glm::dot(a.n, b.n) > 0)) return out;
  const vec3 v = positions[to] - positions[from];
  // (cos, sin) of the angle from a's axes to b's, carried from b's plane to a's by the least
  // rotation, times 1 + a.n . b.n.
  const float c = glm::dot(a.s, b.s) + glm::dot(a.t, b.t);
  const float s = glm::dot(a.t, b.s) - glm::dot(a.s, b.t);
  out.quarters = c >= std::abs(s) ? 0 : s > std::abs(c) ? 1 : c <= -std::abs(s) ? 2 : 3;
  const vec2 here(glm::dot(v, a.s), glm::dot(v, a.t));
  vec2 there(glm::dot(v, b.s), glm::dot(v, b.t));
  for (int q = 0; q < out.quarters; ++q) there = {-there.y, there.x};
  const float length2 = glm::dot(v, v);
  const float here2 = glm::dot(here, here), there2 = glm::dot(there, there);
  if (!(length2 > 0)) {  // a twin
    out.seen = true;
    return out;
  }
  if (!(std::min(here2, there2) > kGrazing * kGrazing * length2)) return out;
  // [Zhang], Appendix A: as long as the way through space, along the tangent plane of either end.
  const vec2 direction = here / std::sqrt(here2) + there / std::sqrt(there2);
  const float scale = std::sqrt(length2) / (input.unitAt(from) + input.unitAt(to));
  out.pixels = {direction.x * scale, -direction.y * scale};  // image rows run down
  out.seen = true;
  return out;
}

}  // namespace

float readLevel(const SynthesisInput& input, std::size_t point) {
  const auto row = input.neighborhoods.of(point);
  const float k = static_cast<float>(row.size());
  const float spacing =
      distanceBetween(input.points.positions[point], input.points.positions[row.back()]) *
      std::sqrt(std::numbers::pi_v<float> / (k + 0.5f));
  return filterLevel(spacing / kUnfiltered, input.unitAt(point));
}

std::vector<SurfaceLevel> thinSurface(const SynthesisInput& input, int levels, Monitor& monitor) {
  std::vector<SurfaceLevel> out(1);
  out[0].level = std::min(firstLevel(input), levels - 1);
  Thinning thinning(input, monitor);
  while (out.back().level + 1 < levels || out.back().level < 0) {
    SurfaceLevel next = thinning.next(out.back(), out.back().level + 1);
    if (next.points.empty()) break;
    out.push_back(std::move(next));
  }
  return out;
}

SurfaceWays::Offset SurfaceWays::between(Index from, Index to) const {
  return offsetBetween(in_, from, to);
}

SiteLevel SurfaceWays::sitesOf(const SurfaceLevel& surface, std::int32_t reach,
                               std::span<const std::uint8_t> open, Monitor& monitor) const {
  const Neighborhoods& near = nearOf(surface, in_);
  SiteLevel out{.level = surface.level,
                .size = near.size(),
                .k = std::min(kMostNear, near.k),
                .stride = near.k,
                .ids = near.ids};
  out.ways.assign(out.size * out.k, {kNoWay, 0});
  const WayScale toWay(surface.level, reach);
  std::vector<std::uint8_t> frozen(out.size, 0);
  std::atomic<bool> some = false, turned = false;
  const float sparse = std::ldexp(kSparse, surface.level);
  const float toSpacing = std::sqrt(std::numbers::pi_v<float> / (static_cast<float>(out.k) + 0.5f));
  parallelFor(monitor, out.size, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index point = pointAt(surface, i);
      if (!open.empty() && !open[point]) {
        frozen[i] = 1;
        some = true;
        continue;
      }
      const auto row = near.of(i);
      for (std::size_t a = 0; a < out.k; ++a) {
        const Offset offset = offsetBetween(in_, point, pointAt(surface, row[a]));
        if (!offset.seen) continue;
        if (offset.quarters != 0) turned = true;
        out.ways[i * out.k + a] = toWay(offset.pixels, offset.quarters);
      }
      const float spacing =
          toSpacing * distanceBetween(in_.points.positions[point],
                                      in_.points.positions[pointAt(surface, row[out.k - 1])]);
      if (spacing > sparse * in_.unitAt(point)) {
        frozen[i] = 1;
        some = true;
      }
    }
  });
  out.turned = turned;
  if (some) out.frozen = std::move(frozen);
  return out;
}

}  // namespace dapple
