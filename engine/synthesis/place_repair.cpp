#include "synthesis/place_repair.h"

#include <algorithm>

#include "base/errors.h"
#include "synthesis/coordinate_relaxation.h"

namespace dapple {
namespace {

constexpr int kCoarsest = 3;  // level that relaxation begins on
constexpr int kPasses = 2;    // over level 0

class Repair {
 public:
  Repair(const SynthesisInput& input, std::span<const SurfaceLevel> surface,
         std::span<const std::uint8_t> open, const std::vector<Place>& start)
      : in_(input),
        surface_(surface),
        open_(open),
        start_(start),
        domain_(input.swatch),
        ways_(input) {}

  std::vector<Place> run(Monitor& monitor) {
    std::size_t l = surface_.size() - 1;
    while (l > 0 && surface_[l].level > kCoarsest) --l;
    for (std::size_t s = 0; s < sizeOf(l); ++s) places_.push_back(start_[pointAt(surface_[l], s)]);
    for (;; --l) {
      if (surface_[l].level >= 0) relax(l, monitor);
      if (l == 0) return std::move(places_);
      places_ = extended(l - 1, monitor);
    }
  }

 private:
  std::size_t sizeOf(std::size_t l) const { return nearOf(surface_[l], in_).size(); }

  void relax(std::size_t l, Monitor& monitor) {
    const AppearanceLevel appearance = makeAppearance(in_.swatch, surface_[l].level, true, monitor);
    SiteLevel sites = ways_.sitesOf(surface_[l], appearance.reach, monitor);
    sites.frozen.resize(sites.size, 0);
    for (std::size_t s = 0; s < sites.size; ++s)
      if (!open_[pointAt(surface_[l], s)]) sites.frozen[s] = 1;
    PlaceRelaxation relaxation(sites, appearance, domain_, places_, monitor);
    const int passes = passesOver(surface_[l].level, false, kPasses);
    for (int pass = 0; pass < passes; ++pass)
      for (std::size_t c = 0; c < PlaceRelaxation::kClasses; ++c)
        relaxation.updateClass(c, monitor);
  }

  // Of level l: open points as an open ancestor has it, all others as they were.
  std::vector<Place> extended(std::size_t l, Monitor& monitor) const {
    const SurfaceLevel &fine = surface_[l], &above = surface_[l + 1];
    std::vector<Place> out(sizeOf(l));
    forChunks(monitor, out.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        const Index to = pointAt(fine, s), from = pointAt(above, fine.parent[s]);
        out[s] = start_[to];
        if (!open_[to] || !open_[from]) continue;
        const vec2 way = from == to ? vec2(0) : ways_.between(from, to).pixels * kPlaceScale;
        out[s] = domain_.moved(places_[fine.parent[s]], {static_cast<std::int32_t>(way.x),
                                                         static_cast<std::int32_t>(way.y)});
      }
    });
    return out;
  }

  const SynthesisInput& in_;
  std::span<const SurfaceLevel> surface_;
  std::span<const std::uint8_t> open_;
  const std::vector<Place>& start_;
  PlaceDomain domain_;
  SurfaceWays ways_;
  std::vector<Place> places_;
};

}  // namespace

void repairPlaces(const SynthesisInput& input, std::span<const SurfaceLevel> surface,
                  std::span<const std::uint8_t> open, std::vector<Place>& places,
                  Monitor& monitor) {
  DAPPLE_CHECK(open.size(), ==, input.points.size());
  DAPPLE_CHECK(places.size(), ==, input.points.size());
  places = Repair(input, surface, open, places).run(monitor);
}

}  // namespace dapple
