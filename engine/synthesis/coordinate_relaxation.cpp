#include "synthesis/coordinate_relaxation.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 256;
constexpr std::size_t kCountEvery = 2;  // classes between two counts of usage
// Of a step. Mean F of 7 swatches on the bunny with 0.3, 0.1 and 0.05 on all levels: 0.49, 0.53,
// 0.56; the finer ones need not be as fine.
constexpr float mergeSteps(int level) {
  return level == 0 ? 0.15f : level == 1 ? 0.2f : 0.05f;
}
// Random places that a plane's sites try where its neighbours do not agree: without, a swatch that
// tiles keeps the few displacements that it began with. More of them are tried around the best
// place: mean 95th percentile of distances to the nearest patch of the sample, over that of the
// worse of two other programs, four samples and four seeds without, 1.20; with eight, 1.14.
constexpr int probesOf(int level) {
  return level == 1 ? 2 : level == 2 ? 4 : 0;
}
constexpr int probesAroundOf(int level) {
  return level == 1 || level == 2 ? 8 : 0;
}
constexpr int kAroundSteps = 8;
constexpr int kPassesPerLevel = 3, kFirstPasses = 20;
// Of a step: predictions whose mean is tried. Mean F of eight swatches on the bunny of 85,000
// points without, with 0.5, 1, 2 and 3: 0.583, 0.592, 0.612, 0.615, 0.610.
constexpr int kNearbySteps = 2;

template <class Body>
void inChunks(Monitor& monitor, std::size_t count, const Body& body) {
  if (count > kGrain) return parallelFor(monitor, count, kGrain, body);
  monitor.checkpoint();
  if (count > 0) body(std::size_t{0}, count);
}

}  // namespace

int passesOver(int level, bool first, int quality) {
  return quality + std::max(0, kPassesPerLevel * level - 1) + (first ? kFirstPasses : 0);
}

PlaceRelaxation::PlaceRelaxation(const SiteLevel& sites, const AppearanceLevel& appearance,
                                 const PlaceDomain& domain, std::vector<Place>& places,
                                 Monitor& monitor)
    : sites_(sites),
      appearance_(appearance),
      domain_(domain),
      places_(places),
      looks_(sites.size),
      usage_(domain, appearance, sites.size),
      displacements_(sites, domain) {
  DAPPLE_CHECK(sites.k, <=, kMostNear);
  DAPPLE_CHECK(places.size(), ==, sites.size);
  if (!domain.continues()) similar_ = similarPlacesOf(appearance, domain, monitor);
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
      .usage = usage_.map(),
      .displacements = displacements_.empty() ? nullptr : &displacements_,
      .places = places_.data(),
      .looks = looks_.data(),
      .similar = similar_ && !similar_->empty() ? similar_.get() : nullptr,
      .merge = static_cast<std::int32_t>(
          std::ldexp(mergeSteps(sites_.level) * kPlaceScale, sites_.level)),
      .nearby = sites_.plane() ? 0 : kNearbySteps << (kPlaceBits + sites_.level),
      .probes = sites_.plane() ? probesOf(sites_.level) : 0,
      .probesAround = sites_.plane() ? probesAroundOf(sites_.level) : 0,
      .around = kAroundSteps << sites_.level,
      .round = round_,
  };
}

std::size_t PlaceRelaxation::updateClass(std::size_t number, Monitor& monitor) {
  ++round_;
  if (number % kCountEvery == 0) {
    usage_.count(places_, monitor);
    if (!displacements_.empty()) displacements_.count(places_, monitor);
  }
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
    placeErrors(task, static_cast<Index>(begin), std::span(out).subspan(begin, end - begin));
    for (std::size_t i = begin; i < end; ++i) out[i] = std::sqrt(out[i]) / appearance_.unit;
  });
  return out;
}

}  // namespace dapple
