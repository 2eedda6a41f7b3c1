// [Zhang] section 4.1: "we select the point with the maximal number of clustered neighbours ... and
// cluster it with its three nearest unclustered neighbours".
//
// Departures: keys count the clustered points that have a point among *their* neighbours, not those
// among its own; the two differ for few points and this needs no reversed lists. Only the nearest
// kKeyNeighbours take part: more cost time and change nothing measurable.
#include "points/point_hierarchy.h"

#include <algorithm>

#include "base/errors.h"
#include "points/bucket_queue.h"

namespace dapple {
namespace {

constexpr std::size_t kKeyNeighbours = 12;
constexpr std::size_t kFewestPoints = 16;  // of a level
constexpr std::size_t kBatch = 4096;       // points between two looks at the monitor

// Unit axes with s x t = n, nearest to a sum of frames; `fallback` where the sum has no direction.
TangentFrame orthonormalized(const TangentFrame& sum, const TangentFrame& fallback) {
  constexpr float kShort = 1e-6f;
  const float length = glm::length(sum.n);
  if (length < kShort) return fallback;
  TangentFrame frame;
  frame.n = sum.n / length;
  vec3 t = sum.t - frame.n * glm::dot(frame.n, sum.t);
  if (glm::length(t) < kShort) t = glm::cross(frame.n, sum.s);
  if (glm::length(t) < kShort) t = fallback.t - frame.n * glm::dot(frame.n, fallback.t);
  if (glm::length(t) < kShort) t = glm::cross(frame.n, fallback.s);
  frame.t = glm::normalize(t);
  frame.s = glm::cross(frame.t, frame.n);
  return frame;
}

// Level l + 1 from level l, whose parents are known. Neighbourhoods are left to the caller.
HierarchyLevel parentsOf(const HierarchyLevel& fine, std::size_t count) {
  HierarchyLevel coarse;
  coarse.positions.resize(count);
  coarse.frames.resize(count);
  coarse.children.assign(count, {kNone, kNone, kNone, kNone});
  for (std::size_t i = 0; i < fine.parent.size(); ++i) {
    auto& children = coarse.children[fine.parent[i]];
    *std::find(children.begin(), children.end(), kNone) = static_cast<Index>(i);
  }
  for (std::size_t c = 0; c < count; ++c) {
    vec3 position(0);
    TangentFrame sum{vec3(0), vec3(0), vec3(0)};
    float members = 0;
    for (Index child : coarse.children[c]) {
      if (child == kNone) break;
      position += fine.positions[child];
      sum.s += fine.frames[child].s;
      sum.t += fine.frames[child].t;
      sum.n += fine.frames[child].n;
      ++members;
    }
    coarse.positions[c] = position / members;
    coarse.frames[c] = orthonormalized(sum, fine.frames[coarse.children[c][0]]);
  }
  return coarse;
}

// Renumbers the clusters in the order in which their first points come.
void numberByFirstPoint(std::vector<Index>& cluster, Index clusters) {
  std::vector<Index> number(clusters, kNone);
  Index next = 0;
  for (Index& c : cluster) {
    if (number[c] == kNone) number[c] = next++;
    c = number[c];
  }
}

// Links: Neighborhoods or PointGraph.
template <class Links>
std::vector<Index> clustersOf(const Links& links, Index& clusters, Monitor& monitor) {
  const std::size_t n = links.size();
  std::vector<Index> cluster(n, kNone);
  BucketQueue queue(n);
  clusters = 0;
  Index seed = 0;
  for (;;) {
    Index first = queue.pop();
    if (first == kNone) {
      while (seed < n && cluster[seed] != kNone) ++seed;
      if (seed == n) break;
      first = seed;
    }
    std::array<Index, 4> members{first, kNone, kNone, kNone};
    std::size_t size = 1;
    for (Index j : links.of(first)) {
      if (cluster[j] != kNone) continue;
      members[size++] = j;
      if (size == members.size()) break;
    }
    for (std::size_t m = 0; m < size; ++m) {
      cluster[members[m]] = clusters;
      queue.retire(members[m]);
    }
    for (std::size_t m = 0; m < size; ++m) {
      const std::span<const Index> row = links.of(members[m]);
      for (Index j : row.first(std::min(row.size(), kKeyNeighbours))) queue.raise(j);
    }
    if (++clusters % (kBatch / 4) == 0) monitor.checkpoint();
  }
  numberByFirstPoint(cluster, clusters);
  return cluster;
}

}  // namespace

std::vector<Index> clusterByFour(const Neighborhoods& neighborhoods, Index& clusters,
                                 Monitor& monitor) {
  return clustersOf(neighborhoods, clusters, monitor);
}

std::vector<Index> clusterByFour(const PointGraph& graph, Index& clusters, Monitor& monitor) {
  return clustersOf(graph, clusters, monitor);
}

std::vector<HierarchyLevel> buildHierarchy(const PointSet& points,
                                           const std::vector<TangentFrame>& frames,
                                           const Neighborhoods& neighborhoods, int levels,
                                           Monitor& monitor) {
  DAPPLE_CHECK(frames.size(), ==, points.size());
  DAPPLE_CHECK(neighborhoods.size(), ==, points.size());
  std::vector<HierarchyLevel> hierarchy(1);
  hierarchy[0].positions = points.positions;
  hierarchy[0].frames = frames;
  for (int level = 1; level < levels; ++level) {
    HierarchyLevel& fine = hierarchy.back();
    Index clusters = 0;
    std::vector<Index> parent =
        clusterByFour(level == 1 ? neighborhoods : fine.neighborhoods, clusters, monitor);
    if (clusters < kFewestPoints) break;
    fine.parent = std::move(parent);
    HierarchyLevel coarse = parentsOf(fine, clusters);
    const std::size_t k = std::min(neighborhoods.k, static_cast<std::size_t>(clusters) - 1);
    coarse.neighborhoods = buildNeighborhoods(coarse.positions, k, monitor);
    hierarchy.push_back(std::move(coarse));
  }
  return hierarchy;
}

}  // namespace dapple
