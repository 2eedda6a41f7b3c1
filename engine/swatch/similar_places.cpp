// K-coherence with one candidate (Tong et al. 2002), compared exhaustively where steps are few.
#include "swatch/similar_places.h"

#include <algorithm>
#include <cstdlib>

namespace dapple {
namespace {

constexpr std::size_t kMostSteps = 2048;
constexpr std::size_t kGrain = 32;
constexpr int kApartShare = 10;  // of the swatch's smaller side: least distance to the other place
constexpr int kRoomSteps = 2;    // around it, inside the swatch

}  // namespace

SimilarPlaces::SimilarPlaces(const AppearanceLevel& appearance, const PlaceDomain& domain,
                             Monitor& monitor)
    : shift_(kPlaceBits + appearance.level) {
  columns_ = ((domain.width() - 1) >> shift_) + 1;
  rows_ = ((domain.height() - 1) >> shift_) + 1;
  const std::size_t count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  if (count > kMostSteps) return;
  const auto middleOf = [&](std::size_t step) {
    const auto x = static_cast<std::int32_t>(step % static_cast<std::size_t>(columns_));
    const auto y = static_cast<std::int32_t>(step / static_cast<std::size_t>(columns_));
    const std::int32_t half = (1 << shift_) / 2;
    return Place{(x << shift_) + half, (y << shift_) + half};
  };
  std::vector<std::size_t> roomy;
  const std::int32_t room = kRoomSteps << shift_;
  for (std::size_t step = 0; step < count; ++step) {
    const Place p = middleOf(step);
    const Place around[] = {
        {p.x - room, p.y}, {p.x + room, p.y}, {p.x, p.y - room}, {p.x, p.y + room}, p};
    if (std::all_of(std::begin(around), std::end(around),
                    [&](Place place) { return domain.contains(place); }))
      roomy.push_back(step);
  }
  if (roomy.empty()) return;
  best_.resize(count);
  const std::int32_t apart = std::min(domain.width(), domain.height()) / kApartShare;
  parallelFor(monitor, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t step = begin; step < end; ++step) {
      const Place own = middleOf(step);
      std::int32_t least = std::numeric_limits<std::int32_t>::max();
      Place best = middleOf(roomy.front());
      for (const std::size_t other : roomy) {
        const Place there = middleOf(other);
        if (std::max(std::abs(there.x - own.x), std::abs(there.y - own.y)) < apart) continue;
        const std::int32_t error = appearanceDistance(appearance.at(own), appearance.at(there));
        if (error < least) least = error, best = there;
      }
      const std::int32_t half = (1 << shift_) / 2;
      best_[step] = {best.x - half, best.y - half};
    }
  });
}

std::shared_ptr<const SimilarPlaces> similarPlacesOf(const AppearanceLevel& appearance,
                                                     const PlaceDomain& domain, Monitor& monitor) {
  return appearance.tables.get<SimilarPlaces>(
      0, [&] { return SimilarPlaces(appearance, domain, monitor); });
}

}  // namespace dapple
