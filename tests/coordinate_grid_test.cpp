#include "synthesis/coordinate_grid.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "base/hash_rng.h"
#include "fixtures.h"
#include "synthesis/displacement_usage.h"
#include "synthesis/grid_blend.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

constexpr std::int32_t kPixel = 1 << kPlaceBits;

// Of a pixel's place from the pixel, in pixels; within the swatch when that tiles.
std::pair<int, int> displacement(const Swatch& swatch, std::span<const Place> places, int width,
                                 std::size_t pixel) {
  const auto across = static_cast<std::size_t>(width);
  const Place place = places[pixel];
  int x = place.x / kPixel - static_cast<int>(pixel % across);
  int y = place.y / kPixel - static_cast<int>(pixel / across);
  if (swatch.tileable) {
    x = ((x % swatch.width) + swatch.width) % swatch.width;
    y = ((y % swatch.height) + swatch.height) % swatch.height;
  }
  return {x, y};
}

// Pixels that the commonest displacement has.
std::size_t mostMovedAlike(const Swatch& swatch, std::span<const Place> places, int width) {
  std::map<std::pair<int, int>, std::size_t> counts;
  for (std::size_t i = 0; i < places.size(); ++i) ++counts[displacement(swatch, places, width, i)];
  std::size_t most = 0;
  for (const auto& [way, count] : counts) most = std::max(most, count);
  return most;
}

// The left half of a picture copies the swatch from (0, 0) on, the right half from (3, 5) on.
std::vector<Place> twoPieces(const CoordinateGrid& grid) {
  std::vector<Place> places;
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const int moved = x < grid.width / 2 ? 0 : 1;
      places.push_back(
          {(x + 3 * moved) * kPixel + kPixel / 2, (y + 5 * moved) * kPixel + kPixel / 2});
    }
  return places;
}

}  // namespace

TEST_CASE("a torus is seamless and a plane is not wrapped") {
  Workers workers(1);
  Monitor monitor(workers);
  const Swatch swatch = swatchOf(noise(40), Tileable::No);
  const PlaceDomain domain(swatch);
  for (const bool torus : {false, true}) {
    const auto places = synthesizeGrid(swatch, {60, 52, torus}, {}, monitor);
    REQUIRE(places.size() == 60 * 52);
    for (const Place& place : places) REQUIRE(domain.contains(place));
    const auto colour = [&](int x, int y) {
      return sampleSwatch(swatch, texelOf(places[static_cast<std::size_t>(y) * 60 + x]));
    };
    double across = 0, inside = 0;
    for (int y = 0; y < 52; ++y) {
      across += static_cast<double>(glm::distance(colour(59, y), colour(0, y)));
      for (int x = 1; x < 60; ++x)
        inside += static_cast<double>(glm::distance(colour(x - 1, y), colour(x, y))) / 59;
    }
    CHECK((across < 1.5 * inside) == torus);
  }
}

TEST_CASE("planes show whole texels, inside the swatch") {
  Workers workers(1);
  Monitor monitor(workers);
  constexpr std::int32_t kPixel = 1 << kPlaceBits;
  for (const Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = swatchOf(noise(24), tileable);
    const PlaceDomain domain(swatch);
    for (const std::uint64_t seed : {1, 2, 3})
      for (const Place& place : synthesizeGrid(swatch, {50, 40, false}, {.seed = seed}, monitor)) {
        REQUIRE(domain.contains(place));
        REQUIRE(std::min(place.x, place.y) >= 0);
        REQUIRE(std::max(place.x, place.y) < 24 * kPixel);
        REQUIRE(place.x % kPixel == kPixel / 2);
        REQUIRE(place.y % kPixel == kPixel / 2);
      }
  }
}

TEST_CASE("no displacement makes up much of a picture") {
  Workers workers(2);
  Monitor monitor(workers);
  constexpr int kSwatch = 48, kSize = 144;
  for (const Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = swatchOf(noise(kSwatch), tileable);
    for (const std::uint64_t seed : {1, 2}) {
      const auto places = synthesizeGrid(swatch, {kSize, kSize, false}, {.seed = seed}, monitor);
      CAPTURE(seed);
      CAPTURE(static_cast<int>(tileable));
      // Of the swatch's area. Where displacements do not count: 0.9 and, when it tiles, 4 to 6.
      CHECK(static_cast<double>(mostMovedAlike(swatch, places, kSize)) < 0.65 * kSwatch * kSwatch);
    }
  }
}

TEST_CASE("displacements are counted, and whole tiles of a swatch are none") {
  Workers workers(2);
  Monitor monitor(workers);
  constexpr int kSwatch = 40, kSize = 120;
  for (const Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = swatchOf(noise(kSwatch), tileable);
    const PlaceDomain domain(swatch);
    const GridSites grid = gridSites({kSize, kSize, false}, 0, appearanceReach(swatch, 0));
    DisplacementUsage usage(grid.sites, domain);
    REQUIRE(!usage.empty());
    // The swatch, nine times side by side.
    std::vector<Place> places;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const auto x = static_cast<std::int32_t>(i % kSize), y = static_cast<std::int32_t>(i / kSize);
      places.push_back({x % kSwatch * kPixel + kPixel / 2, y % kSwatch * kPixel + kPixel / 2});
    }
    usage.count(places, monitor);
    const float all = tileable == Tileable::Yes ? 9 : 1;  // times the swatch's area
    for (const std::size_t site : {0, 41, 4242})
      CHECK(usage.at(site, places[site]) == doctest::Approx(all / 0.45f));
    // Elsewhere nothing is moved by so much.
    CHECK(usage.at(0, {20 * kPixel, 11 * kPixel}) == 1);
  }
}

TEST_CASE("displacements of what shows nothing twice do not count") {
  const Swatch swatch = swatchOf(noise(40));
  const PlaceDomain domain(swatch);
  for (const int level : {0, 2}) {
    const auto counted = [&](int size) {
      const GridSites grid = gridSites({size, size, true}, level, appearanceReach(swatch, level));
      return !DisplacementUsage(grid.sites, domain).empty();
    };
    CHECK(!counted(40));
    CHECK(counted(48));
  }
  GridSites grid = gridSites({80, 80, true}, 0, appearanceReach(swatch, 0));
  grid.sites.positions.clear();  // as on a surface
  CHECK(DisplacementUsage(grid.sites, domain).empty());
}

TEST_CASE("a picture shows its pieces as they are and mixes them where they meet") {
  Workers workers(2);
  Monitor monitor(workers);
  const Swatch swatch = swatchOf(noise(40), Tileable::No);
  const CoordinateGrid grid{.width = 24, .height = 16};
  const std::vector<Place> places = twoPieces(grid);
  const Image image = blendedImage(swatch, grid, places, monitor);
  REQUIRE(image.pixels.size() == places.size() * 3);
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const vec2 pixel(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const vec3 left = sampleSwatch(swatch, pixel),
                 right = sampleSwatch(swatch, pixel + vec2(3, 5));
      const vec3 shown(image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2));
      if (x < 10) REQUIRE(shown == left);
      if (x >= 14) REQUIRE(shown == right);
      // The share of the right piece: of the Gaussian's columns, those beyond the border.
      const float shares[] = {0.0545f, 0.2987f, 0.7013f, 0.9455f};
      if (x >= 10 && x < 14)
        REQUIRE(glm::distance(shown, glm::mix(left, right, shares[x - 10])) < 1e-3f);
    }
}

TEST_CASE("a torus is mixed across its border") {
  Workers workers(1);
  Monitor monitor(workers);
  const Swatch swatch = swatchOf(noise(40), Tileable::No);
  for (const bool torus : {false, true}) {
    const CoordinateGrid grid{.width = 24, .height = 16, .torus = torus};
    const std::vector<Place> places = twoPieces(grid);
    const Image image = blendedImage(swatch, grid, places, monitor);
    const vec3 left = sampleSwatch(swatch, {0.5f, 8.5f});
    const vec3 shown(image.at(0, 8, 0), image.at(0, 8, 1), image.at(0, 8, 2));
    CHECK((shown == left) == !torus);
  }
}
