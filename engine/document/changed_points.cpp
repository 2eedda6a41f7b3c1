#include "document/changed_points.h"

#include <algorithm>
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

std::vector<std::uint8_t> changedPoints(const Results& results, const RegionTarget& target,
                                        Monitor& monitor) {
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
  std::vector<std::uint8_t> changed(target.part.size());
  parallelFor(monitor, changed.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const Index i = target.part.idOf(static_cast<Index>(r));
      const std::uint16_t s = (*results.source)[i];
      changed[r] = s == kNoSource || !suitable[s] ||
                   turned((*results.frame)[i], target.field.frames[r], folds, cosine) ||
                   rescaled(static_cast<Index>(r), i);
    }
  });
  return changed;
}

// The points that changed and those nearer to them than kHalo, along the surface.
std::vector<Index> withHalo(const RegionTarget& target, std::span<const std::uint8_t> changed,
                            Monitor& monitor) {
  std::vector<Index> reached;
  std::vector<std::uint8_t> inside(changed.begin(), changed.end());
  for (Index r = 0; r < inside.size(); ++r)
    if (inside[r]) reached.push_back(r);
  std::vector<float> distance(reached.size(), 0);
  const std::vector<vec3>& positions = target.part.points().positions;
  for (std::size_t d = 0; d < reached.size(); ++d) {
    if (d % kGrain == 0) monitor.checkpoint();
    const Index r = reached[d];
    for (const Index j : target.part.neighborhoods().of(r)) {
      const float far = distance[d] + distanceBetween(positions[r], positions[j]) / target.unit;
      if (inside[j] || far > kHalo) continue;
      inside[j] = 1;
      reached.push_back(j), distance.push_back(far);
    }
  }
  std::sort(reached.begin(), reached.end());
  return reached;
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
  Unwrapper(const RegionTarget& target, RegionPart& part)
      : target_(target), part_(part), place_(target.part.size(), kNone) {
    for (Index p = 0; p < part.points.size(); ++p) place_[part.points[p]] = p;
  }

  void run(Monitor& monitor) {
    SourceMap& map = part_.map;
    map.domain = map.texel;
    if (!target_.region.swatch->tileable) return;
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

void gatherMap(const Results& results, const RegionTarget& target,
               std::span<const std::uint8_t> changed, RegionPart& part) {
  part.map = emptySourceMap(part.points.size(), target.unit);
  SourceMap& map = part.map;
  for (std::size_t p = 0; p < part.points.size(); ++p) {
    const Index r = part.points[p], i = target.part.idOf(static_cast<Index>(r));
    if (!target.field.scale.empty()) map.scale.push_back(target.field.scale[r]);
    if (changed[r]) {
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

// The result that there is, without those of the points that changed.
SourceMap presentMap(const Document& document, const RegionTarget& target) {
  const Results& results = document.results;
  const std::size_t m = target.part.size();
  SourceMap map = emptySourceMap(m, target.unit);
  map.scale = target.field.scale;
  for (std::size_t r = 0; r < m; ++r) {
    const Index i = target.part.idOf(static_cast<Index>(r));
    map.texel[r] = (*results.texel)[i];
    map.frame[r] = (*results.frame)[i];
    map.colour[r] = (*results.colour)[i];
    map.state[r] = (*results.state)[i];
    map.patch[r] = (*results.patch)[i];
    map.error[r] = (*results.error)[i];
    map.order[r] = (*results.order)[i];
  }
  // Near a border the colour is a mix, which is made anew.
  if (results.border)
    for (std::size_t r = 0; r < m; ++r)
      if (const auto b = results.border->find(target.part.idOf(static_cast<Index>(r))))
        map.colour[r] = results.border->own[*b];
  return map;
}

SynthesisStatistics statisticsOf(const SourceMap& map) {
  SynthesisStatistics statistics;
  std::vector<Index> patches;
  double sum = 0;
  std::size_t laid = 0, gaps = 0, matched = 0;
  for (std::size_t i = 0; i < map.state.size(); ++i) {
    if (map.patch[i] != kNone) patches.push_back(map.patch[i]);
    gaps += map.state[i] == PointState::Gap ? 1 : 0;
    matched += map.state[i] == PointState::Matched ? 1 : 0;
    if (map.state[i] != PointState::Patch) continue;
    ++laid;
    sum += double{map.error[i]};
    statistics.maxDistortion = std::max(statistics.maxDistortion, double{map.error[i]});
  }
  std::sort(patches.begin(), patches.end());
  patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
  const auto n = static_cast<double>(map.state.size());
  statistics.patches = patches.size();
  statistics.gapShare = static_cast<double>(gaps) / n;
  statistics.matchedShare = static_cast<double>(matched) / n;
  if (laid > 0) statistics.meanDistortion = sum / static_cast<double>(laid);
  return statistics;
}

struct MadePart {
  const RegionPart& part;
  const SourceMap& map;         // of the part's points
  std::vector<Index> numberOf;  // by its patches: in the result

  bool isFresh(std::size_t p) const { return part.map.state[p] == PointState::Free; }
};

// A point's blend terms, from the part or from the result that there is.
void addBlends(const Results& results, const RegionTarget& target, const MadePart& from,
               SourceMap& map) {
  const RegionPart& part = from.part;
  const SourceMap& made = from.map;
  map.blendOffset.assign(1, 0);
  std::size_t p = 0;
  for (std::size_t r = 0; r < target.part.size(); ++r) {
    const bool inPart = p < part.points.size() && part.points[p] == r;
    const bool fresh = inPart && from.isFresh(p);
    if (fresh && !made.blendOffset.empty()) {
      for (Index b = made.blendOffset[p]; b < made.blendOffset[p + 1]; ++b) {
        map.blend.push_back(made.blend[b]);
        map.blend.back().patch = from.numberOf[made.blend[b].patch];
      }
    } else if (!fresh && (!inPart || made.texel[p] == part.map.texel[p])) {
      const std::uint16_t s = (*results.source)[target.part.idOf(static_cast<Index>(r))];
      if (s != kNoSource)
        for (const BlendTerm& term :
             results.sources[s]->termsAt(target.part.idOf(static_cast<Index>(r))))
          map.blend.push_back(term);
    }
    p += inPart ? 1 : 0;
    map.blendOffset.push_back(static_cast<Index>(map.blend.size()));
  }
  if (map.blend.empty()) map.blendOffset.clear();
}

}  // namespace

std::optional<RegionPart> changedPart(const Document& document, const RegionTarget& target,
                                      Monitor& monitor) {
  const Results& results = document.results;
  if (!results.source || !keepsPoints(target.region.options)) return std::nullopt;
  const std::vector<std::uint8_t> changed = changedPoints(results, target, monitor);
  RegionPart part;
  if (std::find(changed.begin(), changed.end(), 1) == changed.end()) return part;
  part.points = withHalo(target, changed, monitor);
  const double share =
      static_cast<double>(part.points.size()) / static_cast<double>(target.part.size());
  if (share > kMostShare || part.points.size() <= 4 * target.part.neighborhoods().k)
    return std::nullopt;
  gatherMap(results, target, changed, part);
  renumber(part);
  Unwrapper(target, part).run(monitor);
  return part;
}

SynthesisResult withPart(const Document& document, const RegionTarget& target,
                         const RegionPart& part, const SourceMap& made) {
  SynthesisResult out{.map = presentMap(document, target)};
  SourceMap& map = out.map;
  Index next = 0;
  for (const Index patch : map.patch)
    if (patch != kNone) next = std::max(next, patch + 1);
  MadePart from{part, made, part.patchOf};
  while (from.numberOf.size() < made.placement.size()) from.numberOf.push_back(next++);
  addBlends(document.results, target, from, map);
  for (std::size_t p = 0; p < part.points.size(); ++p) {
    const bool fresh = from.isFresh(p);
    if (!fresh && made.texel[p] == part.map.texel[p]) continue;
    const Index r = part.points[p];
    map.texel[r] = made.texel[p];
    map.frame[r] = made.frame[p];
    map.colour[r] = made.colour[p];
    if (fresh) map.state[r] = made.state[p];
    map.patch[r] = made.patch[p] == kNone ? kNone : from.numberOf[made.patch[p]];
    map.error[r] = made.error[p];
    map.order[r] = made.order[p];
  }
  out.statistics = statisticsOf(map);
  return out;
}

}  // namespace dapple
