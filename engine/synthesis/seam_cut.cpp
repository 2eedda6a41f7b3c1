// Graph cuts after Kwatra et al. 2003 (cost of a seam) and Boykov, Veksler, Zabih 2001 (expansion
// moves: keep what a point has, or take the proposal). Not in [Zhang], who blends.
//
// A proposal is not a patch but a sheet: candidates that continue each other around one of them. A
// patch that meets itself lies there in two sheets, which are one further on.
//
// Sheets that neither overlap nor touch are cut at the same time. Which do is found from the sheets
// alone, before the first cut, so that the result does not depend on the threads.
#include "synthesis/seam_cut.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>

#include "base/errors.h"
#include "base/scratch_pool.h"
#include "synthesis/max_flow.h"
#include "synthesis/seam_graph.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 512;
constexpr std::size_t kGrain = 2048;  // points
// Small sheets leave seams where they end; a second round over sheets of half this size gains what
// the size does, at twice the cost.
constexpr float kSheetRadius = 24;         // pixels
constexpr float kSeedSpacing = 22;         // of sheets along a seam, pixels
constexpr std::size_t kTasksAtOnce = 128;  // sheets between two looks for a preview
constexpr std::uint32_t kTurns = 64;       // in which sheets are cut; in the last one by one

using Cost = std::int32_t;

// Candidates of nodes around one of them that continue each other.
struct Sheet {
  std::size_t first, end;  // into SheetBuilder's members
  std::uint32_t turn;      // sheets of the same turn do not touch (but in the last)
};
struct Member {
  Index node;
  std::uint8_t candidate;
};

// Covers both sides of every seam between nearest patches with sheets.
class SheetBuilder {
 public:
  SheetBuilder(const SeamGraph& graph, Monitor& monitor)
      : graph_(graph),
        monitor_(monitor),
        covered_(graph.data.size(), 0),
        stamp_(graph.nodes(), kNone),
        turns_(graph.nodes(), 0) {}

  void run() {
    for (Index u = 0; u < graph_.nodes(); ++u) {
      if (u % kCheckpointEvery == 0) monitor_.checkpoint();
      if (covered_[graph_.firstData[u]] || !atSeam(u)) continue;
      monitor_.checkpoint();
      addSheet(u);
    }
  }

  std::vector<Sheet> sheets;  // of candidate 0 of their first members
  std::vector<Member> members;

 private:
  bool atSeam(Index u) const {
    if (graph_.torn[u]) return true;
    const auto near = graph_.of(u);
    return std::any_of(near.begin(), near.end(), [&](const SeamGraph::HalfEdge& edge) {
      return graph_.link[edge.link] != 0;
    });
  }

  void addSheet(Index start) {
    constexpr auto radius = static_cast<std::uint32_t>(kSheetRadius * kLengthSteps);
    constexpr auto spacing = static_cast<std::uint32_t>(kSeedSpacing * kLengthSteps);
    const std::size_t first = members.size();
    const Index stamp = static_cast<Index>(sheets.size());
    std::uint64_t taken = 0;  // turns of the sheets around
    members.push_back({start, 0});
    distance_.assign(1, 0);
    stamp_[start] = stamp;
    for (std::size_t s = first; s < members.size(); ++s) {
      const Member from = members[s];
      const std::uint32_t before = distance_[s - first];
      taken |= turns_[from.node];
      if (before <= spacing) covered_[graph_.firstData[from.node] + from.candidate] = 1;
      for (const SeamGraph::HalfEdge& edge : graph_.of(from.node)) {
        taken |= turns_[edge.to];
        const std::uint32_t distance = before + edge.length;
        if (distance > radius || stamp_[edge.to] == stamp) continue;
        const std::uint8_t next = graph_.link[edge.link + from.candidate];
        if (next == kNoLink) continue;
        stamp_[edge.to] = stamp;
        members.push_back({edge.to, next});
        distance_.push_back(distance);
      }
    }
    const auto turn = std::min(static_cast<std::uint32_t>(std::countr_one(taken)), kTurns - 1);
    for (std::size_t s = first; s < members.size(); ++s)
      turns_[members[s].node] |= std::uint64_t{1} << turn;
    sheets.push_back({first, members.size(), turn});
  }

  const SeamGraph& graph_;
  Monitor& monitor_;
  std::vector<std::uint8_t> covered_;  // by candidate
  std::vector<Index> stamp_;           // by node: the last sheet that has it
  std::vector<std::uint64_t> turns_;   // by node: bits, of the sheets that have it
  std::vector<std::uint32_t> distance_;
};

// One expansion move: nodes of a sheet that do not have its candidates keep what they have or take
// them, whichever is cheapest all together.
class SheetCut {
 public:
  SheetCut(const SeamGraph& graph, std::vector<std::uint8_t>& labels)
      : graph_(graph), labels_(labels), local_(graph.nodes(), kNone) {}

  // The change of energy, <= 0.
  std::int64_t run(std::span<const Member> sheet, const Monitor& monitor) {
    nodes_.clear();
    for (const Member& member : sheet) {
      if (labels_[member.node] == member.candidate) continue;
      local_[member.node] = static_cast<Index>(nodes_.size());
      nodes_.push_back({member.node, labels_[member.node], member.candidate});
    }
    if (nodes_.empty()) return 0;
    flow_.reset(nodes_.size());
    gained_ = 0;
    relaxed_.clear();
    for (Index v = 0; v < nodes_.size(); ++v) addNode(v);
    for (const Choice& choice : nodes_) local_[choice.node] = kNone;
    std::int64_t change = flow_.solve(&monitor) - gained_;
    for (const Relaxed& pair : relaxed_)
      if (!flow_.onSinkSide(pair.v) && !flow_.onSinkSide(pair.w)) change += pair.by;
    if (change >= 0) return 0;
    for (Index v = 0; v < nodes_.size(); ++v) {
      if (flow_.onSinkSide(v)) labels_[nodes_[v].node] = nodes_[v].take;
    }
    return change;
  }

 private:
  struct Choice {
    Index node;
    std::uint8_t keep, take;
  };
  struct Relaxed {
    Index v, w;
    Cost by;
  };

  // The source's side keeps its label, the sink's takes the proposal.
  void addNode(Index v) {
    const Choice& own = nodes_[v];
    const Cost* data = graph_.data.data() + graph_.firstData[own.node];
    Cost slope = data[own.take] - data[own.keep];
    for (const SeamGraph::HalfEdge& edge : graph_.of(own.node)) {
      const Index w = local_[edge.to];
      if (w == kNone) {
        const std::uint8_t theirs = labels_[edge.to];
        slope += graph_.seam(edge, own.take, theirs) - graph_.seam(edge, own.keep, theirs);
      } else if (v < w) {
        slope += addPair(edge, v, w);
      }
    }
    addSlope(v, slope);
  }

  // With kt the cost of v keeping and w taking, and x = 1 for taking:
  // E - kk = (tk - kk) x_v + (tt - tk) x_w + (kt + tk - kk - tt) (1 - x_v) x_w
  // A cut needs the last factor >= 0. Where it is not, kk counts less in the cut than it costs:
  // the labels found may then be worse than those kept, which the sum at the end shows.
  Cost addPair(const SeamGraph::HalfEdge& edge, Index v, Index w) {
    const Choice &mine = nodes_[v], &theirs = nodes_[w];
    const Cost kt = graph_.seam(edge, mine.keep, theirs.take),
               tk = graph_.seam(edge, mine.take, theirs.keep),
               tt = graph_.seam(edge, mine.take, theirs.take),
               real = graph_.seam(edge, mine.keep, theirs.keep), kk = std::min(real, kt + tk - tt);
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

  const SeamGraph& graph_;
  std::vector<std::uint8_t>& labels_;
  std::vector<Index> local_;  // by node: its place in nodes_
  std::vector<Choice> nodes_;
  MaxFlow flow_;
  std::int64_t gained_ = 0;  // what the cut's cost is above the change of energy
  std::vector<Relaxed> relaxed_;
};

// Labels: a candidate for every node, by number among its own.
class Cutter {
 public:
  using Show = std::function<void(const std::vector<std::uint8_t>& labels)>;

  // Calls `show` when a preview is due.
  Cutter(const SeamGraph& graph, Show show, Monitor& monitor)
      : graph_(graph),
        monitor_(monitor),
        labels_(graph.nodes(), 0),  // own, or nearest: candidates are sorted so
        cuts_([this] { return std::make_unique<SheetCut>(graph_, labels_); }),
        show_(std::move(show)) {}

  SeamStatistics run() {
    SeamStatistics statistics;
    const std::int64_t before = energy();
    SheetBuilder builder(graph_, monitor_);
    builder.run();
    members_ = std::move(builder.members);
    std::vector<std::vector<Sheet>> turns;
    for (const Sheet& sheet : builder.sheets) {
      if (sheet.turn >= turns.size()) turns.resize(sheet.turn + 1);
      turns[sheet.turn].push_back(sheet);
    }
    statistics.moves = sheetCount_ = builder.sheets.size();
    std::int64_t now = before;
    for (const std::vector<Sheet>& turn : turns) now += cutAll(turn);
    DAPPLE_CHECK(now, ==, energy());
    statistics.energyBefore = static_cast<double>(before) / kSeamCost;
    statistics.energyAfter = static_cast<double>(now) / kSeamCost;
    for (const std::uint8_t label : labels_) statistics.changed += label > 0 ? 1 : 0;
    return statistics;
  }

  const std::vector<std::uint8_t>& labels() const { return labels_; }

 private:
  std::int64_t energy() const {
    std::int64_t sum = 0;
    for (Index u = 0; u < labels_.size(); ++u) {
      sum += graph_.data[graph_.firstData[u] + labels_[u]];
      for (const SeamGraph::HalfEdge& edge : graph_.of(u))
        if (edge.to > u) sum += graph_.seam(edge, labels_[u], labels_[edge.to]);
    }
    return sum;
  }

  // The change of energy.
  std::int64_t cutAll(const std::vector<Sheet>& sheets) {
    const bool apart = sheets.front().turn + 1 < kTurns;
    const std::size_t tasks = apart ? sheets.size() : 1, perTask = apart ? 1 : sheets.size();
    std::vector<std::int64_t> change(sheets.size(), 0);
    const auto cutOf = [&](std::size_t task) {
      cuts_.use([&](SheetCut& cut) {
        for (std::size_t s = task * perTask; s < (task + 1) * perTask; ++s) {
          monitor_.checkpoint();
          change[s] = cut.run(membersOf(sheets[s]), monitor_);
          monitor_.advance(pointsOfStep(graph_.nodes(), done_ + s, sheetCount_));
        }
      });
    };
    for (std::size_t first = 0; first < tasks; first += kTasksAtOnce) {
      monitor_.workers().run(std::min(kTasksAtOnce, tasks - first),
                             [&](std::size_t t) { cutOf(first + t); });
      if (monitor_.wantsPreview()) show_(labels_);
    }
    done_ += sheets.size();
    return std::accumulate(change.begin(), change.end(), std::int64_t{0});
  }

  std::span<const Member> membersOf(const Sheet& sheet) const {
    return {members_.data() + sheet.first, sheet.end - sheet.first};
  }

  const SeamGraph& graph_;
  Monitor& monitor_;
  std::vector<std::uint8_t> labels_;  // by node
  std::vector<Member> members_;
  std::size_t done_ = 0, sheetCount_ = 0;
  ScratchPool<SheetCut> cuts_;
  Show show_;
};

void writeLabels(const PatchOverlap& overlap, const SeamGraph& graph,
                 const std::vector<std::uint8_t>& labels, SourceMap& map) {
  std::size_t node = 0;
  for (Index i = 0; i < map.state.size(); ++i) {
    const bool hasNode = node < graph.nodes() && graph.point[node] == i;
    const Index label = hasNode ? labels[node++] : 0;
    const bool settled = map.state[i] == PointState::Patch && label == 0;
    if (settled || graph.count(i) == 0) continue;
    const Index c = graph.first[i] + label;
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
std::size_t copyNeighbours(const SynthesisInput& input, const SeamGraph& graph, SourceMap& map) {
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
  const SeamGraph graph = buildSeamGraph(input, overlap, map, monitor);
  monitor.advance(input.points.size() - graph.nodes());
  const auto show = [&](const std::vector<std::uint8_t>& labels) {
    std::vector<vec3> colours(map.colour);
    for (std::size_t u = 0; u < graph.nodes(); ++u)
      colours[graph.point[u]] = graph.colour[graph.first[graph.point[u]] + labels[u]];
    monitor.publish({colours, map.state});
  };
  Cutter cutter(graph, show, monitor);
  SeamStatistics statistics = cutter.run();
  writeLabels(overlap, graph, cutter.labels(), map);
  statistics.stranded = copyNeighbours(input, graph, map);
  return statistics;
}

}  // namespace dapple
