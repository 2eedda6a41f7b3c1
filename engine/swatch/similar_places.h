// Where else a swatch looks the same: places that a piece can go on from where it runs out of the
// swatch.
#pragma once

#include "swatch/appearance.h"

namespace dapple {

// One other place for each step of a level, some way off and with room around it. Empty when the
// swatch has too many steps to compare all with all: then that was done on a coarser level.
class SimilarPlaces {
 public:
  SimilarPlaces() = default;
  // Throws Cancelled.
  SimilarPlaces(const AppearanceLevel& appearance, const PlaceDomain& domain, Monitor& monitor);

  std::size_t bytes() const { return best_.size() * sizeof(Place); }
  bool empty() const { return best_.empty(); }
  // Of a contained place; may not be contained.
  Place of(Place place) const {
    const std::int32_t x = place.x >> shift_, y = place.y >> shift_;
    const Place other = best_[static_cast<std::size_t>(y) * columns_ + x];
    return {other.x + place.x - (x << shift_), other.y + place.y - (y << shift_)};
  }

 private:
  int shift_ = 0;  // place >> shift: step
  std::int32_t columns_ = 0, rows_ = 0;
  std::vector<Place> best_;  // by step: the corner of another one
};

// Those of a level of the domain's swatch, kept with the level. Throws Cancelled.
std::shared_ptr<const SimilarPlaces> similarPlacesOf(const AppearanceLevel& appearance,
                                                     const PlaceDomain& domain, Monitor& monitor);

}  // namespace dapple
