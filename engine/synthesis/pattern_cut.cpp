// Graph cuts after Kwatra et al. 2003, with their cost of a seam divided by the gradient (their
// section 4.1: seams hide along edges), and swap moves of Boykov, Veksler, Zabih 2001: two patterns
// at a time part the points that show one of them. Two patterns are parted by a single minimum cut.
//
// Departure: their cost divides by the gradient alone, so that a flat part costs without bound.
// Here it falls from the difference itself, at no gradient, to none.
#include "synthesis/pattern_cut.h"

#include <algorithm>
#include <utility>

#include "synthesis/max_flow.h"

namespace dapple {
namespace {

using Cost = std::int32_t;

constexpr std::size_t kLinks = 8;       // nearest neighbours that a border is counted between
constexpr std::size_t kMostRounds = 4;  // over all pairs of patterns
constexpr float kCostOfOne = 4096;      // integer cost of a colour difference of 1
constexpr float kHalfGradient = 0.15f;  // colour step that halves a cost
constexpr Cost kForeign = 1;            // of an option: where all is alike the border stays
constexpr std::size_t kCheckpointEvery = 4096;

class Cutter {
 public:
  Cutter(const PatternCutInput& input, Monitor& monitor)
      : in_(input), monitor_(monitor), node_(input.points.size(), kNone) {
    for (Index o = 0; o < in_.options.size(); ++o) {
      const Index point = in_.options[o].point;
      if (node_[point] == kNone) {
        node_[point] = static_cast<Index>(nodes_.size());
        nodes_.push_back({point, o, o});
      }
      nodes_.back().end = o + 1;
    }
    findLinks();
  }

  // Sets what each node shows.
  void show(const std::vector<bool>& taken) {
    for (Node& node : nodes_) {
      node.shown = in_.own[node.point];
      for (Index o = node.begin; o < node.end; ++o)
        if (taken[o]) node.shown = in_.options[o].pattern;
    }
  }

  double energy() const {
    std::int64_t sum = 0;
    for (const Link& link : links_) sum += seam(link.a, shownAt(link.a), link.b, shownAt(link.b));
    return static_cast<double>(sum) / kCostOfOne;
  }

  void run() {
    const std::vector<std::pair<std::uint16_t, std::uint16_t>> pairs = meetingPatterns();
    for (std::size_t round = 0; round < kMostRounds; ++round) {
      bool changed = false;
      for (const auto& [p, q] : pairs) changed |= swap(p, q);
      if (!changed || pairs.size() == 1) return;
    }
  }

  std::vector<bool> taken() const {
    std::vector<bool> out(in_.options.size(), false);
    for (const Node& node : nodes_)
      for (Index o = node.begin; o < node.end; ++o) out[o] = in_.options[o].pattern == node.shown;
    return out;
  }

 private:
  struct Node {
    Index point;
    Index begin, end;  // options
    std::uint16_t shown = kNoPattern;
    Index local = kNone;  // in the swap at hand
  };
  struct Link {
    Index a, b;  // points, of which one at least is a node's
  };

  std::span<const Index> near(Index i) const {
    return in_.neighborhoods.of(i).first(std::min(kLinks, in_.neighborhoods.k));
  }

  // Pairs of which one is near the other, each once.
  void findLinks() {
    for (Index i = 0; i < in_.points.size(); ++i) {
      if (i % kCheckpointEvery == 0) monitor_.checkpoint();
      if (in_.own[i] == kNoPattern) continue;
      for (const Index j : near(i)) {
        if (in_.own[j] == kNoPattern || (node_[i] == kNone && node_[j] == kNone)) continue;
        if (!(glm::dot(in_.points.normals[i], in_.points.normals[j]) > 0)) continue;
        const auto back = near(j);
        if (j < i && std::find(back.begin(), back.end(), i) != back.end()) continue;
        links_.push_back({i, j});
      }
    }
  }

  std::uint16_t shownAt(Index point) const {
    return node_[point] == kNone ? in_.own[point] : nodes_[node_[point]].shown;
  }

  // Null: the pattern does not reach the point.
  const vec3* colourOf(Index point, std::uint16_t pattern) const {
    if (in_.own[point] == pattern) return &in_.colour[point];
    if (node_[point] == kNone) return nullptr;
    const Node& node = nodes_[node_[point]];
    for (Index o = node.begin; o < node.end; ++o)
      if (in_.options[o].pattern == pattern) return &in_.options[o].colour;
    return nullptr;
  }

  // Of point a showing p and b showing q. Where a pattern does not reach one end, the other counts
  // for both.
  Cost seam(Index a, std::uint16_t p, Index b, std::uint16_t q) const {
    if (p == q) return 0;
    const vec3 *pa = colourOf(a, p), *qa = colourOf(a, q), *pb = colourOf(b, p),
               *qb = colourOf(b, q);
    float difference = 0;
    if (qa && pb)
      difference = glm::distance(*pa, *qa) + glm::distance(*pb, *qb);
    else if (qa || pb)
      difference = 2 * (qa ? glm::distance(*pa, *qa) : glm::distance(*pb, *qb));
    else
      difference = 2 * glm::distance(*pa, *qb);
    const float gradient = (pb ? glm::distance(*pa, *pb) : 0) + (qa ? glm::distance(*qa, *qb) : 0);
    const float hidden = kHalfGradient / (kHalfGradient + gradient);
    return static_cast<Cost>(kCostOfOne * difference * hidden + 0.5f);
  }

  std::vector<std::pair<std::uint16_t, std::uint16_t>> meetingPatterns() const {
    std::vector<std::pair<std::uint16_t, std::uint16_t>> pairs;
    const auto add = [&](std::uint16_t p, std::uint16_t q) {
      pairs.emplace_back(std::min(p, q), std::max(p, q));
    };
    for (const Node& node : nodes_)
      for (Index o = node.begin; o < node.end; ++o) {
        add(in_.own[node.point], in_.options[o].pattern);
        for (Index other = node.begin; other < o; ++other)
          add(in_.options[other].pattern, in_.options[o].pattern);
      }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
  }

  Cost foreign(const Node& node, std::uint16_t pattern) const {
    return in_.own[node.point] == pattern ? 0 : kForeign;
  }

  // Parts the nodes that show p or q and may show both: p is the source's side. False: as they were
  // they were as cheap.
  bool swap(std::uint16_t p, std::uint16_t q) {
    std::vector<Index> part;
    for (Index n = 0; n < nodes_.size(); ++n) {
      Node& node = nodes_[n];
      node.local = kNone;
      if (node.shown != p && node.shown != q) continue;
      if (!colourOf(node.point, p) || !colourOf(node.point, q)) continue;
      node.local = static_cast<Index>(part.size());
      part.push_back(n);
    }
    if (part.empty()) return false;
    flow_.reset(part.size());
    std::int64_t before = 0;
    for (const Index n : part) {
      const Node& node = nodes_[n];
      flow_.addTerminals(node.local, foreign(node, q), foreign(node, p));
      before += foreign(node, node.shown);
    }
    for (std::size_t l = 0; l < links_.size(); ++l) {
      if (l % kCheckpointEvery == 0) monitor_.checkpoint();
      before += addLink(links_[l], p, q);
    }
    if (flow_.solve(&monitor_) >= before) return false;
    for (const Index n : part) nodes_[n].shown = flow_.onSinkSide(nodes_[n].local) ? q : p;
    return true;
  }

  Index localOf(Index point) const {
    return node_[point] == kNone ? kNone : nodes_[node_[point]].local;
  }

  // What the link costs now, if it can cost something else.
  Cost addLink(const Link& link, std::uint16_t p, std::uint16_t q) {
    const Index a = localOf(link.a), b = localOf(link.b);
    if (a == kNone && b == kNone) return 0;
    const std::uint16_t showsA = shownAt(link.a), showsB = shownAt(link.b);
    if (a == kNone)
      flow_.addTerminals(b, seam(link.a, showsA, link.b, q), seam(link.a, showsA, link.b, p));
    else if (b == kNone)
      flow_.addTerminals(a, seam(link.a, q, link.b, showsB), seam(link.a, p, link.b, showsB));
    else
      flow_.addEdge(a, b, seam(link.a, p, link.b, q), seam(link.a, q, link.b, p));
    return seam(link.a, showsA, link.b, showsB);
  }

  const PatternCutInput& in_;
  Monitor& monitor_;
  std::vector<Index> node_;  // n: of a point, or kNone
  std::vector<Node> nodes_;
  std::vector<Link> links_;
  MaxFlow flow_;
};

}  // namespace

double patternSeams(const PatternCutInput& input, const std::vector<bool>& taken,
                    Monitor& monitor) {
  Cutter cutter(input, monitor);
  cutter.show(taken);
  return cutter.energy();
}

PatternCut cutPatterns(const PatternCutInput& input, Monitor& monitor) {
  PatternCut out{.taken = std::vector<bool>(input.options.size(), false)};
  if (input.options.empty()) return out;
  Cutter cutter(input, monitor);
  cutter.show(out.taken);
  out.energyBefore = cutter.energy();
  cutter.run();
  out.energyAfter = cutter.energy();
  out.taken = cutter.taken();
  return out;
}

}  // namespace dapple
