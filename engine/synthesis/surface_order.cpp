// [Zeng] keeps three sets: Y, coloured; B, the border, next to them; N, all others. The next point
// is the one of B with the shortest way from the start. The point before it on that way is nearer
// to the start, so that it is coloured already whenever all nearer points are: the nearest point
// that is not in Y always is in B. Points in the order of their distance, without those coloured
// meanwhile, are therefore the paper's order, and no set has to be kept.
//
// Departure: ways follow the links that the selection tools follow, 12 a point in both directions
// in place of 8, never through a thin sheet.
#include "synthesis/surface_order.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "points/connected_parts.h"
#include "regions/surface_distance.h"

namespace dapple {
namespace {

constexpr std::uint64_t kStartStream = 401;

// By part, where it comes and where it starts when nobody says so.
struct PartStart {
  bool given = false;
  std::uint64_t rank = 0;  // place of the first start given, else the least hash of a point
  Index point = kNone;

  bool before(const PartStart& other) const {
    return std::tuple(!given, rank, point) < std::tuple(!other.given, other.rank, other.point);
  }
};

std::vector<PartStart> startsOfParts(const ConnectedParts& parts, std::span<const Index> starts,
                                     std::uint64_t seed) {
  std::vector<PartStart> out(parts.count);
  const auto propose = [&](const PartStart& start) {
    PartStart& known = out[parts.part[start.point]];
    if (known.point == kNone || start.before(known)) known = start;
  };
  for (std::size_t s = 0; s < starts.size(); ++s) propose({true, s, starts[s]});
  for (Index i = 0; i < parts.part.size(); ++i)
    propose({false, hashBits(seed, kStartStream, i), i});
  return out;
}

}  // namespace

std::vector<Index> surfaceOrder(const PointGraph& graph, std::span<const Index> starts,
                                std::uint64_t seed, Monitor& monitor) {
  const std::size_t n = graph.points.size();
  for (const Index start : starts)
    if (start >= n) throw InvalidInput(fmt::format("start: {} is not one of {} points", start, n));
  const ConnectedParts parts =
      facingParts(graph.neighborhoods, graph.points.normals, linksOf(graph.neighborhoods));
  monitor.checkpoint();
  const std::vector<PartStart> firsts = startsOfParts(parts, starts, seed);
  std::vector<Index> sources(starts.begin(), starts.end());
  for (const PartStart& first : firsts)
    if (!first.given) sources.push_back(first.point);
  const std::vector<float> distance =
      surfaceDistances(graph, sources, std::numeric_limits<float>::infinity(), monitor);
  // Places of the parts, then of the points in them.
  std::vector<Index> byPlace(parts.count), place(parts.count);
  std::iota(byPlace.begin(), byPlace.end(), Index{0});
  std::sort(byPlace.begin(), byPlace.end(),
            [&](Index a, Index b) { return firsts[a].before(firsts[b]); });
  for (Index p = 0; p < parts.count; ++p) place[byPlace[p]] = p;
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::tuple(place[parts.part[a]], distance[a], a) <
           std::tuple(place[parts.part[b]], distance[b], b);
  });
  monitor.checkpoint();
  return order;
}

}  // namespace dapple
