// [Zhang] Fast Hybrid Approach for Texturing Point Models, section 5.
//
// Departures: Match needs axes at gap points, of which the paper says nothing: those of the
// neighbouring points of the dominant patch, averaged in the queue's order. Cut replaces the
// paper's second half (methods: section 4): a gap 3 pixels wide cannot mend a pattern that breaks
// off at it, whatever fills it.
#include "synthesis/hybrid_synthesis.h"

#include <algorithm>

#include "base/errors.h"
#include "points/bucket_queue.h"
#include "synthesis/chart_fit.h"
#include "synthesis/patch_overlap.h"
#include "synthesis/patch_placement.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 512;
constexpr float kMostOverlap = 64;

// All patch points among the k nearest of a gap point become gap.
std::size_t expandGaps(const SynthesisInput& input, SourceMap& map) {
  std::vector<Index> next;
  for (Index i = 0; i < map.state.size(); ++i) {
    if (map.state[i] != PointState::Gap) continue;
    for (const Index j : input.neighborhoods.of(i))
      if (map.state[j] == PointState::Patch) next.push_back(j);
  }
  std::sort(next.begin(), next.end());
  next.erase(std::unique(next.begin(), next.end()), next.end());
  for (const Index i : next) map.state[i] = PointState::Gap, map.patch[i] = kNone;
  return next.size();
}

// Axes for gap points, from patch points and from gap points that have theirs.
class FrameSpreader {
 public:
  FrameSpreader(const SynthesisInput& input, SourceMap& map, Monitor& monitor)
      : input_(input),
        map_(map),
        monitor_(monitor),
        fit_(input.neighborhoods.k, input.unit),
        sites_(map.state.size()),
        key_(map.state.size(), 0) {
    for (Index i = 0; i < sites_.size(); ++i) {
      sites_[i].position = input.chart ? (*input.chart)[i] : input.points.positions[i],
      sites_[i].normal = input.points.normals[i], sites_[i].scale = input.scaleAt(i);
      sites_[i].n = map.frame[i].n, sites_[i].t = map.frame[i].t;
      sites_[i].patch = map.state[i] == PointState::Patch ? map.patch[i] : kNone;
    }
  }

  void run() {
    for (Index i = 0; i < sites_.size(); ++i) {
      if (known(i)) continue;
      map_.frame[i] = orthonormalFrame(input_.points.normals[i], input_.frames[i].t);
      for (const Index j : input_.neighborhoods.of(i)) key_[i] += known(j) ? 1 : 0;
      queue_.push(key_[i], i);
    }
    std::size_t done = 0;
    for (KeyBuckets::Entry next = queue_.pop(); next.id != kNone; next = queue_.pop()) {
      if (known(next.id) || key_[next.id] != next.key) continue;
      settle(next.id);
      if (++done % kCheckpointEvery == 0) monitor_.checkpoint();
    }
  }

 private:
  bool known(Index i) const { return sites_[i].patch != kNone; }

  void settle(Index i) {
    fit_.begin(sites_[i].position, input_, i);
    for (const Index j : input_.neighborhoods.of(i))
      if (known(j) && glm::dot(sites_[i].normal, sites_[j].normal) > 0) fit_.add(sites_[j]);
    fit_.finish();
    if (fit_.size() == 0) return;
    const Index patch = fit_.dominantPatch();
    fit_.keepPatch(patch);
    map_.frame[i] = fit_.average().frame;
    sites_[i].n = map_.frame[i].n, sites_[i].t = map_.frame[i].t, sites_[i].patch = patch;
    for (const Index j : input_.neighborhoods.of(i))
      if (!known(j)) queue_.push(++key_[j], j);
  }

  const SynthesisInput& input_;
  SourceMap& map_;
  Monitor& monitor_;
  KeyBuckets queue_;
  ChartFit fit_;
  std::vector<ChartSite> sites_;
  std::vector<Index> key_;
};

void fillByMatching(const SynthesisInput& input, const HybridOptions& options, SourceMap& map,
                    HybridStatistics& statistics, Monitor& monitor) {
  if (options.expand) statistics.expanded = expandGaps(input, map);
  FrameSpreader(input, map, monitor).run();
  statistics.matching = matchNeighborhoods(input, options.matching, map, monitor);
}

void fillByCutting(const SynthesisInput& input, const HybridOptions& options, SourceMap& map,
                   HybridStatistics& statistics, Monitor& monitor) {
  const auto show = [&] {
    if (monitor.wantsPreview()) monitor.publish({map.colour, map.state});
  };
  show();
  const PatchOverlap overlap = growOverlap(input, map, options.overlap, monitor);
  statistics.movedPatches = placePatches(input, overlap, map, monitor);
  show();
  statistics.seams = cutSeams(input, overlap, map, monitor);
  show();
}

void validate(const HybridOptions& options) {
  if (!(options.overlap >= 0 && options.overlap <= kMostOverlap))
    throw InvalidInput(
        fmt::format("overlap: {} is outside 0 to {} pixels", options.overlap, kMostOverlap));
}

}  // namespace

std::size_t hybridPasses(GapFill gaps) {
  return gaps == GapFill::Cut ? 4 : 2;  // growth; overlap, placement, cut; matching
}

HybridStatistics synthesizeHybrid(const SynthesisInput& input, const HybridOptions& options,
                                  SourceMap& map, Monitor& monitor) {
  validate(options);
  HybridStatistics statistics;
  const ChartedInput charted(input, options.patches.smooth, monitor);
  statistics.patches = growPatches(charted.get(), options.patches, map, monitor);
  if (options.gaps == GapFill::Match)
    fillByMatching(charted.get(), options, map, statistics, monitor);
  else
    fillByCutting(charted.get(), options, map, statistics, monitor);
  return statistics;
}

}  // namespace dapple
