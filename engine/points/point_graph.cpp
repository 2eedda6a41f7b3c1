#include "points/point_graph.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 8192;  // points of a chunk, and between two looks at the monitor

// Which of a point's nearest neighbours are linked, a bit each, and which of these links have to
// be entered in the neighbour's row as well, as it does not know of them.
struct LinkBits {
  std::uint8_t linked = 0, oneWay = 0;
};

LinkBits linkBits(const Neighborhoods& neighborhoods, const std::vector<vec3>& normals, Index i,
                  float facing) {
  const std::size_t used = std::min(neighborhoods.k, kMostLinked);
  LinkBits bits;
  const auto own = neighborhoods.of(i).first(used);
  for (std::size_t c = 0; c < used; ++c) {
    if (!(glm::dot(normals[i], normals[own[c]]) >= facing)) continue;
    bits.linked = static_cast<std::uint8_t>(bits.linked | 1u << c);
    const auto back = neighborhoods.of(own[c]).first(used);
    if (std::find(back.begin(), back.end(), i) == back.end())
      bits.oneWay = static_cast<std::uint8_t>(bits.oneWay | 1u << c);
  }
  return bits;
}

template <class Visit>
void forEachBit(std::uint8_t bits, const Visit& visit) {
  for (unsigned left = bits; left != 0; left &= left - 1)
    visit(static_cast<std::size_t>(std::countr_zero(left)));
}

}  // namespace

PointGraph linkBothWays(const Neighborhoods& neighborhoods, const std::vector<vec3>& normals,
                        float facing, Monitor& monitor) {
  static_assert(kMostLinked <= 8, "LinkBits has a bit for each");
  const std::size_t n = neighborhoods.size();
  DAPPLE_CHECK(normals.size(), ==, n);
  std::vector<LinkBits> bits(n);
  parallelFor(monitor, n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      bits[i] = linkBits(neighborhoods, normals, static_cast<Index>(i), facing);
  });
  PointGraph graph;
  graph.offset.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (i % kGrain == 0) monitor.checkpoint();
    graph.offset[i + 1] += static_cast<std::size_t>(std::popcount(bits[i].linked));
    forEachBit(bits[i].oneWay, [&](std::size_t c) { ++graph.offset[neighborhoods.of(i)[c] + 1]; });
  }
  // While rows are filled, offset[i + 1] is where row i goes on: at last, where it ends.
  std::size_t all = 0;
  for (std::size_t i = 0; i < n; ++i) all += std::exchange(graph.offset[i + 1], all);
  graph.ids.resize(all);
  for (std::size_t i = 0; i < n; ++i) {
    if (i % kGrain == 0) monitor.checkpoint();
    std::size_t& next = graph.offset[i + 1];
    forEachBit(bits[i].linked, [&](std::size_t c) { graph.ids[next++] = neighborhoods.of(i)[c]; });
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (i % kGrain == 0) monitor.checkpoint();
    forEachBit(bits[i].oneWay, [&](std::size_t c) {
      graph.ids[graph.offset[neighborhoods.of(i)[c] + 1]++] = static_cast<Index>(i);
    });
  }
  return graph;
}

}  // namespace dapple
