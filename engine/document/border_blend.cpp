#include "document/border_blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/errors.h"
#include "points/tangent_frames.h"
#include "regions/surface_distance.h"
#include "synthesis/baselines.h"
#include "synthesis/texture_extension.h"

namespace dapple {
namespace {

constexpr float kLeastWeight = 1.f / 1024;  // a quarter of a step of 8 bits
constexpr std::size_t kRegions = kMostRegions + 1;
constexpr std::size_t kCheckpointEvery = 1 << 16;

// What a region beyond a border gives to a point.
struct Share {
  Index point;
  BorderTerm term;  // weight: of the texel among those of its source
  float beyond;     // of the source at the point, 0..1, before others are heard
  bool locked;      // the source's region
};

float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.f, 1.f);
  return t * t * (3 - 2 * t);
}

vec3 colourOf(const ResultSource& source, const BorderTerm& term) {
  return sampleSwatch(*source.swatch, term.texel);
}

// The regions of a document as their borders see them.
class Sides {
 public:
  explicit Sides(const Document& document)
      : document_(document), of_(document.size(), kUnassigned), takesPart_(document.size(), false) {
    source_.fill(kNoSource);
    const float spacing = document.scan->prepared.spacing;
    for (const Region& region : *document.regions) {
      width_[region.id] = static_cast<float>(region.borderWidth) * spacing;
      locked_[region.id] = region.locked;
    }
    const Results& results = document.results;
    // Of several results of one region the newest counts.
    for (std::size_t i = 0; i < document.size(); ++i)
      if (usable(i)) {
        std::uint16_t& newest = source_[(*document.labels)[i]];
        if (newest == kNoSource || (*results.source)[i] > newest) newest = (*results.source)[i];
      }
    for (std::size_t i = 0; i < document.size(); ++i) {
      of_[i] = (*document.labels)[i];
      takesPart_[i] = usable(i) && source_[of_[i]] == (*results.source)[i];
    }
  }

  bool takesPart(Index i) const { return takesPart_[i]; }
  RegionId of(Index i) const { return of_[i]; }
  bool locked(RegionId region) const { return locked_[region]; }
  // kNoSource: takes no part.
  std::uint16_t source(RegionId region) const { return source_[region]; }
  const std::vector<bool>& takePart() const { return takesPart_; }

  // How far `from` reaches into `into`; 0: not at all.
  float reach(RegionId from, RegionId into) const {
    if (from == into || locked_[into]) return 0;
    const float width = std::max(width_[from], width_[into]);
    return locked_[from] ? width : width / 2;
  }
  float farthestReach(RegionId from) const {
    float most = 0;
    for (std::size_t into = 0; into < kRegions; ++into)
      if (source_[into] != kNoSource)
        most = std::max(most, reach(from, static_cast<RegionId>(into)));
    return most;
  }

 private:
  bool usable(std::size_t i) const {
    const Results& results = document_.results;
    const std::uint16_t s = (*results.source)[i];
    if (s == kNoSource) return false;
    const ResultSource& source = *results.sources[s];
    return !source.partial && source.swatch && source.region == (*document_.labels)[i];
  }

  const Document& document_;
  std::vector<RegionId> of_;
  std::vector<bool> takesPart_;
  std::array<std::uint16_t, kRegions> source_{};
  std::array<float, kRegions> width_{};
  std::array<bool, kRegions> locked_{};
};

// By region: its points that are linked to a point of another.
std::array<std::vector<Index>, kRegions> rims(const Sides& sides, const Neighborhoods& all,
                                              Monitor& monitor) {
  std::vector<bool> rim(all.size(), false);
  const std::size_t links = linksOf(all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % kCheckpointEvery == 0) monitor.checkpoint();
    for (const Index j : all.of(i).first(links))
      if (sides.of(static_cast<Index>(i)) != sides.of(j)) rim[i] = rim[j] = true;
  }
  std::array<std::vector<Index>, kRegions> out;
  for (Index i = 0; i < all.size(); ++i)
    if (rim[i] && sides.takesPart(i)) out[sides.of(i)].push_back(i);
  return out;
}

// Triplanar projections lie in space: they are carried on as they were made.
void addProjected(const Document& document, const ResultSource& source,
                  std::span<const Index> beyond, std::vector<Share>& shares, Monitor& monitor) {
  const PointSet& points = document.points();
  PointSet own;
  for (const Index i : beyond) {
    own.positions.push_back(points.positions[i]);
    own.normals.push_back(points.normals[i]);
  }
  const std::vector<TangentFrame> frames = framesTowards(own, source.options.up);
  const Neighborhoods none;
  SourceMap map = emptySourceMap(beyond.size(), source.unit);
  projectTriplanar({own, none, *source.swatch, frames, source.unit}, map, monitor);
  for (std::size_t b = 0; b < beyond.size(); ++b)
    for (std::size_t t = map.blendOffset[b]; t < map.blendOffset[b + 1]; ++t)
      shares.push_back(
          {.point = beyond[b],
           .term = {
               .texel = map.blend[t].texel, .up = frames[b].t, .weight = map.blend[t].weight}});
}

// Points of other regions that a region's pattern reaches, nearest first, and how far inside of
// their own they lie.
struct Halo {
  std::vector<Index> points;
  std::vector<float> inside;  // local units from the border
};

Halo haloOf(const Document& document, const Sides& sides, RegionId region,
            std::span<const Index> rim, Monitor& monitor) {
  const PreparedScan& prepared = document.scan->prepared;
  // The border runs between the points: half a spacing before the first one beyond.
  const float half = prepared.spacing / 2;
  const std::vector<float> distance =
      surfaceDistances({document.points(), prepared.neighborhoods}, rim,
                       sides.farthestReach(region) + half, monitor);
  Halo halo;
  for (Index i = 0; i < document.size(); ++i)
    if (sides.takesPart(i) && sides.of(i) != region &&
        distance[i] - half < sides.reach(region, sides.of(i)))
      halo.points.push_back(i);
  std::sort(halo.points.begin(), halo.points.end(), [&](Index a, Index b) {
    return distance[a] != distance[b] ? distance[a] < distance[b] : a < b;
  });
  for (const Index i : halo.points) halo.inside.push_back(std::max(0.f, distance[i] - half));
  return halo;
}

// A region's texels, carried on.
std::vector<Share> carriedOn(const Document& document, const Sides& sides, RegionId region,
                             std::span<const Index> beyond, Monitor& monitor) {
  const Results& results = document.results;
  const ResultSource& source = *results.sources[sides.source(region)];
  std::vector<Share> shares;
  if (source.options.method == Method::Triplanar) {
    addProjected(document, source, beyond, shares, monitor);
    return shares;
  }
  std::vector<bool> decided(document.size());
  for (Index i = 0; i < document.size(); ++i)
    decided[i] = sides.takesPart(i) && sides.of(i) == region;
  const Extension extension =
      extendTexture({document.points(), document.scan->prepared.neighborhoods, *source.swatch,
                     source.unit, *results.texel, *results.frame, results.scale.get()},
                    decided, beyond, monitor);
  for (std::size_t b = 0; b < beyond.size(); ++b)
    if (extension.reached[b])
      shares.push_back({.point = beyond[b],
                        .term = {.texel = extension.texel[b], .up = extension.up[b], .weight = 1}});
  return shares;
}

// The pattern of a region over the points beyond its border.
std::vector<Share> sharesOf(const Document& document, const Sides& sides, RegionId region,
                            std::span<const Index> rim, Monitor& monitor) {
  const Halo halo = haloOf(document, sides, region, rim, monitor);
  std::vector<Share> shares = carriedOn(document, sides, region, halo.points, monitor);
  std::size_t h = 0;
  for (Share& share : shares) {
    while (halo.points[h] != share.point) ++h;
    const float reach = sides.reach(region, sides.of(share.point));
    share.term.source = sides.source(region);
    share.locked = sides.locked(region);
    share.beyond = 1 - smoothstep(share.locked ? 0 : -reach, reach, halo.inside[h]);
  }
  return shares;
}

// The weights of all that is beyond, for one point. Where two unlocked regions meet they are what
// each asks for; where more do, all are scaled so that they sum to 1 with the point's own.
void settle(std::span<Share> shares) {
  float own = 1, others = 0, fixed = 0;
  std::uint16_t source = kNoSource;
  for (const Share& share : shares) {
    if (std::exchange(source, share.term.source) == share.term.source) continue;
    if (share.locked) {
      fixed += share.beyond;
      continue;
    }
    own = std::min(own, 1 - share.beyond);
    others += share.beyond;
  }
  const float lockedScale = fixed > 1 ? 1 / fixed : 1;
  const float rest = std::max(0.f, 1 - fixed) / std::max(own + others, 1e-6f);
  for (Share& share : shares)
    share.term.weight *= share.beyond * (share.locked ? lockedScale : rest);
}

// An entry whose colour cannot, or must not, be made again.
bool stays(const Document& document, std::size_t b) {
  const BorderMix& border = *document.results.border;
  const Region* region = findRegion(document, (*document.labels)[border.points[b]]);
  if (region && region->locked) return true;
  const Results& results = document.results;
  for (const BorderTerm& term : border.termsOf(b))
    if (!results.sources[term.source]->swatch) return true;
  const std::uint16_t own = (*results.source)[border.points[b]];
  return own != kNoSource && !results.sources[own]->swatch;
}

void append(BorderMix& to, Index point, const vec3& own, std::span<const BorderTerm> terms) {
  to.points.push_back(point);
  to.own.push_back(own);
  to.terms.insert(to.terms.end(), terms.begin(), terms.end());
  to.end.push_back(to.terms.size());
}

vec3 mixed(const Results& results, const vec3& own, std::span<const BorderTerm> terms) {
  vec3 colour(0);
  float weight = 1;
  for (const BorderTerm& term : terms) {
    colour += term.weight * colourOf(*results.sources[term.source], term);
    weight -= term.weight;
  }
  return colour + weight * own;
}

// The results with another border, of which `made` says which entries are not as they were.
Results withBorder(const Results& results, BorderMix border, const std::vector<bool>& made) {
  Results out = results;
  std::vector<vec3> colour = *results.colour;
  if (results.border)
    for (std::size_t b = 0; b < results.border->points.size(); ++b)
      if (const auto now = border.find(results.border->points[b]); !now || made[*now])
        colour[results.border->points[b]] = results.border->own[b];
  for (std::size_t b = 0; b < border.points.size(); ++b)
    if (made[b]) colour[border.points[b]] = mixed(results, border.own[b], border.termsOf(b));
  if (colour != *results.colour)
    out.colour = std::make_shared<const std::vector<vec3>>(std::move(colour));
  out.border =
      border.points.empty() ? nullptr : std::make_shared<const BorderMix>(std::move(border));
  dropUnusedSources(out);
  return out;
}

// What stays and what was made, in the order of points.
Results merged(const Document& document, std::span<Share> shares) {
  const Results& results = document.results;
  const BorderMix none;
  const BorderMix& old = results.border ? *results.border : none;
  BorderMix border;
  std::vector<bool> made;
  std::vector<BorderTerm> terms;
  std::size_t b = 0;
  const auto keepUpTo = [&](Index point) {
    for (; b < old.points.size() && old.points[b] < point; ++b)
      if (stays(document, b))
        append(border, old.points[b], old.own[b], old.termsOf(b)), made.push_back(false);
  };
  for (std::size_t s = 0; s < shares.size();) {
    const Index point = shares[s].point;
    std::size_t end = s;
    while (end < shares.size() && shares[end].point == point) ++end;
    const std::span<Share> here = shares.subspan(s, end - s);
    s = end;
    keepUpTo(point);
    const bool had = b < old.points.size() && old.points[b] == point;
    if (had && stays(document, b)) continue;  // taken with the next
    settle(here);
    terms.clear();
    for (const Share& share : here)
      if (share.term.weight >= kLeastWeight) terms.push_back(share.term);
    if (terms.empty()) continue;
    append(border, point, had ? old.own[b] : (*results.colour)[point], terms);
    made.push_back(true);
  }
  keepUpTo(kNone);
  return withBorder(results, std::move(border), made);
}

}  // namespace

Results blendBorders(const Document& document, Monitor& monitor) {
  if (!document.results.source) return document.results;
  const Sides sides(document);
  std::vector<Share> shares;
  bool any = false;
  for (std::size_t r = 0; r < kRegions; ++r)
    any |= sides.source(static_cast<RegionId>(r)) != kNoSource &&
           sides.farthestReach(static_cast<RegionId>(r)) > 0;
  if (any) {
    const auto rim = rims(sides, document.scan->prepared.neighborhoods, monitor);
    for (std::size_t r = 0; r < kRegions; ++r)
      if (!rim[r].empty() && sides.farthestReach(static_cast<RegionId>(r)) > 0) {
        const auto more = sharesOf(document, sides, static_cast<RegionId>(r), rim[r], monitor);
        shares.insert(shares.end(), more.begin(), more.end());
      }
  }
  std::stable_sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) {
    return a.point != b.point ? a.point < b.point : a.term.source < b.term.source;
  });
  return merged(document, shares);
}

Results withoutLostTerms(const Document& document) {
  const Results& results = document.results;
  if (!results.border) return results;
  std::vector<bool> owns(results.sources.size(), false);
  for (const std::uint16_t s : *results.source)
    if (s != kNoSource) owns[s] = true;
  const BorderMix& old = *results.border;
  BorderMix border;
  std::vector<bool> made;
  std::vector<BorderTerm> terms;
  for (std::size_t b = 0; b < old.points.size(); ++b) {
    terms.clear();
    float lost = 0;
    for (const BorderTerm& term : old.termsOf(b))
      if (owns[term.source])
        terms.push_back(term);
      else
        lost += term.weight;
    if (lost == 0 || stays(document, b)) {
      append(border, old.points[b], old.own[b], old.termsOf(b));
      made.push_back(false);
      continue;
    }
    for (BorderTerm& term : terms) term.weight /= std::max(1 - lost, kLeastWeight);
    if (terms.empty()) continue;
    append(border, old.points[b], old.own[b], terms);
    made.push_back(true);
  }
  return withBorder(results, std::move(border), made);
}

}  // namespace dapple
