#include "synthesis/max_flow.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/hash_rng.h"

using namespace dapple;

namespace {

struct Edge {
  Index i, j;
  std::int32_t forward, backward;
};

struct Graph {
  std::vector<std::int32_t> onSinkSide, onSourceSide;
  std::vector<Edge> edges;
};

// Graphs of all densities, with many zeros and ties.
Graph randomGraph(std::size_t nodes, std::uint64_t seed, std::uint64_t most = 12) {
  Graph graph;
  std::uint64_t draw = 0;
  auto capacity = [&] {
    const bool none = hashUniform(seed, 1, ++draw) < 0.4f;
    return none ? 0 : static_cast<std::int32_t>(hashBelow(most, seed, 2, draw));
  };
  for (std::size_t i = 0; i < nodes; ++i) {
    graph.onSinkSide.push_back(capacity());
    graph.onSourceSide.push_back(capacity());
  }
  const std::size_t edges = hashBelow(3 * nodes, seed, 3);
  for (std::size_t e = 0; e < edges; ++e) {
    const Index i = static_cast<Index>(hashBelow(nodes, seed, 4, e));
    const Index j = static_cast<Index>(hashBelow(nodes, seed, 5, e));
    if (i != j) graph.edges.push_back({i, j, capacity(), capacity()});
  }
  return graph;
}

// Nodes of a grid, joined one way with some near them; few have terminals, and many cuts tie.
Graph localGraph(Index side, std::uint64_t seed) {
  Graph graph;
  const Index nodes = side * side;
  for (Index i = 0; i < nodes; ++i) {
    const auto draw = static_cast<std::int32_t>(hashBelow(50, seed, 10, i));
    graph.onSinkSide.push_back(draw < 15 && i % 2 == 0 ? draw : 0);
    graph.onSourceSide.push_back(draw < 15 && i % 2 == 1 ? draw : 0);
  }
  for (Index i = 0; i < nodes; ++i)
    for (const Index step : {Index{1}, side - 1, side, side + 1, 2 * side + 1}) {
      if (i + step >= nodes || hashUniform(seed, 11, i, step) > 0.8f) continue;
      const auto capacity = static_cast<std::int32_t>(hashBelow(5, seed, 12, i, step));
      const bool forth = hashUniform(seed, 13, i, step) < 0.5f;
      graph.edges.push_back({i, i + step, forth ? capacity : 0, forth ? 0 : capacity});
    }
  return graph;
}

template <class InSink>
std::int64_t costWhere(const Graph& graph, InSink inSink) {
  std::int64_t cost = 0;
  for (Index i = 0; i < graph.onSinkSide.size(); ++i)
    cost += inSink(i) ? graph.onSinkSide[i] : graph.onSourceSide[i];
  for (const Edge& edge : graph.edges) {
    if (!inSink(edge.i) && inSink(edge.j)) cost += edge.forward;
    if (inSink(edge.i) && !inSink(edge.j)) cost += edge.backward;
  }
  return cost;
}

std::int64_t costOf(const Graph& graph, unsigned sinkSide) {
  return costWhere(graph, [&](Index i) { return (sinkSide >> i & 1) != 0; });
}

void load(const Graph& graph, MaxFlow& flow) {
  flow.reset(graph.onSinkSide.size());
  for (Index i = 0; i < graph.onSinkSide.size(); ++i)
    flow.addTerminals(i, graph.onSinkSide[i], graph.onSourceSide[i]);
  for (const Edge& edge : graph.edges) flow.addEdge(edge.i, edge.j, edge.forward, edge.backward);
}

}  // namespace

TEST_CASE("a minimum cut costs what the best of all cuts costs") {
  MaxFlow flow;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    const std::size_t nodes = 2 + seed % 9;
    const Graph graph = randomGraph(nodes, seed);
    load(graph, flow);
    const std::int64_t found = flow.solve();
    std::int64_t best = costOf(graph, 0);
    for (unsigned cut = 1; cut < 1u << nodes; ++cut) best = std::min(best, costOf(graph, cut));
    unsigned sides = 0;
    for (Index i = 0; i < nodes; ++i) sides |= (flow.onSinkSide(i) ? 1u : 0u) << i;
    REQUIRE(found == best);
    REQUIRE(costOf(graph, sides) == best);
  }
}

TEST_CASE("of equally cheap cuts the one with fewest nodes on the sink's side is found") {
  MaxFlow flow;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const std::size_t nodes = 2 + seed % 8;
    const Graph graph = randomGraph(nodes, seed + 5000);
    load(graph, flow);
    const std::int64_t best = flow.solve();
    std::size_t onSink = 0;
    for (Index i = 0; i < nodes; ++i) onSink += flow.onSinkSide(i) ? 1 : 0;
    for (unsigned cut = 0; cut < 1u << nodes; ++cut) {
      if (costOf(graph, cut) > best) continue;
      REQUIRE(onSink <= static_cast<std::size_t>(__builtin_popcount(cut)));
    }
  }
}

TEST_CASE("the cut of a large graph costs what flows through it") {
  MaxFlow flow;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Graph graph = seed % 2 == 0 ? randomGraph(50 + seed, seed, 8000) : localGraph(30, seed);
    load(graph, flow);
    const std::int64_t found = flow.solve();
    CHECK(costWhere(graph, [&](Index i) { return flow.onSinkSide(i); }) == found);
  }
}

TEST_CASE("a long chain is cut at its weakest link") {
  MaxFlow flow;
  const Index nodes = 20000, weakest = 12345;
  flow.reset(nodes);
  flow.addTerminals(0, 1000, 0);
  flow.addTerminals(nodes - 1, 0, 1000);
  for (Index i = 0; i + 1 < nodes; ++i) flow.addEdge(i, i + 1, i == weakest ? 7 : 9, 0);
  CHECK(flow.solve() == 7);
  CHECK_FALSE(flow.onSinkSide(weakest));
  CHECK(flow.onSinkSide(weakest + 1));
}
