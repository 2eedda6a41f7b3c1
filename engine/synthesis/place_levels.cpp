#include "synthesis/place_levels.h"

#include <algorithm>
#include <array>

#include "base/errors.h"
#include "synthesis/coordinate_relaxation.h"

namespace dapple {
namespace {

constexpr std::size_t kRun = 512;  // points that are visited at once

}  // namespace

PlaceLevels::PlaceLevels(const SynthesisInput& input, std::span<const SurfaceLevel> surface,
                         PlaceTask task)
    : input_(input),
      surface_(surface),
      task_(std::move(task)),
      domain_(PlaceDomain::continuing(input.swatch)),
      ways_(input),
      level_(surface.size()) {
  DAPPLE_CHECK(task_.start.size(), ==, input.points.size());
  if (!task_.open.empty()) DAPPLE_CHECK(task_.open.size(), ==, input.points.size());
}

// Places of level l, from site `first` on, from those of the next one.
void PlaceLevels::extend(std::size_t l, const std::vector<Place>& coarse, std::size_t first,
                         std::span<Place> out) const {
  const SurfaceLevel &fine = surface_[l], &above = surface_[l + 1];
  for (std::size_t s = 0; s < out.size(); ++s) {
    const Index parent = fine.parent[first + s];
    const Index to = pointAt(fine, first + s), from = pointAt(above, parent);
    out[s] = task_.start[to];
    if (!isOpen(to) || (!isOpen(from) && !task_.guessed)) continue;
    const vec2 way = from == to ? vec2(0) : ways_.between(from, to).pixels;
    out[s] = domain_.moved(coarse[parent], placeOf(way));
  }
}

std::vector<Place> PlaceLevels::extended(std::size_t l, const std::vector<Place>& coarse,
                                         Monitor& monitor) const {
  std::vector<Place> out(surface_[l].parent.size());
  forChunks(monitor, out.size(), [&](std::size_t begin, std::size_t end) {
    extend(l, coarse, begin, std::span(out).subspan(begin, end - begin));
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

void PlaceLevels::visitAll(const Visit& visit, Monitor& monitor) const {
  // The last step of the way down is made a run at a time: all points' places are not kept.
  std::vector<Place> coarse;
  for (std::size_t l = level_; l-- > 1;)
    coarse = extended(l, l + 1 == level_ ? places_ : coarse, monitor);
  const std::vector<Place>& above = level_ > 1 ? coarse : places_;
  forChunks(monitor, input_.points.size(), [&](std::size_t begin, std::size_t end) {
    if (level_ == 0) return visit(begin, std::span(places_).subspan(begin, end - begin));
    for (std::size_t first = begin; first < end; first += kRun) {
      std::array<Place, kRun> run;
      const std::span<Place> places(run.data(), std::min(kRun, end - first));
      extend(0, above, first, places);
      visit(first, places);
    }
  });
}

}  // namespace dapple
