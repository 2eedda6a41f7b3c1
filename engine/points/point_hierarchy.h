// Coarser and coarser point sets by clustering four points into one ([Zhang] section 4.1).
#pragma once

#include <array>
#include <vector>

#include "base/monitor.h"
#include "points/neighborhoods.h"
#include "points/point_graph.h"
#include "points/point_set.h"

namespace dapple {

struct HierarchyLevel {
  std::vector<vec3> positions;       // n_l, mean of the children
  std::vector<TangentFrame> frames;  // n_l, normalised sum of the children's
  std::vector<Index> parent;         // n_l, ids into the next coarser level; empty at the top
  std::vector<std::array<Index, 4>> children;  // n_l, ids into the next finer level, kNone where a
                                               // cluster has fewer; empty at level 0
  Neighborhoods neighborhoods;  // of this level, as many as level 0 has where there are enough
                                // points; empty at level 0, whose own were given
};

// levels[0] is the point set itself; levels.back() the coarsest. Fewer levels than asked for when
// a level would have fewer than 16 points. Parents are numbered by their first child, so that a
// level is in Morton order when the finer one is. Deterministic. Throws Cancelled.
std::vector<HierarchyLevel> buildHierarchy(const PointSet& points,
                                           const std::vector<TangentFrame>& frames,
                                           const Neighborhoods& neighborhoods, int levels,
                                           Monitor& monitor);

// Which cluster of up to four linked points each point belongs to, n; clusters are numbered by
// their first point. `clusters` is set to their number.
std::vector<Index> clusterByFour(const Neighborhoods& neighborhoods, Index& clusters,
                                 Monitor& monitor);
std::vector<Index> clusterByFour(const PointGraph& graph, Index& clusters, Monitor& monitor);

}  // namespace dapple
