// Not in [Zeng], who leaves the borders of pasted squares as they fall. A square was matched with
// all colours that lay in it, so that it also is a way to colour those: here every point may come
// from any square that covers it, and a minimum cut decides (seam_cut.cpp).
#include "synthesis/grid_seams.h"

#include <algorithm>
#include <memory>

#include "base/scratch_pool.h"
#include "points/tangent_frames.h"
#include "synthesis/grid_neighborhood.h"
#include "synthesis/patch_overlap.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 1024;     // points
constexpr std::size_t kSquareGrain = 8;  // squares
constexpr std::size_t kSquaresAtOnce = 512;
constexpr std::size_t kMostOfPoint = 4;  // squares; with 6 the score is the same

// The cut numbers pairs of choices of neighbouring points, of which it has at most 8 a point, both
// ways: a huge scan may offer fewer choices, in the end none.
std::size_t mostOfPoint(std::size_t points) {
  std::size_t most = kMostOfPoint;
  while (most > 1 && points * 16 * most * most >= kNone) --most;
  return most;
}

// A square that covers a point.
struct Cover {
  Index patch = kNone;
  vec2 offset{0};
  float reach = 0;  // from the square's centre, pixels; 0: the point belongs to it
};

// The squares that cover each point: its own first, then those whose centres are nearest.
class Covers {
 public:
  Covers(const SynthesisInput& input, std::span<const Index> centres, int size,
         const SourceMap& map, Monitor& monitor)
      : input_(input),
        centres_(centres),
        map_(map),
        monitor_(monitor),
        most_(mostOfPoint(input.points.size())),
        covers_(input.points.size() * most_),
        grids_([&input, size] { return std::make_unique<GridNeighborhood>(input, size, 0); }) {}

  PatchOverlap run() {
    for (std::size_t i = 0; i < map_.patch.size(); ++i)
      covers_[i * most_] = {map_.patch[i], map_.domain[i], 0};
    for (std::size_t first = 0; first < centres_.size(); first += kSquaresAtOnce)
      addSquares(first, std::min(kSquaresAtOnce, centres_.size() - first));
    return overlap();
  }

 private:
  void addSquares(std::size_t first, std::size_t count) {
    std::vector<std::vector<GridPoint>> found(count);
    parallelFor(monitor_, count, kSquareGrain, [&](std::size_t begin, std::size_t end) {
      grids_.use([&](GridNeighborhood& grid) {
        for (std::size_t s = begin; s < end; ++s) {
          grid.gather(centres_[first + s]);
          for (const GridPoint& point : grid.points())
            if (grid.covers(point)) found[s].push_back(point);
        }
      });
    });
    for (std::size_t s = 0; s < count; ++s)
      for (const GridPoint& point : found[s]) add(static_cast<Index>(first + s), point);
  }

  void add(Index patch, const GridPoint& point) {
    Cover* own = &covers_[std::size_t{point.id} * most_];
    if (own->patch == patch) return;
    Cover cover{patch, point.offset,
                std::max({std::abs(point.offset.x), std::abs(point.offset.y), 1e-3f})};
    for (std::size_t c = 1; c < most_; ++c) {
      if (own[c].patch != kNone && own[c].reach <= cover.reach) continue;
      std::swap(own[c], cover);
      if (cover.patch == kNone) return;
    }
  }

  PatchOverlap overlap() const {
    const std::size_t n = input_.points.size();
    PatchOverlap out;
    out.offset.assign(1, 0);
    out.offset.reserve(n + 1);
    for (std::size_t i = 0; i < n; ++i) {
      Index count = 0;
      while (count < most_ && covers_[i * most_ + count].patch != kNone) ++count;
      out.offset.push_back(out.offset.back() + count);
    }
    out.site.resize(out.offset[n]);
    out.reach.resize(out.offset[n]);
    out.distortion.assign(out.offset[n], 0.f);
    parallelFor(monitor_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (Index c = out.offset[i]; c < out.offset[i + 1]; ++c) {
          const Cover& cover = covers_[i * most_ + (c - out.offset[i])];
          out.site[c] = siteOf(i, cover);
          out.reach[c] = cover.reach;
        }
    });
    return out;
  }

  ChartSite siteOf(std::size_t i, const Cover& cover) const {
    const TangentFrame& frame = input_.frames[centres_[cover.patch]];
    ChartSite site;
    site.position = input_.chart ? (*input_.chart)[i] : input_.points.positions[i];
    site.normal = site.n = input_.points.normals[i];
    site.scale = input_.scaleAt(i);
    site.t = transported(frame.t, frame.n, site.n);
    site.q = cover.offset;
    site.patch = cover.patch;
    return site;
  }

  const SynthesisInput& input_;
  const std::span<const Index> centres_;
  const SourceMap& map_;
  Monitor& monitor_;
  const std::size_t most_;
  std::vector<Cover> covers_;  // n x most_, own first; no patch: none
  ScratchPool<GridNeighborhood> grids_;
};

}  // namespace

SeamStatistics cutSquares(const SynthesisInput& input, std::span<const Index> centres, int size,
                          SourceMap& map, Monitor& monitor) {
  const std::size_t n = input.points.size();
  std::vector<float> errors(centres.size(), 0);
  for (std::size_t i = 0; i < n; ++i) errors[map.patch[i]] = map.error[i];
  // The cut compares colours that are not filtered.
  parallelFor(monitor, n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) placePoint(map, input.swatch, i);
  });
  const PatchOverlap overlap = Covers(input, centres, size, map, monitor).run();
  std::fill(map.state.begin(), map.state.end(), PointState::Patch);
  const SeamStatistics statistics = cutSeams(input, overlap, map, monitor);
  std::fill(map.state.begin(), map.state.end(), PointState::Matched);
  for (std::size_t i = 0; i < n; ++i) map.error[i] = errors[map.patch[i]];
  return statistics;
}

}  // namespace dapple
