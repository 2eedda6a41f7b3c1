// Methods: section 2.4. [Zhang] places patches at random, so that the pattern breaks off wherever
// two of them meet; whatever colours the gap between them cannot mend that.
#include "synthesis/patch_placement.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "swatch/swatch_search.h"
#include "synthesis/placement_box.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 4096;
constexpr int kPhases = 4;           // offsets are rounded to 1 / kPhases pixel by the search
constexpr std::size_t kTerms = 150;  // of a search

// A point where a patch overlaps another one.
struct Meeting {
  Index own, other;  // candidates
};

class Placer {
 public:
  Placer(const SynthesisInput& input, const PatchOverlap& overlap, SourceMap& map, Monitor& monitor)
      : input_(input),
        overlap_(overlap),
        map_(map),
        monitor_(monitor),
        search_(searchOf(input.swatch, 0, kPhases)),
        meetings_(map.placement.size()),
        boxes_(map.placement.size()),
        placed_(map.placement.size(), 0) {
    std::fill_n(placed_.begin(), input.keptPatches(), std::uint8_t{1});
  }

  std::size_t run() {
    findMeetings();
    placeAll();
    recolour();
    return static_cast<std::size_t>(std::count(moved_.begin(), moved_.end(), 1));
  }

 private:
  void findMeetings() {
    moved_.assign(placed_.size(), 0);
    members_.assign(input_.swatch.hasHoles ? placed_.size() : 0, {});
    for (std::size_t i = 0; i < input_.points.size(); ++i) {
      if (i % kCheckpointEvery == 0) monitor_.checkpoint();
      for (Index a = overlap_.offset[i]; a < overlap_.offset[i + 1]; ++a) {
        const ChartSite& site = overlap_.site[a];
        if (overlap_.reach[a] == 0) {
          boxes_[site.patch].low = glm::min(boxes_[site.patch].low, site.q);
          boxes_[site.patch].high = glm::max(boxes_[site.patch].high, site.q);
          if (input_.swatch.hasHoles) members_[site.patch].push_back(static_cast<Index>(i));
        }
        for (Index b = overlap_.offset[i]; b < overlap_.offset[i + 1]; ++b)
          if (overlap_.site[b].patch != site.patch) meetings_[site.patch].push_back({a, b});
      }
    }
  }

  // Patches in the order of their overlap with those placed before; those that are kept, else the
  // first of all, and the first of every part of the surface that overlaps no other, stay where
  // they are.
  // Moving them again once all are placed was measured to gain nothing.
  void placeAll() {
    std::vector<std::size_t> known(placed_.size(), 0);  // meetings with placed patches
    // Most known first, then smallest id; entries that are out of date are skipped.
    std::priority_queue<std::pair<std::size_t, Index>> queue;
    const Index last = static_cast<Index>(placed_.size() - 1);
    const auto kept = static_cast<Index>(input_.keptPatches());
    for (Index p = 0; p < kept; ++p)
      for (const Meeting& m : meetings_[p]) ++known[overlap_.site[m.other].patch];
    for (Index p = kept; p <= last; ++p) queue.push({known[p], last - p});
    for (std::size_t step = kept; step < placed_.size(); ++step) {
      const Index best = takeBest(queue, known);
      if (known[best] > 0) place(best);
      placed_[best] = 1;
      std::vector<Index> met;
      for (const Meeting& m : meetings_[best]) {
        const Index other = overlap_.site[m.other].patch;
        if (!placed_[other] && (met.empty() || met.back() != other)) met.push_back(other);
        ++known[other];
      }
      for (const Index other : met) queue.push({known[other], last - other});
      monitor_.advance(pointsOfStep(input_.points.size(), step, placed_.size()));
      if (!monitor_.wantsPreview()) continue;
      recolour();
      monitor_.publish({map_.colour, map_.state});
    }
  }

  Index takeBest(std::priority_queue<std::pair<std::size_t, Index>>& queue,
                 const std::vector<std::size_t>& known) const {
    for (;;) {
      const auto [count, fromLast] = queue.top();
      queue.pop();
      const Index patch = static_cast<Index>(placed_.size() - 1 - fromLast);
      if (!placed_[patch] && known[patch] == count) return patch;
    }
  }

  void place(Index patch) {
    monitor_.checkpoint();
    const std::vector<SearchTerm> wanted = terms(patch);
    if (wanted.empty()) return;
    const SearchResult found = search_->search(wanted);
    if (!found.found) return;
    const vec2 placement = clampedPlacement(input_.swatch, boxes_[patch], found.texel);
    if (!usable(patch, placement)) return;
    map_.placement[patch] = placement;
    moved_[patch] = 1;
  }

  // At most kTerms of the meetings with placed patches, evenly along the Morton order.
  std::vector<SearchTerm> terms(Index patch) {
    std::vector<const Meeting*> known;
    for (const Meeting& m : meetings_[patch])
      if (placed_[overlap_.site[m.other].patch]) known.push_back(&m);
    std::vector<SearchTerm> out;
    const std::size_t count = std::min(kTerms, known.size());
    for (std::size_t t = 0; t < count; ++t) {
      const Meeting& m = *known[t * known.size() / count];
      const ChartSite& other = overlap_.site[m.other];
      const vec2 texel = other.q + map_.placement[other.patch];
      if (!usableTexel(input_.swatch, wrapTexel(input_.swatch, texel))) continue;
      out.push_back({overlap_.site[m.own].q, sampleSwatch(input_.swatch, texel), 0,
                     sampleRelief(input_.swatch, texel)});
    }
    if (!input_.swatch.tileable && !out.empty())
      keepInside(input_.swatch, boxes_[patch], kTerms, out);
    return out;
  }

  bool usable(Index patch, vec2 placement) const {
    if (input_.swatch.hasHoles)
      return std::all_of(members_[patch].begin(), members_[patch].end(), [&](Index i) {
        return usableTexel(input_.swatch, map_.domain[i] + placement);
      });
    return input_.swatch.tileable || (usableTexel(input_.swatch, boxes_[patch].low + placement) &&
                                      usableTexel(input_.swatch, boxes_[patch].high + placement));
  }

  void recolour() {
    parallelFor(monitor_, input_.points.size(), kCheckpointEvery,
                [&](std::size_t begin, std::size_t end) {
                  for (std::size_t i = begin; i < end; ++i)
                    if (map_.state[i] == PointState::Patch && moved_[map_.patch[i]])
                      placePoint(map_, input_.swatch, i);
                });
  }

  const SynthesisInput& input_;
  const PatchOverlap& overlap_;
  SourceMap& map_;
  Monitor& monitor_;
  const std::shared_ptr<const SwatchSearch> search_;
  std::vector<std::vector<Meeting>> meetings_;  // by patch, points ascending
  std::vector<PlacementBox> boxes_;             // of a patch's own points, its seed at 0
  std::vector<std::vector<Index>> members_;     // by patch, kept for a swatch with holes only
  std::vector<std::uint8_t> placed_, moved_;
};

}  // namespace

std::size_t placePatches(const SynthesisInput& input, const PatchOverlap& overlap, SourceMap& map,
                         Monitor& monitor) {
  if (map.placement.size() < 2) {
    monitor.advance(input.points.size());
    return 0;
  }
  return Placer(input, overlap, map, monitor).run();
}

}  // namespace dapple
