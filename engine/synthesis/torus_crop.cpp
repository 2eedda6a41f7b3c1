// The overlap of Efros, Freeman, "Image quilting" (2001), of a swatch with itself. Departure: where
// sides meet, no cut is looked for; coordinates (methods: 3.4) are relaxed there beside those of
// the swatch, which stay.
#include "synthesis/torus_crop.h"

#include <algorithm>
#include <limits>

#include "base/errors.h"
#include "synthesis/coordinate_relaxation.h"

namespace dapple {
namespace {

// Pixels to both sides of where sides meet that are synthesized.
constexpr int kBand = 10;
constexpr int kBandsPerSide = 8;  // at least
constexpr int kCompared = 4;      // pixels to both sides that are compared
constexpr int kLeast = 16;        // pixels: sides of the smallest part
constexpr int kCoarsest = 3;      // level that the band is relaxed from

struct Stretch {
  int begin, size;  // pixels
};

// The sum across an axis of squared differences between pixels `period` apart along it, by the
// first one's number.
std::vector<double> differencesAlong(const Swatch& swatch, int axis, int period) {
  const int along = axis == 0 ? swatch.width : swatch.height;
  const int across = axis == 0 ? swatch.height : swatch.width;
  const std::size_t step = axis == 0 ? 1 : swatch.width, row = axis == 0 ? swatch.width : 1;
  std::vector<double> out(static_cast<std::size_t>(along - period), 0);
  for (int a = 0; a < across; ++a)
    for (std::size_t i = 0; i < out.size(); ++i) {
      const std::size_t at = static_cast<std::size_t>(a) * row + i * step;
      const vec3 d =
          swatch.colours()[at + static_cast<std::size_t>(period) * step] - swatch.colours()[at];
      out[i] += glm::dot(d, d);
    }
  return out;
}

// Where along an axis the swatch continues best with itself.
Stretch bestStretch(const Swatch& swatch, int axis, const Monitor& monitor) {
  const int size = axis == 0 ? swatch.width : swatch.height;
  const int most = size - 2 * kCompared, least = std::max(kLeast, (size + 1) / 2);
  Stretch best{0, size};
  double cheapest = std::numeric_limits<double>::infinity();
  for (int period = most; period >= least; --period) {
    monitor.checkpoint();
    const std::vector<double> difference = differencesAlong(swatch, axis, period);
    double sum = 0;
    for (int i = 0; i < 2 * kCompared; ++i) sum += difference[i];
    for (int begin = 0;; ++begin) {
      // What is off shows once in each period.
      const double cost = sum / period;
      if (cost < cheapest) cheapest = cost, best = {begin + kCompared, period};
      if (begin + 2 * kCompared == static_cast<int>(difference.size())) break;
      sum += difference[begin + 2 * kCompared] - difference[begin];
    }
  }
  return best;
}

bool inBand(float at, int size) {
  const int band = std::min(kBand, size / kBandsPerSide);
  return std::min(at, static_cast<float>(size) - at) < static_cast<float>(band);
}

}  // namespace

TorusCrop bestTorusCrop(const Swatch& swatch, const Monitor& monitor) {
  const Stretch x = bestStretch(swatch, 0, monitor), y = bestStretch(swatch, 1, monitor);
  return {x.begin, y.begin, x.size, y.size};
}

std::vector<Place> closedTorus(const Swatch& swatch, const TorusCrop& crop, int quality,
                               Monitor& monitor) {
  DAPPLE_CHECK(crop.x + crop.width, <=, swatch.width);
  DAPPLE_CHECK(crop.y + crop.height, <=, swatch.height);
  const PlaceDomain domain = PlaceDomain::continuing(swatch);
  const CoordinateGrid grid{crop.width, crop.height, true};
  std::vector<Place> places;
  GridSites coarse;
  for (int level = kCoarsest; level >= 0; --level) {
    GridSites fine = gridSites(grid, level, appearanceReach(swatch, level));
    std::vector<Place> own(fine.size());
    fine.sites.frozen.assign(fine.size(), 1);
    for (std::size_t i = 0; i < own.size(); ++i) {
      const vec2 at = fine.position(i);
      own[i] = placeOf(at + vec2(crop.x, crop.y));
      if (inBand(at.x, crop.width) || inBand(at.y, crop.height)) fine.sites.frozen[i] = 0;
    }
    if (level < kCoarsest) {
      const std::vector<Place> from = extendedPlaces(fine, coarse, domain, places, monitor);
      for (std::size_t i = 0; i < own.size(); ++i)
        if (!fine.sites.frozen[i]) own[i] = from[i];
    }
    places = std::move(own);
    if (level == 0) snapToTexels(domain, places);
    const auto appearance = appearanceOf(swatch, level, false, monitor);
    PlaceRelaxation relaxation(fine.sites, *appearance, domain, places, monitor);
    for (int pass = passesOver(level, level == kCoarsest, quality); pass-- > 0;)
      for (std::size_t c = 0; c < PlaceRelaxation::kClasses; ++c)
        relaxation.updateClass(c, monitor);
    coarse = std::move(fine);
    coarse.sites.ids = coarse.ids;
  }
  return places;
}

}  // namespace dapple
