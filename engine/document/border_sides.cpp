#include "document/border_sides.h"

#include <algorithm>
#include <limits>

#include "regions/inner_half.h"
#include "regions/surface_distance.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 1 << 16;

}  // namespace

BorderSides::BorderSides(const Document& document)
    : document_(document), takesPart_(document.size(), false) {
  source_.fill(kNoSource);
  const float spacing = document.scan->prepared.spacing;
  for (const Region& region : *document.regions) {
    kind_[region.id] = region.borderKind;
    width_[region.id] = static_cast<float>(region.borderWidth) * spacing;
    locked_[region.id] = region.locked;
  }
  const Results& results = document.results;
  // Of several results of one region the newest counts.
  std::vector<std::uint8_t> usable(results.sources.size());
  for (std::size_t s = 0; s < usable.size(); ++s)
    usable[s] = !results.sources[s]->partial && results.sources[s]->swatch;
  const auto isOf = [&](std::uint16_t s, RegionId region) {
    return s != kNoSource && usable[s] && results.sources[s]->region == region;
  };
  const std::vector<std::uint16_t>& source = *results.source;
  const std::vector<RegionId>& label = *document.labels;
  for (std::size_t i = 0; i < document.size(); ++i) {
    std::uint16_t& newest = source_[label[i]];
    if (source[i] == newest || !isOf(source[i], label[i])) continue;
    if (newest == kNoSource || source[i] > newest) newest = source[i];
  }
  for (std::size_t i = 0; i < document.size(); ++i)
    takesPart_[i] = source[i] != kNoSource && source_[label[i]] == source[i];
}

BorderKind BorderSides::kind(RegionId a, RegionId b) const {
  for (const BorderKind kind : {BorderKind::Blend, BorderKind::Hard})
    if (kind_[a] == kind || kind_[b] == kind) return kind;
  return BorderKind::Cut;
}

float BorderSides::reach(RegionId from, RegionId into) const {
  const BorderKind meets = kind(from, into);
  if (from == into || locked_[into] || meets == BorderKind::Hard) return 0;
  float width = 0;
  for (const RegionId side : {from, into})
    if (kind_[side] == meets) width = std::max(width, width_[side]);
  return locked_[from] ? width : width / 2;
}

float BorderSides::farthestReach(RegionId from) const {
  float most = 0;
  for (std::size_t into = 0; into < kRegions; ++into)
    if (source_[into] != kNoSource) most = std::max(most, reach(from, static_cast<RegionId>(into)));
  return most;
}

std::array<std::vector<Index>, BorderSides::kRegions> BorderSides::rims(Monitor& monitor) const {
  const Neighborhoods& all = document_.scan->prepared.neighborhoods;
  std::vector<bool> rim(all.size(), false);
  const std::size_t links = linksOf(all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % kCheckpointEvery == 0) monitor.checkpoint();
    for (const Index j : all.of(i).first(links))
      if (of(static_cast<Index>(i)) != of(j)) rim[i] = rim[j] = true;
  }
  std::array<std::vector<Index>, kRegions> out;
  for (Index i = 0; i < all.size(); ++i)
    if (rim[i] && takesPart(i)) out[of(i)].push_back(i);
  return out;
}

BorderSides::Halo BorderSides::haloOf(RegionId region, std::span<const float> distance) const {
  Halo halo;
  for (Index i = 0; i < document_.size(); ++i)
    if (takesPart(i) && of(i) != region && distance[i] < reach(region, of(i)))
      halo.points.push_back(i);
  std::sort(halo.points.begin(), halo.points.end(), [&](Index a, Index b) {
    return distance[a] != distance[b] ? distance[a] < distance[b] : a < b;
  });
  for (const Index i : halo.points) halo.inside.push_back(distance[i]);
  return halo;
}

void BorderSides::spareNarrow(std::span<const float> depth, std::array<Halo, kRegions>& halos,
                              Monitor& monitor) const {
  std::vector<bool> asked(document_.size(), false);
  for (std::size_t r = 0; r < kRegions; ++r)
    for (const Index i : halos[r].points)
      if (kind(static_cast<RegionId>(r), of(i)) == BorderKind::Cut) asked[i] = true;
  std::vector<Index> points;
  for (Index i = 0; i < document_.size(); ++i)
    if (asked[i]) points.push_back(i);
  const PreparedScan& prepared = document_.scan->prepared;
  const std::vector<bool> inner =
      innerHalf({document_.points(), prepared.neighborhoods},
                {*document_.labels, depth, prepared.spacing}, points, monitor);
  std::vector<bool> spared(document_.size(), false);
  for (std::size_t p = 0; p < points.size(); ++p) spared[points[p]] = inner[p];
  for (std::size_t r = 0; r < kRegions; ++r) {
    Halo kept;
    for (std::size_t h = 0; h < halos[r].points.size(); ++h) {
      const Index i = halos[r].points[h];
      if (spared[i] && kind(static_cast<RegionId>(r), of(i)) == BorderKind::Cut) continue;
      kept.points.push_back(i);
      kept.inside.push_back(halos[r].inside[h]);
    }
    halos[r] = std::move(kept);
  }
}

std::array<BorderSides::Halo, BorderSides::kRegions> BorderSides::halos(Monitor& monitor) const {
  std::array<Halo, kRegions> out;
  float farthest = 0;
  for (std::size_t r = 0; r < kRegions; ++r)
    if (source_[r] != kNoSource)
      farthest = std::max(farthest, farthestReach(static_cast<RegionId>(r)));
  if (farthest == 0) return out;
  const PreparedScan& prepared = document_.scan->prepared;
  // The border runs between the points: half a spacing before the first one beyond.
  const float half = prepared.spacing / 2;
  std::vector<float> depth(document_.size(), std::numeric_limits<float>::infinity());
  const std::array<std::vector<Index>, kRegions> rim = rims(monitor);
  for (std::size_t r = 0; r < kRegions; ++r) {
    const auto region = static_cast<RegionId>(r);
    if (rim[r].empty() || farthestReach(region) == 0) continue;
    // Twice as far, so that it is known of what is reached whether it is narrow.
    std::vector<float> distance = surfaceDistances({document_.points(), prepared.neighborhoods},
                                                   rim[r], 2 * farthest + half, monitor);
    for (float& d : distance) d = std::max(0.f, d - half);
    for (Index i = 0; i < document_.size(); ++i)
      if (of(i) != region) depth[i] = std::min(depth[i], distance[i]);
    out[r] = haloOf(region, distance);
  }
  spareNarrow(depth, out, monitor);
  return out;
}

}  // namespace dapple
