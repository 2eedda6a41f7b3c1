// Graph cuts after Kwatra et al. 2003 (cost of a seam) and Boykov, Veksler, Zabih 2001 (expansion
// moves: keep what a point has, or take the proposal). Not in [Zhang], who blends.
//
// A proposal is not a patch but a sheet: candidates that continue each other around one of them. A
// patch that meets itself lies there in two sheets, which are one further on.
#include "synthesis/seam_cut.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "synthesis/max_flow.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 512;
constexpr std::size_t kEdges = 8;        // nearest neighbours that a seam is counted between
constexpr float kCost = 4096;            // integer cost of a colour difference of 1
constexpr float kPerDistortion = 0.01f;  // cost of D = 1, as a colour difference
constexpr float kMostDistortion = 5;     // counted
constexpr float kUnknownSheet = 0.1f;    // added where a sheet ends at a point
constexpr float kSheetRadius = 16;       // pixels
constexpr float kSeedSpacing = 12;       // of sheets along a seam, pixels
constexpr int kRounds = 2;               // over all sheets, at most
constexpr std::uint8_t kNoLink = 255;

using Cost = std::int32_t;

// Usable candidates, and which of them continue each other across an edge.
struct CutGraph {
  std::vector<Index> first;   // n + 1: candidates by point
  std::vector<Index> source;  // of each candidate: its place in the overlap
  std::vector<vec2> texel;
  std::vector<vec3> colour;
  std::vector<Cost> data;

  struct HalfEdge {
    Index to, twin;
    Index links;   // first of count(from) entries of `link`
    float length;  // pixels
  };
  std::vector<Index> firstEdge;    // n + 1
  std::vector<HalfEdge> edges;     // of points with a choice, and back
  std::vector<std::uint8_t> link;  // candidate of `to` that continues one of `from`, or kNoLink

  std::size_t count(Index i) const { return first[i + 1] - first[i]; }
};

class GraphBuilder {
 public:
  GraphBuilder(const SynthesisInput& input, const PatchOverlap& overlap, const SourceMap& map,
               Monitor& monitor)
      : input_(input), overlap_(overlap), map_(map), monitor_(monitor) {}

  CutGraph run() {
    addCandidates();
    addEdges();
    return std::move(graph_);
  }

 private:
  void addCandidates() {
    const std::size_t n = input_.points.size();
    graph_.first.reserve(n + 1);
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckpointEvery == 0) monitor_.checkpoint();
      graph_.first.push_back(static_cast<Index>(graph_.source.size()));
      for (Index c = overlap_.offset[i]; c < overlap_.offset[i + 1]; ++c) {
        const ChartSite& site = overlap_.site[c];
        const vec2 texel = wrapTexel(input_.swatch, site.q + map_.placement[site.patch]);
        if (overlap_.reach[c] > 0 && !usableTexel(input_.swatch, texel)) continue;
        graph_.source.push_back(c);
        graph_.texel.push_back(texel);
        graph_.colour.push_back(sampleSwatch(input_.swatch, texel));
        graph_.data.push_back(static_cast<Cost>(kCost * kPerDistortion *
                                                std::min(overlap_.distortion[c], kMostDistortion)));
      }
    }
    graph_.first.push_back(static_cast<Index>(graph_.source.size()));
  }

  bool hasChoice(Index i) const { return graph_.count(i) > 1; }

  std::span<const Index> near(Index i) const {
    return input_.neighborhoods.of(i).first(std::min(kEdges, input_.neighborhoods.k));
  }

  // Calls body(i, j) once for each pair of which one has a choice and one is near the other.
  template <class Body>
  void forPairs(Body body) const {
    for (Index i = 0; i < input_.points.size(); ++i) {
      if (graph_.count(i) == 0) continue;
      const auto ids = near(i);
      for (const Index j : ids) {
        if (graph_.count(j) == 0 || !(hasChoice(i) || hasChoice(j))) continue;
        if (glm::dot(input_.points.normals[i], input_.points.normals[j]) <= 0) continue;
        if (j < i) {
          const auto back = near(j);
          if (std::find(back.begin(), back.end(), i) != back.end()) continue;
        }
        body(i, j);
      }
    }
  }

  void addEdges() {
    const std::size_t n = input_.points.size();
    graph_.firstEdge.assign(n + 1, 0);
    forPairs([&](Index i, Index j) { ++graph_.firstEdge[i + 1], ++graph_.firstEdge[j + 1]; });
    monitor_.checkpoint();
    for (std::size_t i = 0; i < n; ++i) graph_.firstEdge[i + 1] += graph_.firstEdge[i];
    graph_.edges.resize(graph_.firstEdge[n]);
    std::vector<Index> next(graph_.firstEdge.begin(), graph_.firstEdge.end() - 1);
    std::size_t done = 0;
    forPairs([&](Index i, Index j) {
      const Index forward = next[i]++, backward = next[j]++;
      const float length =
          glm::length(input_.points.positions[i] - input_.points.positions[j]) / input_.unit;
      graph_.edges[forward] = {j, backward, addLinks(i, j), length};
      graph_.edges[backward] = {i, forward, addLinks(j, i), length};
      if (++done % kCheckpointEvery == 0) monitor_.checkpoint();
    });
  }

  Index addLinks(Index i, Index j) {
    const Index start = static_cast<Index>(graph_.link.size());
    for (Index a = graph_.first[i]; a < graph_.first[i + 1]; ++a)
      graph_.link.push_back(continuation(a, j));
    return start;
  }

  // The candidate of j nearest to where candidate a of a neighbour puts it.
  std::uint8_t continuation(Index a, Index j) const {
    const ChartSite& from = siteOf(a);
    const vec2 q = carriedPlace(from, siteOf(graph_.first[j]).position, input_.unit);
    std::uint8_t best = kNoLink;
    float least = kCoherentPixels * kCoherentPixels;
    for (Index b = graph_.first[j]; b < graph_.first[j + 1]; ++b) {
      const ChartSite& to = siteOf(b);
      const vec2 d = to.q - q;
      const float apart = glm::dot(d, d);
      if (to.patch == from.patch && apart < least)
        least = apart, best = static_cast<std::uint8_t>(b - graph_.first[j]);
    }
    return best;
  }

  const ChartSite& siteOf(Index candidate) const { return overlap_.site[graph_.source[candidate]]; }

  const SynthesisInput& input_;
  const PatchOverlap& overlap_;
  const SourceMap& map_;
  Monitor& monitor_;
  CutGraph graph_;
};

// Labels: a candidate for every point, by number among its own.
class Cutter {
 public:
  Cutter(const CutGraph& graph, Monitor& monitor) : graph_(graph), monitor_(monitor) {
    const std::size_t n = graph.first.size() - 1;
    label_.assign(n, 0);  // own, or nearest: candidates are sorted so
    sheetStamp_.assign(n, 0);
    proposal_.assign(n, 0);
    node_.assign(n, kNone);
    changedAt_.assign(n, 0);
  }

  SeamStatistics run() {
    SeamStatistics statistics;
    const std::int64_t before = energy();
    energy_ = before;
    chooseSeeds();
    for (int round = 0; round < kRounds; ++round) {
      const std::int64_t atStart = energy_;
      for (Seed& seed : seeds_) {
        monitor_.checkpoint();
        statistics.moves += move(seed) ? 1 : 0;
      }
      if (energy_ == atStart) break;
    }
    statistics.energyBefore = static_cast<double>(before) / kCost;
    DAPPLE_CHECK(energy_, ==, energy());
    statistics.energyAfter = static_cast<double>(energy_) / kCost;
    for (const std::uint8_t label : label_) statistics.changed += label > 0 ? 1 : 0;
    return statistics;
  }

  const std::vector<std::uint8_t>& labels() const { return label_; }

 private:
  struct Seed {
    Index point;
    std::uint8_t candidate;
    Index tried = 0;  // clock of the last move
  };

  Index at(Index i, std::uint8_t candidate) const { return graph_.first[i] + candidate; }
  bool hasChoice(Index i) const { return graph_.count(i) > 1; }

  // Candidate a at one end of the edge and b at the other.
  Cost seam(const CutGraph::HalfEdge& edge, Index i, std::uint8_t a, std::uint8_t b) const {
    const CutGraph::HalfEdge& back = graph_.edges[edge.twin];
    const std::uint8_t aThere = graph_.link[edge.links + a], bHere = graph_.link[back.links + b];
    if (aThere == b || bHere == a) return 0;
    const Index j = edge.to;
    const vec3 mine = graph_.colour[at(i, a)], theirs = graph_.colour[at(j, b)];
    const float here = bHere == kNoLink ? kUnknownSheet + glm::length(mine - theirs)
                                        : glm::length(mine - graph_.colour[at(i, bHere)]);
    const float there = aThere == kNoLink ? kUnknownSheet + glm::length(mine - theirs)
                                          : glm::length(theirs - graph_.colour[at(j, aThere)]);
    return static_cast<Cost>(kCost * (here + there) + 0.5f);
  }

  std::span<const CutGraph::HalfEdge> edges(Index i) const {
    return {graph_.edges.data() + graph_.firstEdge[i],
            graph_.firstEdge[i + 1] - graph_.firstEdge[i]};
  }

  std::int64_t energy() const {
    std::int64_t sum = 0;
    for (Index i = 0; i < label_.size(); ++i) {
      if (hasChoice(i)) sum += graph_.data[at(i, label_[i])];
      for (const CutGraph::HalfEdge& edge : edges(i))
        if (edge.to > i) sum += seam(edge, i, label_[i], label_[edge.to]);
    }
    return sum;
  }

  // Both sides of every seam between nearest patches, each from `kSeedSpacing` away from the next.
  void chooseSeeds() {
    std::vector<bool> covered(graph_.source.size(), false);
    for (Index i = 0; i < label_.size(); ++i) {
      if (i % kCheckpointEvery == 0) monitor_.checkpoint();
      const std::uint8_t own = label_[i];
      if (!hasChoice(i) || covered[at(i, own)] || !atSeam(i)) continue;
      seeds_.push_back({i, own});
      growSheet(i, own, kSeedSpacing);
      for (const SheetPoint& s : sheet_) covered[at(s.point, proposal_[s.point])] = true;
    }
  }

  bool atSeam(Index i) const {
    const auto near = edges(i);
    return std::any_of(near.begin(), near.end(), [&](const CutGraph::HalfEdge& edge) {
      return graph_.link[edge.links + label_[i]] != label_[edge.to];
    });
  }

  // sheet_: points with a choice around `start`, with the candidates that continue `candidate`.
  void growSheet(Index start, std::uint8_t candidate, float radius) {
    ++stamp_;
    sheet_.assign(1, {start, 0});
    proposal_[start] = candidate;
    sheetStamp_[start] = stamp_;
    for (std::size_t s = 0; s < sheet_.size(); ++s) {
      const SheetPoint from = sheet_[s];
      for (const CutGraph::HalfEdge& edge : edges(from.point)) {
        const float distance = from.distance + edge.length;
        if (distance > radius || sheetStamp_[edge.to] == stamp_ || !hasChoice(edge.to)) continue;
        const std::uint8_t next = graph_.link[edge.links + proposal_[from.point]];
        if (next == kNoLink) continue;
        sheetStamp_[edge.to] = stamp_;
        proposal_[edge.to] = next;
        sheet_.push_back({edge.to, distance});
      }
    }
  }

  // True when a cut was computed.
  bool move(Seed& seed) {
    growSheet(seed.point, seed.candidate, kSheetRadius);
    Index lastChange = 0;
    nodes_.clear();
    for (const SheetPoint& s : sheet_) {
      lastChange = std::max(lastChange, changedAt_[s.point]);
      if (proposal_[s.point] == label_[s.point]) continue;
      node_[s.point] = static_cast<Index>(nodes_.size());
      nodes_.push_back(s.point);
    }
    const bool worthwhile = !nodes_.empty() && (seed.tried == 0 || lastChange > seed.tried);
    seed.tried = ++clock_;
    if (worthwhile) cut();
    for (const Index i : nodes_) node_[i] = kNone;
    return worthwhile;
  }

  void cut() {
    flow_.reset(nodes_.size());
    gained_ = 0;
    relaxed_.clear();
    for (Index v = 0; v < nodes_.size(); ++v) addNode(v);
    std::int64_t change = flow_.solve() - gained_;
    for (const Relaxed& pair : relaxed_)
      if (!flow_.onSinkSide(pair.v) && !flow_.onSinkSide(pair.w)) change += pair.by;
    if (change >= 0) return;
    energy_ += change;
    for (Index v = 0; v < nodes_.size(); ++v) {
      if (!flow_.onSinkSide(v)) continue;
      label_[nodes_[v]] = proposal_[nodes_[v]];
      changedAt_[nodes_[v]] = clock_;
    }
  }

  // The source's side keeps its label, the sink's takes the proposal.
  void addNode(Index v) {
    const Index i = nodes_[v];
    const std::uint8_t keep = label_[i], take = proposal_[i];
    Cost slope = graph_.data[at(i, take)] - graph_.data[at(i, keep)];
    for (const CutGraph::HalfEdge& edge : edges(i)) {
      const Index j = edge.to, w = node_[j];
      if (w == kNone)
        slope += seam(edge, i, take, label_[j]) - seam(edge, i, keep, label_[j]);
      else if (v < w)
        slope += addPair(edge, v, w);
    }
    addSlope(v, slope);
  }

  // With kt the cost of v keeping and w taking, and x = 1 for taking:
  // E - kk = (tk - kk) x_v + (tt - tk) x_w + (kt + tk - kk - tt) (1 - x_v) x_w
  // A cut needs the last factor >= 0. Where it is not, kk counts less in the cut than it costs:
  // the labels found may then be worse than those kept, which the sum at the end shows.
  Cost addPair(const CutGraph::HalfEdge& edge, Index v, Index w) {
    const Index i = nodes_[v], j = nodes_[w];
    const Cost kt = seam(edge, i, label_[i], proposal_[j]),
               tk = seam(edge, i, proposal_[i], label_[j]),
               tt = seam(edge, i, proposal_[i], proposal_[j]),
               real = seam(edge, i, label_[i], label_[j]), kk = std::min(real, kt + tk - tt);
    if (kk < real) {
      relaxed_.push_back({v, w, real - kk});
      gained_ += real - kk;
    }
    addSlope(w, tt - tk);
    if (kt + tk - kk - tt > 0) flow_.addEdge(v, w, kt + tk - kk - tt, 0);
    return tk - kk;
  }

  // Cost of node v on the sink's side over that on the source's.
  void addSlope(Index v, Cost slope) {
    flow_.addTerminals(v, std::max(slope, 0), std::max(-slope, 0));
    if (slope < 0) gained_ -= slope;
  }

  struct Relaxed {
    Index v, w;
    Cost by;
  };
  struct SheetPoint {
    Index point;
    float distance;
  };

  const CutGraph& graph_;
  Monitor& monitor_;
  std::vector<std::uint8_t> label_, proposal_;  // n
  std::vector<Index> sheetStamp_;               // n: the last sheet that reached the point
  std::vector<Index> node_;                     // n: of the current cut
  std::vector<Index> changedAt_;                // n
  std::vector<SheetPoint> sheet_;
  std::vector<Index> nodes_;
  std::vector<Seed> seeds_;
  MaxFlow flow_;
  std::int64_t gained_ = 0;  // what the cut's cost is above the change of energy
  std::vector<Relaxed> relaxed_;
  Index stamp_ = 0, clock_ = 0;
  std::int64_t energy_ = 0;
};

void writeLabels(const PatchOverlap& overlap, const CutGraph& graph,
                 const std::vector<std::uint8_t>& labels, SourceMap& map) {
  for (Index i = 0; i < labels.size(); ++i) {
    if (graph.count(i) == 0) continue;
    const bool settled = map.state[i] == PointState::Patch && labels[i] == 0;
    if (settled) continue;
    const Index c = graph.first[i] + labels[i];
    const ChartSite& chosen = overlap.site[graph.source[c]];
    map.patch[i] = chosen.patch;
    map.domain[i] = chosen.q;
    map.texel[i] = graph.texel[c];
    map.colour[i] = graph.colour[c];
    map.error[i] = overlap.distortion[graph.source[c]];
    map.frame[i] = orthonormalFrame(chosen.n, chosen.t);
  }
}

void copyPlace(SourceMap& map, Index from, Index to) {
  map.patch[to] = map.patch[from], map.domain[to] = map.domain[from];
  map.texel[to] = map.texel[from], map.colour[to] = map.colour[from];
  map.frame[to] = map.frame[from];
}

// Gap points that have no candidate copy the nearest point that has one.
std::size_t copyNeighbours(const SynthesisInput& input, const CutGraph& graph, SourceMap& map) {
  std::vector<Index> left;
  for (Index i = 0; i < map.state.size(); ++i)
    if (graph.count(i) == 0) left.push_back(i);
  const std::size_t stranded = left.size();
  std::vector<bool> known(map.state.size(), true);
  for (const Index i : left) known[i] = false;
  for (bool progress = true; progress && !left.empty();) {
    progress = false;
    std::vector<Index> still;
    for (const Index i : left) {
      const auto near = input.neighborhoods.of(i);
      const auto from = std::find_if(near.begin(), near.end(), [&](Index j) { return known[j]; });
      if (from == near.end()) {
        still.push_back(i);
        continue;
      }
      copyPlace(map, *from, i);
      known[i] = progress = true;
    }
    left.swap(still);
  }
  // A part of the surface without any patch: better any texel than none.
  const Index any = static_cast<Index>(std::find(known.begin(), known.end(), true) - known.begin());
  for (const Index i : left) copyPlace(map, any, i);
  return stranded;
}

}  // namespace

SeamStatistics cutSeams(const SynthesisInput& input, const PatchOverlap& overlap, SourceMap& map,
                        Monitor& monitor) {
  const CutGraph graph = GraphBuilder(input, overlap, map, monitor).run();
  Cutter cutter(graph, monitor);
  SeamStatistics statistics = cutter.run();
  writeLabels(overlap, graph, cutter.labels(), map);
  statistics.stranded = copyNeighbours(input, graph, map);
  return statistics;
}

}  // namespace dapple
