// The widest disc that covers a point is what Hildebrand and Rüegsegger, "A new method for the
// model-independent assessment of thickness in three-dimensional images", 1997, call the local
// thickness there. Its radius is not needed, only whether it comes to twice the depth d: then a
// disc of that very radius covers the point, too, and its centre lies within 2 d; a spacing further
// as it need not fall on a point. Most points are found not to be inner ones a few steps further
// inside.
#include "regions/inner_half.h"

#include "regions/surface_distance.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 256;

class Discs {
 public:
  Discs(const LinkedPoints& graph, const RegionDepths& regions)
      : graph_(graph),
        regions_(regions),
        links_(linksOf(graph.neighborhoods)),
        seenBy_(graph.points.size(), kNone) {}

  // Whether a disc of twice the point's depth, within its region, covers it.
  bool wideAround(Index point) {
    const float radius = 2 * regions_.depth[point];
    const vec3& centre = graph_.points.positions[point];
    queue_.assign(1, point);
    seenBy_[point] = point;
    for (std::size_t q = 0; q < queue_.size(); ++q)
      for (const Index j : graph_.neighborhoods.of(queue_[q]).first(links_)) {
        if (seenBy_[j] == point || !linked(queue_[q], j)) continue;
        if (distanceBetween(centre, graph_.points.positions[j]) > radius + regions_.spacing)
          continue;
        if (regions_.depth[j] >= radius) return true;
        seenBy_[j] = point;
        queue_.push_back(j);
      }
    return false;
  }

 private:
  bool linked(Index i, Index j) const {
    return regions_.label[i] == regions_.label[j] &&
           glm::dot(graph_.points.normals[i], graph_.points.normals[j]) > 0;
  }

  const LinkedPoints graph_;
  const RegionDepths regions_;
  const std::size_t links_;
  std::vector<Index> seenBy_;  // n, the point that last asked
  std::vector<Index> queue_;
};

}  // namespace

std::vector<bool> innerHalf(const LinkedPoints& graph, const RegionDepths& regions,
                            std::span<const Index> asked, Monitor& monitor) {
  std::vector<bool> out(asked.size());
  Discs discs(graph, regions);
  for (std::size_t a = 0; a < asked.size(); ++a) {
    if (a % kCheckpointEvery == 0) monitor.checkpoint();
    out[a] = !discs.wideAround(asked[a]);
  }
  return out;
}

}  // namespace dapple
