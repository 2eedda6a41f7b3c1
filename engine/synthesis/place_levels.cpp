#include "synthesis/place_levels.h"

#include "base/errors.h"
#include "synthesis/coordinate_relaxation.h"

namespace dapple {

PlaceLevels::PlaceLevels(const SynthesisInput& input, std::span<const SurfaceLevel> surface,
                         PlaceTask task)
    : input_(input),
      surface_(surface),
      task_(std::move(task)),
      domain_(input.swatch),
      ways_(input),
      level_(surface.size()) {
  DAPPLE_CHECK(task_.start.size(), ==, input.points.size());
  if (!task_.open.empty()) DAPPLE_CHECK(task_.open.size(), ==, input.points.size());
}

// Places of level l from those of the next one.
std::vector<Place> PlaceLevels::extended(std::size_t l, const std::vector<Place>& coarse,
                                         Monitor& monitor) const {
  const SurfaceLevel &fine = surface_[l], &above = surface_[l + 1];
  std::vector<Place> out(fine.parent.size());
  forChunks(monitor, out.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Index parent = fine.parent[s];
      const Index to = pointAt(fine, s), from = pointAt(above, parent);
      out[s] = task_.start[to];
      if (!isOpen(to) || (!isOpen(from) && !task_.guessed)) continue;
      const vec2 way = from == to ? vec2(0) : ways_.between(from, to).pixels;
      out[s] = domain_.moved(coarse[parent], placeOf(way));
    }
  });
  return out;
}

void PlaceLevels::enter(std::size_t l, Monitor& monitor) {
  DAPPLE_CHECK(l + 1, ==, level_);
  level_ = l;
  if (l + 1 < surface_.size()) {
    places_ = extended(l, places_, monitor);
    return;
  }
  const std::vector<Index>& points = surface_[l].points;
  places_ = task_.start;
  for (std::size_t s = 0; s < points.size(); ++s) places_[s] = task_.start[points[s]];
  if (!points.empty()) places_.resize(points.size());
}

void PlaceLevels::relax(int passes, const std::function<void()>& afterClass,
                        std::vector<float>* errors, Monitor& monitor) {
  const SurfaceLevel& surface = surface_[level_];
  const SiteLevel sites =
      ways_.sitesOf(surface, appearanceReach(input_.swatch, surface.level), task_.open, monitor);
  const auto appearance = appearanceOf(input_.swatch, surface.level, sites.turned, monitor);
  PlaceRelaxation relaxation(sites, *appearance, domain_, places_, monitor);
  for (int pass = 0; pass < passes; ++pass)
    for (std::size_t c = 0; c < PlaceRelaxation::kClasses; ++c) {
      relaxation.updateClass(c, monitor);
      afterClass();
    }
  if (errors) *errors = relaxation.errors(monitor);
}

std::vector<Place> PlaceLevels::placesOfAll(Monitor& monitor) const {
  std::vector<Place> places = places_;
  for (std::size_t l = level_; l-- > 0;) places = extended(l, places, monitor);
  return places;
}

}  // namespace dapple
