// Passes over the sites of a level that bring each to the place of the swatch that fits its
// neighbours best (methods: 3.4, steps 3 to 6). Sites on any surface, in any number: a few that are
// not frozen are relaxed the same way as all.
#pragma once

#include "base/monitor.h"
#include "regions/field_relaxation.h"
#include "synthesis/coordinate_kernels.h"

namespace dapple {

// Over a level: `quality` over the finest and more over coarser ones; over the first, which starts
// at random, more still.
int passesOver(int level, bool first, int quality);

class PlaceRelaxation {
 public:
  // All are kept by reference; `places` (n) are
  // contained in the domain. Throws Cancelled.
  PlaceRelaxation(const SiteLevel& sites, const AppearanceLevel& appearance,
                  const PlaceDomain& domain, std::vector<Place>& places, Monitor& monitor);

  std::size_t free() const { return order_.ids.size(); }  // sites that are not frozen

  // One class of the sites, all at the same time; a pass is all classes, one after the other.
  // Returns how many sites it had. The same places at any number of threads. Throws Cancelled;
  // then places are a mixture of before and after.
  static constexpr std::size_t kClasses = ClassOrder::kClasses;
  std::size_t updateClass(std::size_t number, Monitor& monitor);

  // Root mean square difference per term, 0..1 (n).
  std::vector<float> errors(Monitor& monitor) const;

 private:
  PlaceUpdate update() const;

  const SiteLevel& sites_;
  const AppearanceLevel& appearance_;
  const PlaceDomain& domain_;
  std::vector<Place>& places_;
  std::vector<Appearance> looks_;
  std::shared_ptr<const SimilarPlaces> similar_;  // null: the domain goes on
  ClassOrder order_;
  PlaceUsage usage_;
  DisplacementUsage displacements_;
  std::uint64_t round_ = 0;  // classes that were updated
  std::vector<Place> chosen_;
};

}  // namespace dapple
