// Methods, section 7.2, step 4: the plane is a surface whose neighbours are known.
#include "synthesis/coordinate_grid.h"

#include <algorithm>
#include <array>

#include "base/errors.h"
#include "synthesis/coordinate_relaxation.h"

namespace dapple {
namespace {

constexpr int kFewest = 4;  // columns and rows of a level: fewer would be their own neighbours
constexpr std::size_t kGrain = 4096;

// Sixteen around a site, the nearest first.
constexpr std::array<ivec2, kMostNear> kStencil = {
    ivec2{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1},
    ivec2{2, 0}, {-2, 0}, {0, 2}, {0, -2}, {2, 2}, {-2, -2}, {2, -2}, {-2, 2}};

int countAlong(int size, int level) {
  return std::max(1, (size + (1 << level) / 2) >> level);
}

int levelsOf(const Swatch& swatch, const CoordinateGrid& grid) {
  int levels = appearanceLevels(swatch);
  while (levels > 1 && std::min(countAlong(grid.width, levels - 1),
                                countAlong(grid.height, levels - 1)) < kFewest)
    --levels;
  return levels;
}

}  // namespace

vec2 GridSites::position(std::size_t site) const {
  const std::size_t across = static_cast<std::size_t>(columns);
  return (vec2(site % across, site / across) + 0.5f) * spacing;
}

GridSites gridSites(const CoordinateGrid& grid, int level, std::int32_t reach) {
  GridSites out{.columns = countAlong(grid.width, level), .rows = countAlong(grid.height, level)};
  out.spacing = vec2(grid.width, grid.height) / vec2(out.columns, out.rows);
  std::array<Way, kMostNear> ways;
  const WayScale toWay(level, reach);
  for (std::size_t a = 0; a < kMostNear; ++a) ways[a] = toWay(vec2(kStencil[a]) * out.spacing, 0);
  out.ids.resize(out.size() * kMostNear);
  out.sites = {.level = level, .size = out.size(), .k = kMostNear, .stride = kMostNear};
  out.sites.ways.resize(out.ids.size());
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.columns; ++x)
      for (std::size_t a = 0; a < kMostNear; ++a) {
        const int column = x + kStencil[a].x, row = y + kStencil[a].y;
        const bool inside = column >= 0 && column < out.columns && row >= 0 && row < out.rows;
        const std::size_t at = (static_cast<std::size_t>(y) * out.columns + x) * kMostNear + a;
        out.ids[at] = static_cast<Index>(foldedIndex(row, out.rows) * out.columns +
                                         foldedIndex(column, out.columns));
        out.sites.ways[at] = inside || grid.torus ? ways[a] : Way{kNoWay, 0};
      }
  out.sites.ids = out.ids;
  for (std::size_t i = 0; i < out.size(); ++i)
    out.sites.positions.push_back(placeOf(out.position(i)));
  return out;
}

std::vector<Place> extendedPlaces(const GridSites& fine, const GridSites& coarse,
                                  const PlaceDomain& domain, const std::vector<Place>& places,
                                  Monitor& monitor) {
  std::vector<Place> out(fine.size());
  parallelFor(monitor, out.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const vec2 at = fine.position(i);
      const int x = std::min(static_cast<int>(at.x / coarse.spacing.x), coarse.columns - 1);
      const int y = std::min(static_cast<int>(at.y / coarse.spacing.y), coarse.rows - 1);
      const std::size_t parent = static_cast<std::size_t>(y) * coarse.columns + x;
      const vec2 way = glm::round((at - coarse.position(parent)) * kPlaceScale);
      out[i] = domain.moved(places[parent],
                            {static_cast<std::int32_t>(way.x), static_cast<std::int32_t>(way.y)});
    }
  });
  return out;
}

void snapToTexels(const PlaceDomain& domain, std::vector<Place>& places) {
  constexpr std::int32_t kHalf = 1 << (kPlaceBits - 1);
  const auto centre = [](std::int32_t at) {
    return (((at - kHalf) >> kPlaceBits) << kPlaceBits) + kHalf;
  };
  for (Place& place : places) place = domain.wrapped({centre(place.x), centre(place.y)});
}

std::vector<Place> synthesizeGrid(const Swatch& swatch, const CoordinateGrid& grid,
                                  const GridSynthesis& options, Monitor& monitor) {
  DAPPLE_CHECK(std::min(grid.width, grid.height), >=, 1);
  // One that does not go on beyond the swatch's sides: on a plane the same way, taken again and
  // again, shows as a repeat. Of 11 samples 9 are as good as other programs' (dapple_plane_bench),
  // 5 with one that does.
  const PlaceDomain domain(swatch);
  if (domain.empty())
    throw InvalidInput(
        "the swatch has no four opaque pixels that meet; choose one with larger opaque parts");
  const std::size_t pixels = static_cast<std::size_t>(grid.width) * grid.height;
  const int levels = levelsOf(swatch, grid);
  monitor.begin(Stage::Synthesis, pixels, static_cast<std::size_t>(options.quality));
  std::vector<Place> places;
  GridSites coarse;
  for (int level = levels - 1; level >= 0; --level) {
    const bool first = level == levels - 1;
    GridSites fine = gridSites(grid, level, appearanceReach(swatch, level));
    if (first) {
      places.resize(fine.size());
      for (std::size_t i = 0; i < places.size(); ++i) places[i] = domain.random(options.seed, i, 1);
    } else {
      places = extendedPlaces(fine, coarse, domain, places, monitor);
    }
    if (level == 0) snapToTexels(domain, places);
    const auto appearance = appearanceOf(swatch, level, false, monitor);
    PlaceRelaxation relaxation(fine.sites, *appearance, domain, places, monitor);
    const int passes = passesOver(level, first, options.quality);
    for (int pass = 0; pass < passes; ++pass)
      for (std::size_t c = 0; c < PlaceRelaxation::kClasses; ++c) {
        const std::size_t updated = relaxation.updateClass(c, monitor);
        if (level == 0 && pass < options.quality) monitor.advance(updated);
      }
    coarse = std::move(fine);
    coarse.sites.ids = coarse.ids;
  }
  return places;
}

}  // namespace dapple
