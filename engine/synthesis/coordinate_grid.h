// Coordinates on a plane, or on a torus: an image of any size from a swatch, which tiles when it is
// a torus.
#pragma once

#include "base/monitor.h"
#include "synthesis/coordinate_sites.h"

namespace dapple {

struct CoordinateGrid {
  int width = 0, height = 0;  // pixels, at least 1
  bool torus = false;
};

// Of a torus's `size` columns or rows, the one that number i is. Hardly any lies outside, and
// dividing takes long.
inline int foldedIndex(int i, int size) {
  if (static_cast<unsigned>(i) < static_cast<unsigned>(size)) return i;
  return (i % size + size) % size;
}

// Sites about 2^level pixels apart, row by row, and what they need.
struct GridSites {
  int columns = 0, rows = 0;
  vec2 spacing{1};         // pixels
  std::vector<Index> ids;  // of sites.ids
  SiteLevel sites;

  std::size_t size() const { return static_cast<std::size_t>(columns) * rows; }
  vec2 position(std::size_t site) const;  // pixels
};
// `reach` as AppearanceLevel's.
GridSites gridSites(const CoordinateGrid& grid, int level, std::int32_t reach);

// Places of `fine` from those of the level above. Throws Cancelled.
std::vector<Place> extendedPlaces(const GridSites& fine, const GridSites& coarse,
                                  const PlaceDomain& domain, const std::vector<Place>& places,
                                  Monitor& monitor);

// To centres of texels: sites of level 0 are a pixel apart, so that pieces show texels, and no
// mixtures of them.
void snapToTexels(const PlaceDomain& domain, std::vector<Place>& places);

struct GridSynthesis {
  int quality = 4;  // passes over the finest level
  std::uint64_t seed = 1;
};

// The place that each pixel shows, width x height, top row first. Progress counts pixels. The same
// at any number of threads. Throws InvalidInput when the swatch has nothing to be read between
// texels; Cancelled.
std::vector<Place> synthesizeGrid(const Swatch& swatch, const CoordinateGrid& grid,
                                  const GridSynthesis& options, Monitor& monitor);

}  // namespace dapple
