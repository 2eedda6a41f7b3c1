// Boykov, Kolmogorov: An Experimental Comparison of Min-Cut/Max-Flow Algorithms for Energy
// Minimization in Vision, 2004, section 3, with the marking of section 3.2.3 of Kolmogorov's thesis
// (distances to the terminal with the time at which they were right).
#include "synthesis/max_flow.h"

#include <algorithm>
#include <limits>

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 1024;  // steps

}  // namespace

void MaxFlow::reset(std::size_t nodes) {
  nodes_.assign(nodes, Node{});
  arcs_.clear();
  queue_.clear();
  orphans_.clear();
  queueHead_ = 0;
  time_ = 0;
  flow_ = 0;
}

void MaxFlow::addTerminals(Index i, std::int32_t onSinkSide, std::int32_t onSourceSide) {
  // What both terminals would carry flows straight through.
  std::int32_t& rest = nodes_[i].rest;
  const std::int32_t in = onSinkSide + std::max(rest, 0), out = onSourceSide + std::max(-rest, 0);
  flow_ += std::min(in, out);
  rest = in - out;
}

void MaxFlow::addEdge(Index i, Index j, std::int32_t forward, std::int32_t backward) {
  const Index arc = static_cast<Index>(arcs_.size());
  arcs_.push_back({j, nodes_[i].firstArc, forward});
  arcs_.push_back({i, nodes_[j].firstArc, backward});
  nodes_[i].firstArc = arc;
  nodes_[j].firstArc = arc + 1;
}

void MaxFlow::wait(Index i) {
  if (nodes_[i].waiting) return;
  nodes_[i].waiting = true;
  queue_.push_back(i);
}

// Half of all paths have one arc only; no tree is needed for those.
void MaxFlow::pushDirect() {
  for (Index a = 0; a < arcs_.size(); ++a) {
    Node &from = nodes_[tail(a)], &to = nodes_[arcs_[a].head];
    if (from.rest <= 0 || to.rest >= 0) continue;
    const std::int32_t least = std::min({from.rest, -to.rest, arcs_[a].rest});
    from.rest -= least, to.rest += least;
    arcs_[a].rest -= least, arcs_[a ^ 1].rest += least;
    flow_ += least;
  }
}

void MaxFlow::startTrees() {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    if (node.rest == 0) continue;
    node.side = node.rest > 0 ? Side::Source : Side::Sink;
    node.parent = kTerminal;
    node.depth = 1;
    wait(static_cast<Index>(i));
  }
}

Index MaxFlow::nextActive() {
  while (queueHead_ < queue_.size()) {
    const Index i = queue_[queueHead_++];
    nodes_[i].waiting = false;
    if (nodes_[i].parent != kNone) return i;
  }
  return kNone;
}

// Takes free nodes around i into its tree; the arc from the source's to the sink's tree, if met.
Index MaxFlow::grow(Index i) {
  for (Index a = nodes_[i].firstArc; a != kNone; a = arcs_[a].next) {
    const Node& node = nodes_[i];
    const std::int32_t rest = node.side == Side::Source ? arcs_[a].rest : arcs_[a ^ 1].rest;
    if (rest == 0) continue;
    Node& other = nodes_[arcs_[a].head];
    if (other.parent == kNone) {
      other.side = node.side;
      other.parent = a ^ 1;
      other.seen = node.seen;
      other.depth = node.depth + 1;
      wait(arcs_[a].head);
    } else if (other.side != node.side) {
      return node.side == Side::Source ? a : a ^ 1;
    } else if (other.seen <= node.seen && other.depth > node.depth + 1) {
      other.parent = a ^ 1;  // a shorter way
      other.seen = node.seen;
      other.depth = node.depth + 1;
    }
  }
  return kNone;
}

void MaxFlow::orphan(Index i) {
  nodes_[i].parent = kOrphan;
  orphans_.push_back(i);
}

// Pushes what fits along source ... middle ... sink.
void MaxFlow::augment(Index middle) {
  std::int32_t least = arcs_[middle].rest;
  for (const Side side : {Side::Source, Side::Sink}) {
    Index i = side == Side::Source ? tail(middle) : arcs_[middle].head;
    for (; nodes_[i].parent != kTerminal; i = arcs_[nodes_[i].parent].head)
      least = std::min(least, restTowards(side, nodes_[i].parent));
    least = std::min(least, std::abs(nodes_[i].rest));
  }
  arcs_[middle].rest -= least;
  arcs_[middle ^ 1].rest += least;
  for (const Side side : {Side::Source, Side::Sink}) {
    Index i = side == Side::Source ? tail(middle) : arcs_[middle].head;
    while (nodes_[i].parent != kTerminal) {
      const Index along = side == Side::Source ? nodes_[i].parent ^ 1 : nodes_[i].parent;
      const Index above = arcs_[nodes_[i].parent].head;
      arcs_[along].rest -= least;
      arcs_[along ^ 1].rest += least;
      if (arcs_[along].rest == 0) orphan(i);
      i = above;
    }
    nodes_[i].rest += side == Side::Source ? -least : least;
    if (nodes_[i].rest == 0) orphan(i);
  }
  flow_ += least;
}

// Steps from i to its terminal, noted on the way; kNone when the way ends at an orphan.
Index MaxFlow::originDepth(Index i) {
  Index depth = 0, j = i;
  for (;;) {
    if (nodes_[j].seen == time_ && nodes_[j].parent != kOrphan) {
      depth += nodes_[j].depth;
      break;
    }
    ++depth;
    if (nodes_[j].parent == kTerminal) {
      nodes_[j].seen = time_;
      nodes_[j].depth = 1;
      break;
    }
    if (nodes_[j].parent == kOrphan) return kNone;
    j = arcs_[nodes_[j].parent].head;
  }
  Index below = depth;
  for (j = i; nodes_[j].seen != time_; j = arcs_[nodes_[j].parent].head) {
    nodes_[j].seen = time_;
    nodes_[j].depth = below--;
  }
  return depth;
}

void MaxFlow::adopt(Index i) {
  Node& node = nodes_[i];
  Index best = kNone, bestDepth = kNone;
  for (Index a = node.firstArc; a != kNone; a = arcs_[a].next) {
    const Node& other = nodes_[arcs_[a].head];
    if (other.side != node.side || other.parent == kNone || restTowards(node.side, a) == 0)
      continue;
    const Index depth = originDepth(arcs_[a].head);
    if (depth < bestDepth) bestDepth = depth, best = a;
  }
  if (best != kNone) {
    node.parent = best;
    node.seen = time_;
    node.depth = bestDepth + 1;
    return;
  }
  for (Index a = node.firstArc; a != kNone; a = arcs_[a].next) {
    const Index j = arcs_[a].head;
    if (nodes_[j].side != node.side || nodes_[j].parent == kNone) continue;
    // An orphan, too: if it stays in the tree it must grow back to here.
    if (restTowards(node.side, a) > 0) wait(j);
    const bool child = nodes_[j].parent < kOrphan && arcs_[nodes_[j].parent].head == i;
    if (child) orphan(j);
  }
  node.side = Side::Free;
  node.parent = kNone;
}

void MaxFlow::adopt() {
  for (std::size_t o = 0; o < orphans_.size(); ++o) adopt(orphans_[o]);
  orphans_.clear();
}

std::int64_t MaxFlow::solve(const Monitor* monitor) {
  pushDirect();
  startTrees();
  std::size_t steps = 0;
  for (Index i = nextActive(); i != kNone;) {
    if (monitor && ++steps % kCheckpointEvery == 0) monitor->checkpoint();
    const Index middle = grow(i);
    if (middle == kNone) {
      i = nextActive();
      continue;
    }
    ++time_;
    augment(middle);
    adopt();
    if (nodes_[i].parent == kNone) i = nextActive();
  }
  return flow_;
}

}  // namespace dapple
