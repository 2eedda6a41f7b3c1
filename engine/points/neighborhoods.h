// The k nearest other points of every point, flat, computed once per scan and shared by all stages.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "points/point_set.h"

namespace dapple {

struct Neighborhoods {
  std::size_t k = 0;
  std::vector<Index> ids;  // n x k, nearest first, ties by id

  std::size_t size() const { return k == 0 ? 0 : ids.size() / k; }
  std::span<const Index> of(std::size_t i) const { return {ids.data() + i * k, k}; }
};

// By which neighbours are sorted; not kept, as they would double the memory that a scan takes.
inline float distanceBetween(const vec3& a, const vec3& b) {
  const float dx = b.x - a.x, dy = b.y - a.y, dz = b.z - a.z;
  return std::sqrt(dx * dx + dy * dy + dz * dz);
}

// k nearest other points of each point (the point itself is left out). Throws InvalidInput when
// there are not more than k points. `portable` keeps off this processor's SIMD (for tests: the
// result is the same). Throws Cancelled.
Neighborhoods buildNeighborhoods(const std::vector<vec3>& positions, std::size_t k,
                                 Monitor& monitor, bool portable = false);

// For each point the points that have it among their k nearest, flat, ascending. In a scan of
// uneven density this is not the same as its own neighbours: growth from dense into sparse needs
// it.
struct ReverseNeighborhoods {
  std::vector<std::size_t> offset;  // n + 1
  std::vector<Index> ids;           // n x k in all

  std::span<const Index> of(std::size_t i) const {
    return {ids.data() + offset[i], offset[i + 1] - offset[i]};
  }
};
ReverseNeighborhoods reverseNeighborhoods(const Neighborhoods& neighborhoods,
                                          const Monitor& monitor);

// Side of the square of surface that one point owns, local units: the mean over points of
// r_k sqrt(pi / (k + 1/2)), r_k the distance to the k-th neighbour (methods: section 1.1).
double meanSpacing(const Neighborhoods& neighborhoods, const std::vector<vec3>& positions);

// The same for each point (n, local units).
std::vector<float> localSpacing(const Neighborhoods& neighborhoods,
                                const std::vector<vec3>& positions);

}  // namespace dapple
