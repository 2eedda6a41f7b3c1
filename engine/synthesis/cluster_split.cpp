// [Soler] Hierarchical Pattern Mapping cuts clusters of faces; here links of a scan stand for the
// edges between them.
#include "synthesis/cluster_split.h"

#include <algorithm>
#include <limits>

#include "regions/surface_distance.h"

namespace dapple {
namespace {

constexpr std::size_t kLinks = 12;  // that shortest ways are searched along
constexpr std::size_t kCheckpointEvery = 8192;
constexpr float kFar = std::numeric_limits<float>::infinity();

// A cluster as a scan of its own: links out of it have no end.
struct PartGraph {
  PointSet points;  // positions only
  Neighborhoods near;
  std::vector<float> lengths;
};

PartGraph partGraph(const PointSet& points, const PointGraph& graph, std::span<const Index> cluster,
                    const std::vector<Index>& local) {
  PartGraph part;
  part.near.k = kLinks;
  part.near.ids.resize(cluster.size() * kLinks);
  part.lengths.assign(cluster.size() * kLinks, kFar);
  part.points.positions.reserve(cluster.size());
  for (std::size_t c = 0; c < cluster.size(); ++c) {
    const Index i = cluster[c];
    part.points.positions.push_back(points.positions[i]);
    std::size_t link = c * kLinks;
    for (const Index j : graph.of(i)) {
      if (local[j] == kNone) continue;
      part.near.ids[link] = local[j];
      part.lengths[link] = distanceBetween(points.positions[i], points.positions[j]);
      if (++link == (c + 1) * kLinks) break;
    }
    std::fill(part.near.ids.begin() + static_cast<std::ptrdiff_t>(link),
              part.near.ids.begin() + static_cast<std::ptrdiff_t>((c + 1) * kLinks),
              static_cast<Index>(c));
  }
  return part;
}

}  // namespace

ClusterSplitter::ClusterSplitter(const PointSet& points, const PointGraph& graph)
    : points_(points), graph_(graph), local_(points.size(), kNone) {}

void ClusterSplitter::open(std::span<const Index> cluster) {
  for (std::size_t c = 0; c < cluster.size(); ++c) local_[cluster[c]] = static_cast<Index>(c);
}

void ClusterSplitter::close(std::span<const Index> cluster) {
  for (const Index i : cluster) local_[i] = kNone;
}

std::vector<std::vector<Index>> ClusterSplitter::pieces(std::span<const Index> cluster,
                                                        Monitor& monitor) {
  open(cluster);
  std::vector<std::vector<Index>> out;
  std::size_t visited = 0;
  for (const Index start : cluster) {
    if (local_[start] == kNone) continue;
    std::vector<Index>& piece = out.emplace_back(1, start);
    local_[start] = kNone;
    for (std::size_t p = 0; p < piece.size(); ++p) {
      if (++visited % kCheckpointEvery == 0) monitor.checkpoint();
      for (const Index j : graph_.of(piece[p]))
        if (local_[j] != kNone) local_[j] = kNone, piece.push_back(j);
    }
    std::sort(piece.begin(), piece.end());
  }
  return out;
}

std::vector<std::vector<Index>> ClusterSplitter::split(std::span<const Index> cluster,
                                                       std::size_t children, Monitor& monitor) {
  monitor.checkpoint();
  open(cluster);
  const PartGraph part = partGraph(points_, graph_, cluster, local_);
  close(cluster);
  SurfaceWays ways({part.points, part.near}, part.lengths);
  std::size_t seed = 0, count = 0;
  do {
    ways.add(static_cast<Index>(seed), static_cast<Index>(count++));
    ways.run(kFar, monitor);
    const std::vector<float>& far = ways.distances();
    seed = static_cast<std::size_t>(std::max_element(far.begin(), far.end()) - far.begin());
  } while (count < children && ways.distances()[seed] > 0);
  std::vector<std::vector<Index>> out(count);
  for (std::size_t c = 0; c < cluster.size(); ++c) out[ways.labels()[c]].push_back(cluster[c]);
  return out;
}

}  // namespace dapple
