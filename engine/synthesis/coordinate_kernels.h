// The innermost loop of coordinate synthesis: which of the places that its neighbours predict a
// site takes (methods: 3.4, steps 4 to 6).
#pragma once

#include "swatch/similar_places.h"
#include "synthesis/coordinate_sites.h"
#include "synthesis/displacement_usage.h"
#include "synthesis/place_usage.h"

namespace dapple {

struct PlaceUpdate {
  const SiteLevel& sites;
  const AppearanceLevel& appearance;
  const PlaceDomain& domain;
  const UsageMap& usage;
  const DisplacementUsage* displacements;  // null: they do not count
  const Place* places;                     // n
  const Appearance* looks;                 // n: appearance.at(places)
  // Where to go on from where a prediction leads out of a domain that does not; null: nowhere.
  const SimilarPlaces* similar;
  std::int32_t merge;   // predictions nearer than this are one, place units
  std::int32_t nearby;  // the mean of those nearer than this is tried, too; 0: none is
  // Random places that are tried where neighbours do not agree: anywhere, and so many pixels at
  // most around the best, along each axis.
  int probes = 0, probesAround = 0;
  std::int32_t around = 0;
  std::uint64_t round = 0;  // they are others in another one
};

// The places that `members` take, written to `chosen`: none of them is any other's input.
// `portable` keeps off SIMD (for tests: the result is the same).
void choosePlaces(const PlaceUpdate& update, std::span<const Index> members, Place* chosen,
                  bool portable = false);

// Mean squared difference per term of the places that the sites from `first` on have, appearance
// units; 0 where there are none.
void placeErrors(const PlaceUpdate& update, Index first, std::span<float> errors);

}  // namespace dapple
