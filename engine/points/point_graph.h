// Links between points in rows of any length, flat.
#pragma once

#include <span>
#include <vector>

#include "points/neighborhoods.h"

namespace dapple {

struct PointGraph {
  std::vector<std::size_t> offset;  // n + 1
  std::vector<Index> ids;           // by point, its nearest first

  std::size_t size() const { return offset.empty() ? 0 : offset.size() - 1; }
  std::span<const Index> of(std::size_t i) const {
    return {ids.data() + offset[i], offset[i + 1] - offset[i]};
  }
};

inline constexpr std::size_t kMostLinked = 8;  // of a point's own neighbours

// Each point with its kMostLinked nearest neighbours, and those that have it among theirs, so that
// a link holds both ways even where the density changes. Only points whose normals (n) have a
// cosine of `facing` or more between them. Throws Cancelled.
PointGraph linkBothWays(const Neighborhoods& neighborhoods, const std::vector<vec3>& normals,
                        float facing, Monitor& monitor);

}  // namespace dapple
