// The innermost loop of coordinate synthesis: which of the places that its neighbours predict a
// site takes (methods: 3.4, steps 4 to 6).
#pragma once

#include "synthesis/coordinate_sites.h"

namespace dapple {

// How much more often than others a part of the swatch is used: a factor of every error there.
struct UsageMap {
  int columns = 1, rows = 1;
  float toColumn = 0, toRow = 0;  // from place units
  std::vector<float> factor;      // columns x rows

  float at(Place place) const {
    const int column = static_cast<int>(static_cast<float>(place.x) * toColumn);
    const int row = static_cast<int>(static_cast<float>(place.y) * toRow);
    return factor[static_cast<std::size_t>(row) * columns + column];
  }
};

struct PlaceUpdate {
  const SiteLevel& sites;
  const AppearanceLevel& appearance;
  const PlaceDomain& domain;
  const UsageMap& usage;
  const Place* places;      // n
  const Appearance* looks;  // n: appearance.at(places)
  std::int32_t merge;       // predictions nearer than this are one, place units
};

// The places that `members` take, written to `chosen`: none of them is any other's input.
// `portable` keeps off SIMD (for tests: the result is the same).
void choosePlaces(const PlaceUpdate& update, std::span<const Index> members, Place* chosen,
                  bool portable = false);

// Mean squared difference per term of the place that a site has, appearance units.
float placeError(const PlaceUpdate& update, Index site);

}  // namespace dapple
