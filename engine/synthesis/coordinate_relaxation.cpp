#include "synthesis/coordinate_relaxation.h"

#include <mutex>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 1024;
constexpr int kMostCells = 12;             // of the usage map, along each axis
constexpr std::size_t kSitesPerCell = 16;  // at least; a map of fewer cells says more
constexpr std::size_t kCountEvery = 2;     // classes between two counts
// Of a step. Mean F of 7 swatches on the bunny with 0.3, 0.1 and 0.05: 0.49, 0.53, 0.56.
constexpr float kMergeSteps = 0.05f;
constexpr float kUsage = 0.5f;  // how much use beyond the fair share counts

template <class Body>
void inChunks(Monitor& monitor, std::size_t count, const Body& body) {
  if (count > kGrain) return parallelFor(monitor, count, kGrain, body);
  monitor.checkpoint();
  if (count > 0) body(std::size_t{0}, count);
}

UsageMap emptyUsage(const PlaceDomain& domain, std::size_t sites) {
  UsageMap map;
  while (map.columns < kMostCells &&
         static_cast<std::size_t>((map.columns + 1) * (map.columns + 1)) * kSitesPerCell <= sites)
    ++map.columns;
  map.columns = std::min(map.columns, domain.width() >> kPlaceBits);
  map.rows = std::min(map.columns, domain.height() >> kPlaceBits);
  // A little less than cells / size, so that no place is rounded past the last cell.
  map.toColumn = static_cast<float>(map.columns) / static_cast<float>(domain.width()) * 0.99999f;
  map.toRow = static_cast<float>(map.rows) / static_cast<float>(domain.height()) * 0.99999f;
  map.factor.assign(static_cast<std::size_t>(map.columns) * map.rows, 1.0f);
  return map;
}

// By cell, its share of the places that may be used.
std::vector<float> expectedShares(const UsageMap& map, const PlaceDomain& domain) {
  constexpr std::int32_t kPixel = 1 << kPlaceBits;
  std::vector<float> shares(map.factor.size(), 0.0f);
  float all = 0;
  for (std::int32_t y = kPixel / 2; y < domain.height(); y += kPixel)
    for (std::int32_t x = kPixel / 2; x < domain.width(); x += kPixel) {
      if (!domain.contains({x, y})) continue;
      const int column = static_cast<int>(static_cast<float>(x) * map.toColumn);
      const int row = static_cast<int>(static_cast<float>(y) * map.toRow);
      shares[static_cast<std::size_t>(row) * map.columns + column] += 1;
      all += 1;
    }
  for (float& share : shares) share /= all;
  return shares;
}

}  // namespace

PlaceRelaxation::PlaceRelaxation(const SiteLevel& sites, const AppearanceLevel& appearance,
                                 const PlaceDomain& domain, std::vector<Place>& places,
                                 Monitor& monitor)
    : sites_(sites),
      appearance_(appearance),
      domain_(domain),
      places_(places),
      looks_(sites.size),
      usage_(emptyUsage(domain, sites.size)),
      expected_(expectedShares(usage_, domain)) {
  DAPPLE_CHECK(sites.k, <=, kMostNear);
  DAPPLE_CHECK(places.size(), ==, sites.size);
  std::vector<Index> free;
  free.reserve(sites.size);
  for (std::size_t i = 0; i < sites.size; ++i)
    if (sites.frozen.empty() || !sites.frozen[i]) free.push_back(static_cast<Index>(i));
  order_ = classOrder(free);
  inChunks(monitor, sites.size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) looks_[i] = appearance_.at(places_[i]);
  });
}

PlaceUpdate PlaceRelaxation::update() const {
  return {
      .sites = sites_,
      .appearance = appearance_,
      .domain = domain_,
      .usage = usage_,
      .places = places_.data(),
      .looks = looks_.data(),
      .merge = static_cast<std::int32_t>(std::ldexp(kMergeSteps * kPlaceScale, sites_.level)),
  };
}

// Whole numbers add up to the same in any order.
void PlaceRelaxation::countUsage(Monitor& monitor) {
  std::vector<std::uint32_t> counts(usage_.factor.size(), 0);
  std::mutex mutex;
  constexpr std::size_t kCountGrain = 1 << 16;
  parallelFor(monitor, sites_.size, kCountGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> own(counts.size(), 0);
    for (std::size_t i = begin; i < end; ++i) {
      const int column = static_cast<int>(static_cast<float>(places_[i].x) * usage_.toColumn);
      const int row = static_cast<int>(static_cast<float>(places_[i].y) * usage_.toRow);
      ++own[static_cast<std::size_t>(row) * usage_.columns + column];
    }
    const std::lock_guard lock(mutex);
    for (std::size_t c = 0; c < own.size(); ++c) counts[c] += own[c];
  });
  // A surface smaller than the swatch may show a part of it once.
  const float side = std::ldexp(kPlaceScale, sites_.level);
  const float once =
      static_cast<float>(domain_.width()) / side * static_cast<float>(domain_.height()) / side;
  const float fair = std::max(static_cast<float>(sites_.size), once);
  for (std::size_t c = 0; c < counts.size(); ++c) {
    const float mean = expected_[c] * fair;
    const float excess = mean > 0 ? static_cast<float>(counts[c]) / mean - 1 : 0;
    usage_.factor[c] = 1 + kUsage * std::max(0.0f, excess);
  }
}

std::size_t PlaceRelaxation::updateClass(std::size_t number, Monitor& monitor) {
  if (number % kCountEvery == 0) countUsage(monitor);
  const std::size_t first = order_.begin[number], count = order_.begin[number + 1] - first;
  chosen_.resize(count);
  const std::span<const Index> members(order_.ids.data() + first, count);
  const PlaceUpdate task = update();
  inChunks(monitor, count, [&](std::size_t begin, std::size_t end) {
    choosePlaces(task, members.subspan(begin, end - begin), chosen_.data() + begin);
  });
  inChunks(monitor, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) {
      if (places_[members[m]] == chosen_[m]) continue;
      places_[members[m]] = chosen_[m];
      looks_[members[m]] = appearance_.at(chosen_[m]);
    }
  });
  return count;
}

std::vector<float> PlaceRelaxation::errors(Monitor& monitor) const {
  std::vector<float> out(sites_.size);
  const PlaceUpdate task = update();
  inChunks(monitor, sites_.size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      out[i] = std::sqrt(placeError(task, static_cast<Index>(i))) / appearance_.unit;
  });
  return out;
}

}  // namespace dapple
