// How often coordinate synthesis shows each part of a swatch, and everything that looks alike in
// it.
#pragma once

#include <span>

#include "swatch/appearance.h"

namespace dapple {

// How much more often than others a part of the swatch is used: a factor of every error there.
struct UsageMap {
  int shift = 31;            // place >> shift: column or row
  std::int32_t columns = 1;  // of a row
  std::vector<float> factor;

  std::size_t cellOf(Place place) const {
    return static_cast<std::size_t>(place.y >> shift) * columns + (place.x >> shift);
  }
  float at(Place place) const { return factor[cellOf(place)]; }
};

class PlaceUsage {
 public:
  // For a level of so many sites: the more of them there are, the finer are the parts.
  PlaceUsage(const PlaceDomain& domain, const AppearanceLevel& appearance, std::size_t sites);

  // The factors for what `places` show. The same at any number of threads. Throws Cancelled.
  void count(std::span<const Place> places, Monitor& monitor);

  const UsageMap& map() const { return map_; }

 private:
  // Cells in groups that should be used as their share of all cells that may be used says.
  struct Grouping {
    std::vector<std::uint8_t> group;  // by cell
    std::vector<float> share;         // by group

    std::size_t bytes() const { return group.size() + share.size() * sizeof(float); }
  };
  Grouping byPosition(const PlaceDomain& domain, std::size_t sites) const;
  Grouping byLook(const AppearanceLevel& appearance, std::size_t sites) const;
  void setShares(Grouping& grouping, std::size_t groups) const;

  UsageMap map_;
  std::vector<Place> middles_;      // of the cells that may be used
  std::vector<std::size_t> cells_;  // their numbers
  Grouping positions_, looks_;
  float atLeast_;  // sites that show all of the swatch once
};

}  // namespace dapple
