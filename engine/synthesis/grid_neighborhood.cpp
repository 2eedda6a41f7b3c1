// [Zeng] Texture Synthesis from Samples for Point-Sampled Geometry: neighbours are projected onto
// the tangent plane along its normal, keep their distance from the centre, and every node of an
// N x N grid takes the nearest of them.
//
// Departures (methods: section 5):
// - the paper's axes, Y = d and X = n x d, lay the swatch on the surface as in a mirror; here
//   X = d x n, so that S x T = N;
// - the paper's 300 (N = 11) and 600 (N = 21) neighbours do not reach the corners, for which it
//   takes 1.8 N^2 at one point a pixel: all points within reach of a node are taken, found from
//   neighbour to neighbour;
// - a node takes no point further away than kReach: where points are missing, far colours would be
//   compared.
#include "synthesis/grid_neighborhood.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/errors.h"
#include "synthesis/patch_overlap.h"

namespace dapple {
namespace {

constexpr float kReach = 0.75f;     // pixels from a node to its point
constexpr std::size_t kLinks = 12;  // nearest neighbours that the walk goes on to

}  // namespace

GridNeighborhood::GridNeighborhood(const SynthesisInput& input, int size, int neighbours)
    : input_(input),
      positions_(input.chart ? *input.chart : input.points.positions),
      size_(size),
      neighbours_(static_cast<std::size_t>(neighbours)),
      stamp_(input.points.size(), kNone),
      nodes_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)),
      nodeDistance2_(nodes_.size()) {
  DAPPLE_CHECK(size % 2, ==, 1);
}

// Half the diagonal of the grid, and what its corner nodes reach.
float GridNeighborhood::reachOf(int size, float unit) {
  return unit * (std::sqrt(0.5f) * static_cast<float>(size - 1) + kReach);
}

bool GridNeighborhood::covers(const GridPoint& point) const {
  const vec2 beyond = glm::abs(point.offset) - static_cast<float>(size_ / 2);
  return std::max(beyond.x, beyond.y) <= 0.5f;
}

void GridNeighborhood::gather(Index centre) {
  walk(centre, reachOf(size_, input_.unitAt(centre)));
  if (neighbours_ > 0 && met_.size() > neighbours_ + 1) keepNearest(centre);
  const TangentFrame& frame = input_.frames[centre];
  ChartSite site;
  site.position = positions_[centre];
  site.n = frame.n, site.t = frame.t, site.scale = input_.scaleAt(centre);
  points_.clear();
  for (const Index i : met_) {
    const float scale = 0.5f * (site.scale + input_.scaleAt(i));
    points_.push_back({i, carriedPlace(site, positions_[i], input_.unit * scale)});
  }
  fillNodes();
}

// All within reach of the centre, from neighbour to neighbour on its side of the surface.
void GridNeighborhood::walk(Index centre, float reach) {
  const vec3 normal = input_.points.normals[centre], position = positions_[centre];
  const std::size_t links = std::min(kLinks, input_.neighborhoods.k);
  if (++call_ == kNone) std::fill(stamp_.begin(), stamp_.end(), kNone), call_ = 0;
  met_.assign(1, centre);
  stamp_[centre] = call_;
  for (std::size_t m = 0; m < met_.size(); ++m)
    for (const Index j : input_.neighborhoods.of(met_[m]).first(links)) {
      if (stamp_[j] == call_) continue;
      stamp_[j] = call_;
      if (!(distanceBetween(position, positions_[j]) <= reach)) continue;
      if (glm::dot(normal, input_.points.normals[j]) > 0) met_.push_back(j);
    }
}

void GridNeighborhood::keepNearest(Index centre) {
  const vec3 position = positions_[centre];
  const auto nearer = [&](Index a, Index b) {
    const float da = distanceBetween(position, positions_[a]),
                db = distanceBetween(position, positions_[b]);
    return da < db || (da == db && a < b);
  };
  std::nth_element(met_.begin() + 1, met_.begin() + static_cast<std::ptrdiff_t>(neighbours_),
                   met_.end(), nearer);
  met_.resize(neighbours_ + 1);
  std::sort(met_.begin() + 1, met_.end());
}

void GridNeighborhood::fillNodes() {
  std::fill(nodes_.begin(), nodes_.end(), kNone);
  std::fill(nodeDistance2_.begin(), nodeDistance2_.end(), kReach * kReach);
  const int half = size_ / 2;
  for (Index p = 0; p < points_.size(); ++p) {
    const vec2 at = points_[p].offset + static_cast<float>(half);
    const int x0 = std::max(0, static_cast<int>(std::ceil(at.x - kReach)));
    const int y0 = std::max(0, static_cast<int>(std::ceil(at.y - kReach)));
    const int x1 = std::min(size_ - 1, static_cast<int>(std::floor(at.x + kReach)));
    const int y1 = std::min(size_ - 1, static_cast<int>(std::floor(at.y + kReach)));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const vec2 d = at - vec2(x, y);
        const auto node = static_cast<std::size_t>(y * size_ + x);
        const float distance2 = glm::dot(d, d);
        if (!(distance2 < nodeDistance2_[node])) continue;
        nodeDistance2_[node] = distance2;
        nodes_[node] = p;
      }
  }
}

}  // namespace dapple
