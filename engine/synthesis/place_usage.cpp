// Departures from methods 3.4, step 5: what looks alike is counted as one, wherever in the swatch
// it is. Flat parts fit anywhere and spread at the cost of others; they need not be in one place
// for that. Mean F of eight swatches on the bunny of 12,000, 35,000 and 85,000 points: by position
// alone 0.28, 0.44, 0.57; with looks 0.33, 0.47, 0.58.
#include "synthesis/place_usage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "synthesis/place_counts.h"

namespace dapple {
namespace {

constexpr std::int32_t kMostColumns = 128;
constexpr int kMostBlocks = 12;  // along each axis, that positions are counted by
constexpr int kMostSplits = 4;   // of looks, in two
// At least; fewer groups say more. Mean F of seven swatches on 12,000 and 35,000 points, two seeds
// each, with 16 and 6: 0.35 and 0.39, 0.60 and 0.63; of thirteen on 85,000: 0.65 and 0.67.
constexpr std::size_t kSitesPerGroup = 6;
// From so many sites on looks are in as many groups as they ever are.
constexpr std::size_t kSitesOfAllLooks = ((1 << (kMostSplits - 1)) + 1) * 2 * kSitesPerGroup;
// How much use beyond the fair share counts.
constexpr float kPositionUse = 0.5f, kLookUse = 1;
constexpr int kLookNumbers = 3;  // of an appearance, the last ones: they differ most

int mostSpread(const AppearanceLevel& appearance, std::span<const Place> places) {
  int axis = kAppearanceNumbers - 1;
  double most = -1;
  for (int a = kAppearanceNumbers - 1; a >= kAppearanceNumbers - kLookNumbers; --a) {
    double sum = 0, squares = 0;
    for (const Place place : places) {
      const double value = appearance.at(place).number[a];
      sum += value, squares += value * value;
    }
    const double spread = squares - sum * sum / static_cast<double>(places.size());
    if (spread > most) most = spread, axis = a;
  }
  return axis;
}

// Puts the half that is least along the axis of most spread first.
void halve(const AppearanceLevel& appearance, std::span<Place> places) {
  const int axis = mostSpread(appearance, places);
  const auto before = [&](Place a, Place b) {
    const int va = appearance.at(a).number[axis], vb = appearance.at(b).number[axis];
    return va != vb ? va < vb : a.y != b.y ? a.y < b.y : a.x < b.x;
  };
  std::nth_element(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(places.size() / 2),
                   places.end(), before);
}

std::vector<float> factorsOf(std::span<const std::uint32_t> counts, std::span<const float> shares,
                             float fair, float weight) {
  std::vector<float> out(counts.size());
  for (std::size_t g = 0; g < counts.size(); ++g) {
    const float mean = shares[g] * fair;
    const float excess = mean > 0 ? static_cast<float>(counts[g]) / mean - 1 : 0;
    out[g] = 1 + weight * std::max(0.0f, excess);
  }
  return out;
}

}  // namespace

PlaceUsage::PlaceUsage(const PlaceDomain& domain, const AppearanceLevel& appearance,
                       std::size_t sites) {
  map_.shift = kPlaceBits;
  const std::int32_t longest = std::max(domain.width(), domain.height()) - 1;
  while (longest >> map_.shift >= kMostColumns) ++map_.shift;
  map_.columns = ((domain.width() - 1) >> map_.shift) + 1;
  const std::int32_t rows = ((domain.height() - 1) >> map_.shift) + 1;
  map_.factor.assign(static_cast<std::size_t>(map_.columns) * rows, 1.0f);
  const std::int32_t half = 1 << (map_.shift - 1);
  for (std::int32_t y = 0; y < rows; ++y)
    for (std::int32_t x = 0; x < map_.columns; ++x) {
      const Place middle{(x << map_.shift) + half, (y << map_.shift) + half};
      if (middle.x >= domain.width() || middle.y >= domain.height() || !domain.contains(middle))
        continue;
      middles_.push_back(middle);
      cells_.push_back(map_.cellOf(middle));
    }
  const float side = std::ldexp(kPlaceScale, appearance.level);
  atLeast_ =
      static_cast<float>(domain.width()) / side * (static_cast<float>(domain.height()) / side);
  positions_ = byPosition(domain, sites);
  looks_ = *appearance.tables.get<Grouping>(std::min(sites, kSitesOfAllLooks),
                                            [&] { return byLook(appearance, sites); });
}

void PlaceUsage::setShares(Grouping& grouping, std::size_t groups) const {
  grouping.share.assign(groups, 0.0f);
  for (const std::size_t cell : cells_) grouping.share[grouping.group[cell]] += 1;
  for (float& share : grouping.share)
    share /= static_cast<float>(std::max<std::size_t>(1, cells_.size()));
}

PlaceUsage::Grouping PlaceUsage::byPosition(const PlaceDomain& domain, std::size_t sites) const {
  int blocks = 1;
  while (blocks < kMostBlocks &&
         static_cast<std::size_t>((blocks + 1) * (blocks + 1)) * kSitesPerGroup <= sites)
    ++blocks;
  Grouping out;
  out.group.resize(map_.factor.size());
  for (std::size_t cell = 0; cell < out.group.size(); ++cell) {
    const auto x = static_cast<std::int64_t>(cell % static_cast<std::size_t>(map_.columns));
    const auto y = static_cast<std::int64_t>(cell / static_cast<std::size_t>(map_.columns));
    const auto column = (x << map_.shift) * blocks / domain.width();
    const auto row = (y << map_.shift) * blocks / domain.height();
    out.group[cell] = static_cast<std::uint8_t>(row * blocks + column);
  }
  setShares(out, static_cast<std::size_t>(blocks) * blocks);
  return out;
}

// Halves of halves, each along the number that differs most within it: as many cells to each group.
PlaceUsage::Grouping PlaceUsage::byLook(const AppearanceLevel& appearance,
                                        std::size_t sites) const {
  std::vector<Place> places = middles_;
  std::vector<std::size_t> ends{0, places.size()};
  for (int split = 0; split < kMostSplits && ends.size() * 2 * kSitesPerGroup <= sites &&
                      ends.size() * 2 < places.size();
       ++split) {
    std::vector<std::size_t> next{0};
    for (std::size_t part = 0; part + 1 < ends.size(); ++part) {
      const std::size_t begin = ends[part], size = ends[part + 1] - begin;
      halve(appearance, std::span(places).subspan(begin, size));
      next.push_back(begin + size / 2);
      next.push_back(begin + size);
    }
    ends = std::move(next);
  }
  Grouping out;
  // Cells that are hardly usable belong to a group without a share, which counts for nothing.
  out.group.assign(map_.factor.size(), static_cast<std::uint8_t>(ends.size() - 1));
  for (std::size_t part = 0; part + 1 < ends.size(); ++part)
    for (std::size_t i = ends[part]; i < ends[part + 1]; ++i)
      out.group[map_.cellOf(places[i])] = static_cast<std::uint8_t>(part);
  setShares(out, ends.size());
  return out;
}

void PlaceUsage::count(std::span<const Place> places, Monitor& monitor) {
  const auto counts = countCells(
      places.size(), map_.factor.size(), [&](std::size_t i) { return map_.cellOf(places[i]); },
      monitor);
  const auto grouped = [&](const Grouping& grouping, float fair, float weight) {
    // Of every fourth cell each: cells in a row are mostly of one group, and would wait for each
    // other.
    std::vector<std::array<std::uint32_t, 4>> quarters(grouping.share.size());
    for (std::size_t cell = 0; cell < counts.size(); ++cell)
      quarters[grouping.group[cell]][cell % 4] += counts[cell];
    std::vector<std::uint32_t> sums(grouping.share.size());
    for (std::size_t g = 0; g < sums.size(); ++g)
      sums[g] = std::accumulate(quarters[g].begin(), quarters[g].end(), std::uint32_t{0});
    return factorsOf(sums, grouping.share, fair, weight);
  };
  const auto all = static_cast<float>(places.size());
  // A surface smaller than the swatch may show a part of it once.
  const auto position = grouped(positions_, std::max(all, atLeast_), kPositionUse);
  const auto look = grouped(looks_, all, kLookUse);
  for (std::size_t cell = 0; cell < counts.size(); ++cell)
    map_.factor[cell] = position[positions_.group[cell]] * look[looks_.group[cell]];
}

}  // namespace dapple
