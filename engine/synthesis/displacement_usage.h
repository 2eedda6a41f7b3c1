// How far the pieces of a swatch are moved on their way to a picture, and how much of the picture
// each such displacement makes up: large pieces, and pieces that are moved alike, show as a period.
#pragma once

#include "synthesis/coordinate_sites.h"

namespace dapple {

class DisplacementUsage {
 public:
  DisplacementUsage() = default;  // empty
  // Empty where sites are not a plane's, and where they are too few to show anything twice. `sites`
  // are kept by reference.
  DisplacementUsage(const SiteLevel& sites, const PlaceDomain& domain);

  bool empty() const { return sites_ == nullptr; }

  // The factors for what `places` (n) show. The same at any number of threads. Throws Cancelled.
  void count(std::span<const Place> places, Monitor& monitor);

  // How much more than it may a displacement is used: a factor of the error of a site at a
  // contained place. At least 1.
  float at(std::size_t site, Place place) const { return factor_[cellOf(site, place)]; }

 private:
  // Hashed: displacements are many, those in use few.
  std::size_t cellOf(std::size_t site, Place place) const {
    const Place from = sites_->positions[site];
    Place way{place.x - from.x, place.y - from.y};
    if (wrapped_) {
      way.x %= width_, way.y %= height_;
      way.x += way.x < 0 ? width_ : 0, way.y += way.y < 0 ? height_ : 0;
    }
    const std::uint32_t hash = static_cast<std::uint32_t>(way.x >> shift_) * 0x9e3779b1u ^
                               static_cast<std::uint32_t>(way.y >> shift_) * 0x85ebca6bu;
    return (hash * 0xc2b2ae35u) >> (32 - bits_);
  }

  const SiteLevel* sites_ = nullptr;
  bool wrapped_ = false;  // displacements of whole swatches are none
  std::int32_t width_ = 0, height_ = 0;
  int shift_ = 0;              // displacement >> shift: those that count as one
  int bits_ = 0;               // of a cell's number
  float most_ = 1;             // sites of a displacement that cost nothing
  std::vector<float> factor_;  // by cell
};

}  // namespace dapple
