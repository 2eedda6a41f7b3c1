// Coarser and coarser point sets by clustering four points into one ([Zhang] section 4.1).
#pragma once

#include <array>
#include <vector>

#include "base/monitor.h"
#include "points/neighborhoods.h"
#include "points/point_set.h"

namespace dapple {

struct HierarchyLevel {
  std::vector<vec3> positions;       // n_l, mean of the children
  std::vector<TangentFrame> frames;  // n_l, normalised sum of the children's
  std::vector<Index> parent;         // n_l, ids into the next coarser level; empty at the top
  std::vector<std::array<Index, 4>> children;  // n_l, ids into the next finer level, kNone where a
                                               // cluster has fewer; empty at level 0
};

// levels[0] is the point set itself; levels.back() the coarsest. Fewer levels than asked for when
// a level would have fewer than 16 points. Deterministic. Throws Cancelled.
std::vector<HierarchyLevel> buildHierarchy(const PointSet& points,
                                           const std::vector<TangentFrame>& frames,
                                           const Neighborhoods& neighborhoods, int levels,
                                           Monitor& monitor);

}  // namespace dapple
