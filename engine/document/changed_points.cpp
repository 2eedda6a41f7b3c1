#include "document/changed_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include "document/channels.h"
#include "synthesis/patch_overlap.h"

namespace dapple {
namespace {

constexpr float kTurned = 4;  // degrees; less is not seen, nor worth a seam
constexpr float kRescaled = 1.03f;
constexpr float kHalo = 24;  // pixels: twice what patches overlap, and the band along the cuts
constexpr double kMostShare = 0.5;  // of a region; above it all is synthesized
constexpr std::size_t kGrain = 4096;

// What a synthesis of the region would be recorded as is what made this source.
bool suits(const ResultSource& source, const RegionTarget& target) {
  return source.region == target.region.id && !source.partial &&
         source.swatch == target.region.swatch && source.unit == target.unit &&
         source.options == target.region.options &&
         sameHeights(source.maps.get(), target.region.maps.get(), target.region.options);
}

bool turned(const TangentFrame& was, const TangentFrame& is, int folds, float cosine) {
  const float up = glm::dot(was.t, is.t), right = glm::dot(was.t, is.s);
  const float along = folds == 1   ? up
                      : folds == 2 ? std::abs(up)
                                   : std::max(std::abs(up), std::abs(right));
  return !(along > cosine);
}

// What becomes of a region's points.
enum class Fate : std::uint8_t { Stays, Changed, Halo };

struct Fates {
  std::vector<Fate> of;      // by region point
  std::vector<Index> again;  // ascending: those that do not stay
};

// Tells those that changed from those that stay.
Fates changedPoints(const Results& results, const RegionTarget& target, Monitor& monitor) {
  std::vector<std::uint8_t> suitable(results.sources.size());
  for (std::size_t s = 0; s < suitable.size(); ++s)
    suitable[s] = suits(*results.sources[s], target) ? 1 : 0;
  const int folds = foldsOf(target.region.options.symmetry);
  const float cosine = std::cos(kTurned * std::numbers::pi_v<float> / 180);
  const auto rescaled = [&](Index r, Index i) {
    const float was = results.scale ? (*results.scale)[i] : 1;
    const float is = target.field.scale.empty() ? 1 : target.field.scale[r];
    return std::max(was / is, is / was) > kRescaled;
  };
  Fates fates{.of = std::vector<Fate>(target.part.size())};
  std::vector<std::vector<Index>> found(1 + (fates.of.size() - 1) / kGrain);
  parallelFor(monitor, fates.of.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const Index i = target.part.idOf(static_cast<Index>(r));
      const std::uint16_t s = (*results.source)[i];
      if (s != kNoSource && suitable[s] &&
          !turned((*results.frame)[i], target.field.frames[r], folds, cosine) &&
          !rescaled(static_cast<Index>(r), i))
        continue;
      fates.of[r] = Fate::Changed;
      found[begin / kGrain].push_back(static_cast<Index>(r));
    }
  });
  for (const std::vector<Index>& some : found)
    fates.again.insert(fates.again.end(), some.begin(), some.end());
  return fates;
}

// Adds the points that are nearer than kHalo to those that changed, along the surface.
void addHalo(const RegionTarget& target, Fates& fates, Monitor& monitor) {
  std::vector<Index>& reached = fates.again;
  std::vector<float> distance(reached.size(), 0);
  const std::vector<vec3>& positions = target.part.points().positions;
  for (std::size_t d = 0; d < reached.size(); ++d) {
    if (d % kGrain == 0) monitor.checkpoint();
    const Index r = reached[d];
    for (const Index j : target.part.neighborhoods().of(r)) {
      if (fates.of[j] != Fate::Stays) continue;
      const float far = distance[d] + distanceBetween(positions[r], positions[j]) / target.unit;
      if (far > kHalo) continue;
      fates.of[j] = Fate::Halo;
      reached.push_back(j), distance.push_back(far);
    }
  }
  std::sort(reached.begin(), reached.end());
}

// Numbers patches from 0 on, in the order of the part's points.
void renumber(RegionPart& part) {
  std::unordered_map<Index, Index> numberOf;
  for (Index& patch : part.map.patch) {
    if (patch == kNone) continue;
    const auto [at, isNew] = numberOf.emplace(patch, static_cast<Index>(part.patchOf.size()));
    if (isNew) part.patchOf.push_back(patch);
    patch = at->second;
  }
  part.map.placement.assign(part.patchOf.size(), vec2(0));
}

// Lays the kept points of a patch out side by side again: texels of a swatch that tiles are
// wrapped.
class Unwrapper {
 public:
  Unwrapper(const RegionTarget& target, RegionPart& part) : target_(target), part_(part) {}

  void run(Monitor& monitor) {
    SourceMap& map = part_.map;
    map.domain = map.texel;
    if (!target_.region.swatch->tileable) return;
    place_.assign(target_.part.size(), kNone);
    for (Index p = 0; p < part_.points.size(); ++p) place_[part_.points[p]] = p;
    std::vector<std::uint8_t> done(part_.points.size(), 0);
    std::vector<Index> open;
    for (Index start = 0; start < done.size(); ++start) {
      if (done[start] || map.state[start] == PointState::Free) continue;
      open.assign(1, start);
      done[start] = 1;
      for (std::size_t o = 0; o < open.size(); ++o) {
        if (o % kGrain == 0) monitor.checkpoint();
        for (const Index r : target_.part.neighborhoods().of(part_.points[open[o]])) {
          const Index p = place_[r];
          if (p == kNone || done[p] || map.state[p] == PointState::Free ||
              map.patch[p] != map.patch[open[o]])
            continue;
          done[p] = 1;
          unwrap(open[o], p);
          open.push_back(p);
        }
      }
    }
  }

 private:
  ChartSite siteOf(Index p) const {
    ChartSite site;
    site.position = target_.part.points().positions[part_.points[p]];
    site.n = part_.map.frame[p].n, site.t = part_.map.frame[p].t;
    site.q = part_.map.domain[p];
    if (!part_.map.scale.empty()) site.scale = part_.map.scale[p];
    return site;
  }

  void unwrap(Index from, Index to) {
    const vec2 size(target_.region.swatch->width, target_.region.swatch->height);
    const vec2 expected = carriedPlace(siteOf(from), siteOf(to), target_.unit);
    vec2& q = part_.map.domain[to];
    q += size * glm::round((expected - q) / size);
  }

  const RegionTarget& target_;
  RegionPart& part_;
  std::vector<Index> place_;  // by region point: in the part, or kNone
};

void gatherMap(const Results& results, const RegionTarget& target, std::span<const Fate> fates,
               RegionPart& part) {
  part.map = emptySourceMap(part.points.size(), target.unit);
  SourceMap& map = part.map;
  for (std::size_t p = 0; p < part.points.size(); ++p) {
    const Index r = part.points[p], i = target.part.idOf(static_cast<Index>(r));
    if (!target.field.scale.empty()) map.scale.push_back(target.field.scale[r]);
    if (fates[r] == Fate::Changed) {
      map.frame[p] = target.field.frames[r];
      continue;
    }
    map.texel[p] = (*results.texel)[i];
    map.frame[p] = (*results.frame)[i];
    map.patch[p] = (*results.patch)[i];
    map.error[p] = (*results.error)[i];
    map.order[p] = (*results.order)[i];
    map.colour[p] = mappedColour(map, *target.region.swatch, p);
    map.state[p] = map.patch[p] == kNone ? PointState::Matched : PointState::Patch;
  }
}

// Different numbers, of which a few are told many times.
class NumberSet {
 public:
  NumberSet() { recent_.fill(kNone); }

  void add(Index number) {
    Index& recent = recent_[number % recent_.size()];
    if (number == recent) return;
    recent = number;
    all_.push_back(number);
  }
  void add(const NumberSet& other) {
    for (const Index number : other.all_) add(number);
  }
  std::size_t count() {
    std::sort(all_.begin(), all_.end());
    all_.erase(std::unique(all_.begin(), all_.end()), all_.end());
    return all_.size();
  }

 private:
  std::array<Index, 256> recent_;
  std::vector<Index> all_;  // some more than once
};

// What of some points statistics are made of.
struct Tally {
  std::size_t laid = 0, gaps = 0, matched = 0;
  double distortion = 0, most = 0;
  NumberSet patches;

  void add(PointState state, Index patch, float error) {
    if (patch != kNone) patches.add(patch);
    gaps += state == PointState::Gap ? 1 : 0;
    matched += state == PointState::Matched ? 1 : 0;
    if (state != PointState::Patch) return;
    ++laid;
    distortion += double{error};
    most = std::max(most, double{error});
  }
  void add(const Tally& other) {
    laid += other.laid, gaps += other.gaps, matched += other.matched;
    distortion += other.distortion;
    most = std::max(most, other.most);
    patches.add(other.patches);
  }
};

// A region's result while some of its points get what was made of them.
class Renewal {
 public:
  Renewal(const Document& document, const RegionTarget& target, const RegionPart& part,
          const SourceMap& made)
      : results_(document.results), target_(target), part_(part), made_(made) {}

  PartResult run(Monitor& monitor) {
    numberPatches();
    takeValues();
    if (blendsAnything()) takeBlends();
    out_.statistics = statistics(monitor);
    return std::move(out_);
  }

 private:
  static constexpr std::size_t kTallied = std::size_t{1} << 17;  // points at once

  Index idOf(std::size_t r) const { return target_.part.idOf(static_cast<Index>(r)); }
  bool isFresh(std::size_t p) const { return part_.map.state[p] == PointState::Free; }
  bool isNew(std::size_t p) const { return isFresh(p) || made_.texel[p] != part_.map.texel[p]; }

  // Patches of the part by their numbers in the result.
  void numberPatches() {
    numberOf_ = part_.patchOf;
    if (numberOf_.size() >= made_.placement.size()) return;
    const std::vector<Index>& patch = *results_.patch;
    Index next = 0;
    for (std::size_t r = 0; r < target_.part.size(); ++r)
      next = std::max(next, patch[idOf(r)] + 1);  // 0 of kNone
    while (numberOf_.size() < made_.placement.size()) numberOf_.push_back(next++);
  }

  void takeValues() {
    SourceMap& map = out_.map;
    map.unit = target_.unit;
    for (std::size_t p = 0; p < part_.points.size(); ++p) {
      if (!isNew(p)) continue;
      const Index r = part_.points[p], i = idOf(r);
      out_.points.push_back(i);
      if (!target_.field.scale.empty()) map.scale.push_back(target_.field.scale[r]);
      map.texel.push_back(made_.texel[p]);
      map.frame.push_back(made_.frame[p]);
      if (!made_.level.empty()) map.level.push_back(made_.level[p]);
      map.colour.push_back(made_.colour[p]);
      map.state.push_back(isFresh(p) ? made_.state[p] : (*results_.state)[i]);
      map.patch.push_back(made_.patch[p] == kNone ? kNone : numberOf_[made_.patch[p]]);
      map.error.push_back(made_.error[p]);
      map.order.push_back(made_.order[p]);
    }
  }

  bool blendsAnything() const {
    return !made_.blendOffset.empty() ||
           std::any_of(results_.sources.begin(), results_.sources.end(),
                       [](const auto& source) { return !source->blended.empty(); });
  }

  // From the part or from the result that there is.
  void takeBlends() {
    std::size_t p = 0;
    for (std::size_t r = 0; r < target_.part.size(); ++r) {
      const Index i = idOf(r);
      const bool inPart = p < part_.points.size() && part_.points[p] == r;
      const std::size_t before = out_.blend.size();
      if (!inPart || !isNew(p))
        addTerms(i);
      else if (isFresh(p))
        addMadeTerms(p);
      p += inPart ? 1 : 0;
      if (out_.blend.size() == before) continue;
      out_.blended.push_back(i);
      out_.blendEnd.push_back(out_.blend.size());
    }
  }

  void addTerms(Index i) {
    const std::uint16_t s = (*results_.source)[i];
    if (s == kNoSource) return;
    const auto terms = results_.sources[s]->termsAt(i);
    out_.blend.insert(out_.blend.end(), terms.begin(), terms.end());
  }

  void addMadeTerms(std::size_t p) {
    if (made_.blendOffset.empty()) return;
    for (Index b = made_.blendOffset[p]; b < made_.blendOffset[p + 1]; ++b) {
      out_.blend.push_back(made_.blend[b]);
      out_.blend.back().patch = numberOf_[made_.blend[b].patch];
    }
  }

  Tally tallied(std::size_t begin, std::size_t end) const {
    Tally tally;
    const std::vector<Index>& points = out_.points;
    auto c = static_cast<std::size_t>(std::lower_bound(points.begin(), points.end(), idOf(begin)) -
                                      points.begin());
    for (std::size_t r = begin; r < end; ++r) {
      const Index i = idOf(r);
      if (c < points.size() && points[c] == i) {
        tally.add(out_.map.state[c], out_.map.patch[c], out_.map.error[c]);
        ++c;
      } else {
        tally.add((*results_.state)[i], (*results_.patch)[i], (*results_.error)[i]);
      }
    }
    return tally;
  }

  SynthesisStatistics statistics(Monitor& monitor) const {
    const std::size_t n = target_.part.size();
    std::vector<Tally> tallies(1 + (n - 1) / kTallied);
    parallelFor(monitor, n, kTallied, [&](std::size_t begin, std::size_t end) {
      tallies[begin / kTallied] = tallied(begin, end);
    });
    Tally& all = tallies.front();
    for (std::size_t t = 1; t < tallies.size(); ++t) all.add(tallies[t]);
    SynthesisStatistics statistics{.maxDistortion = all.most};
    statistics.patches = all.patches.count();
    statistics.gapShare = static_cast<double>(all.gaps) / static_cast<double>(n);
    statistics.matchedShare = static_cast<double>(all.matched) / static_cast<double>(n);
    if (all.laid > 0) statistics.meanDistortion = all.distortion / static_cast<double>(all.laid);
    return statistics;
  }

  const Results& results_;
  const RegionTarget& target_;
  const RegionPart& part_;
  const SourceMap& made_;        // of the part's points
  std::vector<Index> numberOf_;  // by the part's patches: in the result
  PartResult out_;
};

}  // namespace

std::optional<RegionPart> changedPart(const Document& document, const RegionTarget& target,
                                      Monitor& monitor) {
  const Results& results = document.results;
  if (!results.source || !keepsPoints(target.region.options)) return std::nullopt;
  Fates fates = changedPoints(results, target, monitor);
  RegionPart part;
  if (fates.again.empty()) return part;
  addHalo(target, fates, monitor);
  part.points = std::move(fates.again);
  const double share =
      static_cast<double>(part.points.size()) / static_cast<double>(target.part.size());
  if (share > kMostShare || part.points.size() <= 4 * target.part.neighborhoods().k)
    return std::nullopt;
  gatherMap(results, target, fates.of, part);
  renumber(part);
  Unwrapper(target, part).run(monitor);
  return part;
}

PartResult withPart(const Document& document, const RegionTarget& target, const RegionPart& part,
                    const SourceMap& made, Monitor& monitor) {
  return Renewal(document, target, part, made).run(monitor);
}

}  // namespace dapple
