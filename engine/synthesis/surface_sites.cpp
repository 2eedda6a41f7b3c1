// Departures from methods 3.4 and [Zhang] 4.1: a coarse site is one of the points, not the mean of
// four, so that it keeps a normal and axes that belong to it and never lies between two sheets; and
// levels are thinned by distance, so that they have the same scale everywhere.
#include "synthesis/surface_sites.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "base/errors.h"
#include "base/simd.h"

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
// Neighbours on levels that are no coarser than texels, where most sites keep their places. With 16
// and 8, mean F of eight swatches on the bunny of 85,000 points is 0.618 and 0.616.
constexpr std::size_t kFinestNear = 8;
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

// Of a site and up to N neighbours, in columns: what of them their offsets depend on.
template <std::size_t N>
struct alignas(64) NearFrames {
  float wayX[N], wayY[N], wayZ[N];  // to the neighbour, local units
  float sX[N], sY[N], sZ[N];
  float tX[N], tY[N], tZ[N];
  float facing[N];  // cosine of the angle between both normals
  float unit[N];
  // Found:
  float pixelsX[N], pixelsY[N];
  std::int32_t quarters[N], seen[N];
  std::size_t count = 0;

  void add(const SynthesisInput& input, Index from, Index to) {
    const std::vector<vec3>& positions = input.chart ? *input.chart : input.points.positions;
    const TangentFrame& frame = input.frames[to];
    const vec3 way = positions[to] - positions[from];
    wayX[count] = way.x, wayY[count] = way.y, wayZ[count] = way.z;
    sX[count] = frame.s.x, sY[count] = frame.s.y, sZ[count] = frame.s.z;
    tX[count] = frame.t.x, tY[count] = frame.t.y, tZ[count] = frame.t.z;
    facing[count] = glm::dot(input.frames[from].n, frame.n);
    unit[count] = input.unitAt(to);
    ++count;
  }
  SiteWays::Offset offset(std::size_t a) const {
    return {seen[a] != 0, {pixelsX[a], pixelsY[a]}, quarters[a]};
  }
};

// The offsets of all neighbours at once; lanes beyond the last one hold anything.
template <std::size_t N>
[[gnu::always_inline]] inline void findOffsets(NearFrames<N>& near, const TangentFrame& own,
                                               float unit) {
  for (std::size_t a = 0; a < N; ++a) {
    const float vx = near.wayX[a], vy = near.wayY[a], vz = near.wayZ[a];
    // (cos, sin) of the angle from own axes to the neighbour's, carried from its plane to the own
    // one by the least rotation, times 1 + facing.
    const float c = own.s.x * near.sX[a] + own.s.y * near.sY[a] + own.s.z * near.sZ[a] +
                    own.t.x * near.tX[a] + own.t.y * near.tY[a] + own.t.z * near.tZ[a];
    const float s = own.t.x * near.sX[a] + own.t.y * near.sY[a] + own.t.z * near.sZ[a] -
                    (own.s.x * near.tX[a] + own.s.y * near.tY[a] + own.s.z * near.tZ[a]);
    const float absC = std::abs(c), absS = std::abs(s);
    const std::int32_t along = c < 0 ? 2 : 0, across = s > 0 ? 1 : 3;
    const std::int32_t quarters = absC >= absS ? along : across;
    const float hereX = vx * own.s.x + vy * own.s.y + vz * own.s.z;
    const float hereY = vx * own.t.x + vy * own.t.y + vz * own.t.z;
    const float theirX = vx * near.sX[a] + vy * near.sY[a] + vz * near.sZ[a];
    const float theirY = vx * near.tX[a] + vy * near.tY[a] + vz * near.tZ[a];
    const float onceX = quarters & 1 ? -theirY : theirX, onceY = quarters & 1 ? theirX : theirY;
    const float thereX = quarters & 2 ? -onceX : onceX, thereY = quarters & 2 ? -onceY : onceY;
    const float length2 = vx * vx + vy * vy + vz * vz;
    const float here2 = hereX * hereX + hereY * hereY, there2 = thereX * thereX + thereY * thereY;
    const float least = kGrazing * kGrazing * length2;
    // [Zhang], Appendix A: as long as the way through space, along the tangent plane of either end.
    const float tiny = std::numeric_limits<float>::min();
    const float hereScale = 1 / std::sqrt(std::max(here2, tiny));
    const float thereScale = 1 / std::sqrt(std::max(there2, tiny));
    const float scale = std::sqrt(length2) / (unit + near.unit[a]);
    near.pixelsX[a] = (hereX * hereScale + thereX * thereScale) * scale;
    near.pixelsY[a] = -(hereY * hereScale + thereY * thereScale) * scale;  // image rows run down
    near.quarters[a] = quarters;
    const bool grazes = !(std::min(here2, there2) > least), twin = !(length2 > 0);
    near.seen[a] = (near.facing[a] > 0) & (!grazes | twin);
  }
}

// What the levels are synthesized on, a row of it at a time.
struct SiteRows {
  const SynthesisInput& input;
  const SurfaceLevel& surface;
  const Neighborhoods& near;
  std::span<const std::uint8_t> open;  // by point; empty: all are
  std::size_t k;
  WayScale toWay;

  bool isOpen(Index point) const { return open.empty() || open[point]; }
};

// The ways from sites begin..end to their neighbours, none from those that are not open; whether
// some have quarters.
DAPPLE_CLONES bool writeWays(const SiteRows& rows, std::size_t begin, std::size_t end, Way* ways) {
  NearFrames<kMostNear> near{};
  bool turned = false;
  for (std::size_t i = begin; i < end; ++i, ways += rows.k) {
    const Index point = pointAt(rows.surface, i);
    if (!rows.isOpen(point)) {
      std::fill_n(ways, rows.k, Way{kNoWay, 0});
      continue;
    }
    const auto row = rows.near.of(i);
    near.count = 0;
    for (std::size_t a = 0; a < rows.k; ++a)
      near.add(rows.input, point, pointAt(rows.surface, row[a]));
    findOffsets(near, rows.input.frames[point], rows.input.unitAt(point));
    for (std::size_t a = 0; a < rows.k; ++a) {
      turned |= near.seen[a] != 0 && near.quarters[a] != 0;
      ways[a] = near.seen[a] != 0 ? rows.toWay({near.pixelsX[a], near.pixelsY[a]}, near.quarters[a])
                                  : Way{kNoWay, 0};
    }
  }
  return turned;
}

}  // namespace

float readLevel(const SynthesisInput& input, std::size_t point) {
  const auto row = input.neighborhoods.of(point);
  const float k = static_cast<float>(row.size());
  const float spacing =
      distanceBetween(input.points.positions[point], input.points.positions[row.back()]) *
      std::sqrt(std::numbers::pi_v<float> / (k + 0.5f));
  return siteLevel(spacing, input.unitAt(point));
}

float siteLevel(float spacing, float unit) {
  return filterLevel(spacing / kUnfiltered, unit);
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

SiteWays::Offset SiteWays::between(Index from, Index to) const {
  NearFrames<1> near{};
  near.add(in_, from, to);
  findOffsets(near, in_.frames[from], in_.unitAt(from));
  return near.offset(0);
}

SiteLevel SiteWays::sitesOf(const SurfaceLevel& surface, std::int32_t reach,
                            std::span<const std::uint8_t> open, Monitor& monitor) const {
  const Neighborhoods& near = nearOf(surface, in_);
  SiteLevel out{.level = surface.level,
                .size = near.size(),
                .k = std::min(surface.level > 0 ? kMostNear : kFinestNear, near.k),
                .stride = near.k,
                .ids = near.ids};
  out.ways.resize(out.size * out.k);
  const SiteRows rows{in_, surface, near, open, out.k, WayScale(surface.level, reach)};
  std::vector<std::uint8_t> frozen(out.size, 0);
  std::atomic<bool> some = false, turned = false;
  const std::size_t farthest = std::min(kMostNear, near.k);
  const float sparse = std::ldexp(kSparse, surface.level);
  const float toSpacing =
      std::sqrt(std::numbers::pi_v<float> / (static_cast<float>(farthest) + 0.5f));
  parallelFor(monitor, out.size, kGrain, [&](std::size_t begin, std::size_t end) {
    if (writeWays(rows, begin, end, &out.ways[begin * out.k])) turned = true;
    for (std::size_t i = begin; i < end; ++i) {
      const Index point = pointAt(surface, i);
      const Index last = pointAt(surface, near.of(i)[farthest - 1]);
      const float spacing =
          toSpacing * distanceBetween(in_.points.positions[point], in_.points.positions[last]);
      if (!rows.isOpen(point) || spacing > sparse * in_.unitAt(point)) {
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
