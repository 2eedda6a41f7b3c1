#include "document/border_sides.h"

#include <algorithm>

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

void BorderSides::spareNarrow(RegionId region, std::span<const float> distance, Halo& halo) const {
  const Neighborhoods& all = document_.scan->prepared.neighborhoods;
  const std::size_t links = linksOf(all);
  std::vector<std::uint8_t> waits(document_.size(), 0);
  for (const Index i : halo.points) waits[i] = kind(region, of(i)) == BorderKind::Cut;
  std::vector<std::uint8_t> reached = waits, spared(document_.size(), 0);
  std::vector<Index> part;
  for (const Index start : halo.points) {
    if (!waits[start]) continue;
    bool whole = true;
    float deepest = 0;
    part.assign(1, start);
    waits[start] = 0;
    for (std::size_t p = 0; p < part.size(); ++p) {
      deepest = std::max(deepest, distance[part[p]]);
      for (const Index j : all.of(part[p]).first(links)) {
        if (of(j) != of(start)) continue;
        whole = whole && reached[j];
        if (!waits[j]) continue;
        waits[j] = 0;
        part.push_back(j);
      }
    }
    if (!whole) continue;
    for (const Index i : part) spared[i] = distance[i] > deepest / 2;
  }
  std::erase_if(halo.points, [&](Index i) { return spared[i] != 0; });
}

BorderSides::Halo BorderSides::haloOf(RegionId region, std::span<const Index> rim,
                                      Monitor& monitor) const {
  const PreparedScan& prepared = document_.scan->prepared;
  // The border runs between the points: half a spacing before the first one beyond.
  const float half = prepared.spacing / 2;
  const std::vector<float> distance = surfaceDistances({document_.points(), prepared.neighborhoods},
                                                       rim, farthestReach(region) + half, monitor);
  Halo halo;
  for (Index i = 0; i < document_.size(); ++i)
    if (takesPart(i) && of(i) != region && distance[i] - half < reach(region, of(i)))
      halo.points.push_back(i);
  spareNarrow(region, distance, halo);
  std::sort(halo.points.begin(), halo.points.end(), [&](Index a, Index b) {
    return distance[a] != distance[b] ? distance[a] < distance[b] : a < b;
  });
  for (const Index i : halo.points) halo.inside.push_back(std::max(0.f, distance[i] - half));
  return halo;
}

}  // namespace dapple
