// Cost of a seam after Kwatra et al. 2003: at both ends of an edge the colour, and the relief where
// there is one, differs between the two layouts that meet there. All costs are looked up many times
// by the cuts, so they are computed once.
#include "synthesis/seam_graph.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 512;
constexpr std::size_t kEdges = 8;        // nearest neighbours that a seam is counted between
constexpr float kPerDistortion = 0.01f;  // cost of D = 1, as a colour difference
constexpr float kMostDistortion = 5;     // counted
constexpr float kUnknownSheet = 0.1f;    // added where a sheet ends at a point
static_assert(kSeamCost * 2 * (kUnknownSheet + 2) < 65535, "costs are 16 bits wide");

class Builder {
 public:
  Builder(const SynthesisInput& input, const PatchOverlap& overlap, const SourceMap& map,
          Monitor& monitor)
      : input_(input), overlap_(overlap), map_(map), monitor_(monitor) {}

  SeamGraph run() {
    addCandidates();
    addNodes();
    findPairs();
    fillNodes();
    foldFixed();
    parallelFor(monitor_, pairs_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) fillPair(pairs_[p]);
    });
    return std::move(graph_);
  }

 private:
  struct Pair {
    Index low, high;                  // nodes
    Index forward = 0, backward = 0;  // their half edges
  };
  struct FixedPair {
    Index node, point;
  };

  vec2 texelOf(Index c) const {
    const ChartSite& site = overlap_.site[c];
    return wrapTexel(input_.swatch, site.q + map_.placement[site.patch]);
  }

  // Leaves out those that the swatch has no texel for.
  void addCandidates() {
    const std::size_t n = input_.points.size(), total = overlap_.site.size();
    std::vector<std::uint8_t> usable(total, 1);
    graph_.first.assign(n + 1, 0);
    parallelFor(monitor_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        for (Index c = overlap_.offset[i]; c < overlap_.offset[i + 1]; ++c) {
          if (overlap_.reach[c] > 0) usable[c] = usableTexel(input_.swatch, texelOf(c)) ? 1 : 0;
          graph_.first[i + 1] += usable[c];
        }
      }
    });
    for (std::size_t i = 0; i < n; ++i) graph_.first[i + 1] += graph_.first[i];
    graph_.source.resize(graph_.first[n]);
    graph_.texel.resize(graph_.first[n]);
    graph_.colour.resize(graph_.first[n]);
    const bool hasRelief = !input_.swatch.relief.empty();
    if (hasRelief) graph_.relief.resize(graph_.first[n]);
    parallelFor(monitor_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Index next = graph_.first[i];
        for (Index c = overlap_.offset[i]; c < overlap_.offset[i + 1]; ++c) {
          if (!usable[c]) continue;
          const bool own = overlap_.reach[c] == 0;
          graph_.source[next] = c;
          graph_.texel[next] = own ? map_.texel[i] : texelOf(c);
          graph_.colour[next] =
              own ? map_.colour[i] : sampleSwatch(input_.swatch, graph_.texel[next]);
          if (hasRelief) graph_.relief[next] = sampleRelief(input_.swatch, graph_.texel[next]);
          ++next;
        }
      }
    });
  }

  void addNodes() {
    const std::size_t n = input_.points.size();
    node_.assign(n, kNone);
    graph_.firstData.push_back(0);
    for (std::size_t i = 0; i < n; ++i) {
      const Index count = graph_.first[i + 1] - graph_.first[i];
      if (count < 2) continue;
      node_[i] = static_cast<Index>(graph_.point.size());
      graph_.point.push_back(static_cast<Index>(i));
      graph_.firstData.push_back(graph_.firstData.back() + count);
    }
    graph_.data.resize(graph_.firstData.back());
    graph_.torn.assign(graph_.nodes(), 0);
    monitor_.checkpoint();
  }

  std::span<const Index> near(Index i) const {
    return input_.neighborhoods.of(i).first(std::min(kEdges, input_.neighborhoods.k));
  }

  bool nearBack(Index j, Index i) const {
    const auto back = near(j);
    return std::find(back.begin(), back.end(), i) != back.end();
  }

  // Pairs of which one is near the other and one has a choice, each once.
  void findPairs() {
    std::vector<Index> edges(graph_.nodes() + 1, 0);
    for (Index i = 0; i < input_.points.size(); ++i) {
      if (i % kGrain == 0) monitor_.checkpoint();
      if (graph_.count(i) == 0) continue;
      for (const Index j : near(i)) {
        const Index u = node_[i], v = node_[j];
        if ((u == kNone && v == kNone) || graph_.count(j) == 0) continue;
        if (glm::dot(input_.points.normals[i], input_.points.normals[j]) <= 0) continue;
        if (j < i && nearBack(j, i)) continue;
        if (u == kNone) {
          fixed_.push_back({v, i});
        } else if (v == kNone) {
          fixed_.push_back({u, j});
        } else {
          pairs_.push_back({std::min(u, v), std::max(u, v)});
          ++edges[u + 1], ++edges[v + 1];
        }
      }
    }
    for (std::size_t u = 0; u < graph_.nodes(); ++u) edges[u + 1] += edges[u];
    graph_.firstEdge = edges;
    graph_.edges.resize(edges.back());
    std::size_t costs = 0, links = 0;
    for (Pair& pair : pairs_) {
      pair.forward = edges[pair.low]++, pair.backward = edges[pair.high]++;
      addEdge(pair.forward, pair.low, pair.high, costs, links);
      addEdge(pair.backward, pair.high, pair.low, costs, links);
    }
    DAPPLE_CHECK(costs, <, std::size_t{kNone});
    graph_.cost.resize(costs);
    graph_.link.resize(links);
  }

  void addEdge(Index edge, Index from, Index to, std::size_t& costs, std::size_t& links) {
    const std::size_t mine = choices(from), theirs = choices(to);
    graph_.edges[edge] = {to, static_cast<Index>(costs), static_cast<Index>(links), 0,
                          static_cast<std::uint8_t>(theirs)};
    costs += mine * theirs, links += mine;
  }

  std::size_t choices(Index node) const {
    return graph_.firstData[node + 1] - graph_.firstData[node];
  }

  // Of two candidates.
  float difference(Index a, Index b) const {
    const vec3 colours = graph_.colour[a] - graph_.colour[b];
    const float heights = graph_.relief.empty() ? 0 : graph_.relief[a] - graph_.relief[b];
    return glm::length(glm::vec4(colours, heights));
  }

  // Costs of distortion, and how candidates of the same point differ.
  void fillNodes() {
    firstApart_.assign(1, 0);
    for (Index u = 0; u < graph_.nodes(); ++u)
      firstApart_.push_back(firstApart_.back() + choices(u) * choices(u));
    apart_.resize(firstApart_.back());
    parallelFor(monitor_, graph_.nodes(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t u = begin; u < end; ++u) {
        const Index first = graph_.first[graph_.point[u]];
        const std::size_t count = choices(static_cast<Index>(u));
        for (Index a = 0; a < count; ++a) {
          const float distortion = overlap_.distortion[graph_.source[first + a]];
          graph_.data[graph_.firstData[u] + a] = static_cast<std::int32_t>(
              kSeamCost * kPerDistortion * std::min(distortion, kMostDistortion));
          for (Index b = 0; b < count; ++b)
            apart_[firstApart_[u] + a * count + b] = difference(first + a, first + b);
        }
      }
    });
  }

  // Points without a choice never move: what a seam to them costs is the node's own.
  void foldFixed() {
    std::size_t done = 0;
    for (const FixedPair& pair : fixed_) {
      if (++done % kGrain == 0) monitor_.checkpoint();
      const Index i = graph_.point[pair.node], mine = graph_.first[i],
                  theirs = graph_.first[pair.point];
      const std::uint8_t here = continuation(theirs, i);
      for (Index a = 0; a < choices(pair.node); ++a) {
        const bool goesOn = here == a || continuation(mine + a, pair.point) == 0;
        if (a == 0 && !goesOn) graph_.torn[pair.node] = 1;
        if (goesOn) continue;
        const float across = difference(mine + a, theirs);
        const float atNode = here == kNoLink ? kUnknownSheet + across : apart(pair.node, a, here);
        graph_.data[graph_.firstData[pair.node] + a] += asCost(atNode + kUnknownSheet + across);
      }
    }
  }

  static std::int32_t asCost(float difference) {
    return static_cast<std::int32_t>(kSeamCost * difference + 0.5f);
  }

  float apart(Index node, Index a, Index b) const {
    return apart_[firstApart_[node] + a * choices(node) + b];
  }

  void fillPair(const Pair& pair) {
    SeamGraph::HalfEdge &forward = graph_.edges[pair.forward],
                        &backward = graph_.edges[pair.backward];
    const Index i = graph_.point[pair.low], j = graph_.point[pair.high];
    const float pixels =
        glm::length(input_.points.positions[i] - input_.points.positions[j]) / input_.unitAt(i);
    forward.length = backward.length =
        static_cast<std::uint16_t>(std::min(pixels * kLengthSteps, 65535.0f));
    const Index mine = graph_.first[i], theirs = graph_.first[j];
    const Index mineCount = backward.choices, theirCount = forward.choices;
    std::uint8_t *there = &graph_.link[forward.link], *here = &graph_.link[backward.link];
    for (Index a = 0; a < mineCount; ++a) there[a] = continuation(mine + a, j);
    for (Index b = 0; b < theirCount; ++b) here[b] = continuation(theirs + b, i);
    for (Index a = 0; a < mineCount; ++a) {
      for (Index b = 0; b < theirCount; ++b) {
        std::int32_t cost = 0;
        if (there[a] != b && here[b] != a) {
          const float across = there[a] == kNoLink || here[b] == kNoLink
                                   ? kUnknownSheet + difference(mine + a, theirs + b)
                                   : 0;
          cost = asCost((here[b] == kNoLink ? across : apart(pair.low, a, here[b])) +
                        (there[a] == kNoLink ? across : apart(pair.high, b, there[a])));
        }
        graph_.cost[forward.cost + a * theirCount + b] = static_cast<std::uint16_t>(cost);
        graph_.cost[backward.cost + b * mineCount + a] = static_cast<std::uint16_t>(cost);
      }
    }
  }

  const ChartSite& siteOf(Index candidate) const { return overlap_.site[graph_.source[candidate]]; }

  // The candidate of point j nearest to where candidate a of a neighbour puts it.
  std::uint8_t continuation(Index a, Index j) const {
    const ChartSite& from = siteOf(a);
    std::uint8_t best = kNoLink;
    float least = kCoherentPixels * kCoherentPixels;
    vec2 q(0);
    bool carried = false;
    for (Index b = graph_.first[j]; b < graph_.first[j + 1]; ++b) {
      const ChartSite& to = siteOf(b);
      if (to.patch != from.patch) continue;
      if (!carried) q = carriedPlace(from, to, input_.unit), carried = true;
      const vec2 d = to.q - q;
      const float distance2 = glm::dot(d, d);
      if (distance2 < least)
        least = distance2, best = static_cast<std::uint8_t>(b - graph_.first[j]);
    }
    return best;
  }

  const SynthesisInput& input_;
  const PatchOverlap& overlap_;
  const SourceMap& map_;
  Monitor& monitor_;
  SeamGraph graph_;
  std::vector<Index> node_;  // n: of a point, or kNone
  std::vector<Pair> pairs_;
  std::vector<FixedPair> fixed_;
  std::vector<std::size_t> firstApart_;  // nodes + 1
  std::vector<float> apart_;             // count x count of each node
};

}  // namespace

SeamGraph buildSeamGraph(const SynthesisInput& input, const PatchOverlap& overlap,
                         const SourceMap& map, Monitor& monitor) {
  return Builder(input, overlap, map, monitor).run();
}

}  // namespace dapple
