// Minimum cuts of small graphs (Boykov, Kolmogorov 2004: two search trees that are kept and
// mended).
#pragma once

#include <cstdint>
#include <vector>

#include "base/monitor.h"

namespace dapple {

// Capacities are integers, so that a result is exact and the same everywhere. One object serves for
// many graphs; its memory is kept.
class MaxFlow {
 public:
  // Forgets everything; `nodes` nodes without edges.
  void reset(std::size_t nodes);

  // Cost of node i on the sink's side and on the source's side, >= 0. Adds up.
  void addTerminals(Index i, std::int32_t onSinkSide, std::int32_t onSourceSide);
  // Cost of i on the source's and j on the sink's side, and the other way round, >= 0.
  void addEdge(Index i, Index j, std::int32_t forward, std::int32_t backward);

  // The cost of a cheapest cut. With a monitor it throws Cancelled.
  std::int64_t solve(const Monitor* monitor = nullptr);
  // After solve(): the side of i in a cheapest cut, the one with fewest nodes on the sink's side.
  bool onSinkSide(Index i) const { return nodes_[i].side == Side::Sink; }

 private:
  enum class Side : std::uint8_t { Free, Source, Sink };
  struct Node {
    Index firstArc = kNone;
    Index parent = kNone;   // the arc to it; or kTerminal, kOrphan, kNone: in no tree
    std::int32_t rest = 0;  // > 0 left from the source, < 0 left to the sink
    Index seen = 0;         // time at which `depth` was right
    Index depth = 0;        // steps to the terminal
    Side side = Side::Free;
    bool waiting = false;
  };
  struct Arc {
    Index head, next;
    std::int32_t rest;
  };
  static constexpr Index kTerminal = kNone - 1, kOrphan = kNone - 2;

  void pushDirect();
  void startTrees();
  void wait(Index i);
  Index nextActive();
  Index grow(Index i);
  void augment(Index middle);
  void orphan(Index i);
  void adopt();
  void adopt(Index i);
  Index originDepth(Index i);
  Index& tail(Index arc) { return arcs_[arc ^ 1].head; }
  // What can still flow from the source towards the sink through the tree arc from i.
  std::int32_t restTowards(Side side, Index arc) const {
    return side == Side::Source ? arcs_[arc ^ 1].rest : arcs_[arc].rest;
  }

  std::vector<Node> nodes_;
  std::vector<Arc> arcs_;  // in pairs: a ^ 1 is the way back
  std::vector<Index> queue_, orphans_;
  std::size_t queueHead_ = 0;
  Index time_ = 0;
  std::int64_t flow_ = 0;
};

}  // namespace dapple
