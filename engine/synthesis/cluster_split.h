// Cutting clusters of points into smaller ones.
#pragma once

#include <span>
#include <vector>

#include "base/monitor.h"
#include "points/point_graph.h"
#include "points/point_set.h"

namespace dapple {

// Keeps its memory between calls. `points` and `graph` must outlive it.
class ClusterSplitter {
 public:
  ClusterSplitter(const PointSet& points, const PointGraph& graph);

  // The parts of `cluster` that hang together, numbered by their first point; points ascend.
  std::vector<std::vector<Index>> pieces(std::span<const Index> cluster, Monitor& monitor);

  // `children` parts of a cluster that hangs together (fewer when it has fewer points), each of the
  // points that are nearest to its seed along the surface; every seed is the point furthest from
  // those before, the first one is the cluster's. Points ascend when those of the cluster do.
  std::vector<std::vector<Index>> split(std::span<const Index> cluster, std::size_t children,
                                        Monitor& monitor);

 private:
  void open(std::span<const Index> cluster);
  void close(std::span<const Index> cluster);

  const PointSet& points_;
  const PointGraph& graph_;
  std::vector<Index> local_;  // n: place in the cluster at hand, kNone when not in it
};

}  // namespace dapple
