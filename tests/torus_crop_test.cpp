#include "synthesis/torus_crop.h"

#include <doctest/doctest.h>

#include "fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

// Root mean square difference between each pixel of column x and the next one's.
double stepAfter(const Swatch& swatch, const TorusCrop& crop, std::span<const Place> places,
                 int x) {
  double sum = 0;
  for (int y = 0; y < crop.height; ++y) {
    const Place* row = places.data() + static_cast<std::size_t>(y) * crop.width;
    const vec3 d = sampleSwatch(swatch, texelOf(row[(x + 1) % crop.width])) -
                   sampleSwatch(swatch, texelOf(row[x]));
    sum += glm::dot(d, d);
  }
  return std::sqrt(sum / crop.height);
}

}  // namespace

TEST_CASE("the part that tiles of a periodic swatch is the most whole periods it holds") {
  const Swatch swatch = swatchOf(cutOf(noise(24), 5, 11, 86, 67), Tileable::No);
  Workers workers(1);
  Monitor monitor(workers);
  const TorusCrop crop = bestTorusCrop(swatch, monitor);
  CHECK(crop.width == 72);
  CHECK(crop.height == 48);
  // Nothing needs to be mended, so that the mended band goes on as the swatch would.
  const std::vector<Place> places = closedTorus(swatch, crop, 4, monitor);
  double off = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const vec2 pixel(i % 72, i / 72);
    const vec3 d = sampleSwatch(swatch, texelOf(places[i])) -
                   sampleSwatch(swatch, pixel + vec2(crop.x, crop.y) + 0.5f);
    off += glm::length(d) > 0.02f ? 1 : 0;
  }
  CHECK(off < 0.05 * static_cast<double>(places.size()));
}

TEST_CASE("a closed torus keeps its inside and has no seam along its sides") {
  const Swatch swatch = swatchOf(cutOf(noise(90), 0, 0, 80, 70), Tileable::No);
  const PlaceDomain domain(swatch);
  Workers workers(1), three(3);
  Monitor monitor(workers), threaded(three);
  const TorusCrop crop = bestTorusCrop(swatch, monitor);
  CHECK(crop.width >= 40);
  CHECK(crop.height >= 35);
  REQUIRE(crop.x + crop.width <= 80);
  REQUIRE(crop.y + crop.height <= 70);
  const std::vector<Place> places = closedTorus(swatch, crop, 4, monitor);
  CHECK(closedTorus(swatch, crop, 4, threaded) == places);
  std::size_t moved = 0, inside = 0;
  for (int y = 0; y < crop.height; ++y)
    for (int x = 0; x < crop.width; ++x) {
      const Place place = places[static_cast<std::size_t>(y) * crop.width + x];
      REQUIRE(domain.contains(place));
      if (std::min({x, y, crop.width - 1 - x, crop.height - 1 - y}) < 10) continue;
      ++inside;
      moved += place == placeOf(vec2(crop.x + x, crop.y + y) + 0.5f) ? 0 : 1;
    }
  CHECK(inside > 400);
  CHECK(moved == 0);
  double within = 0;
  for (int x = 12; x < crop.width - 12; ++x) within += stepAfter(swatch, crop, places, x);
  within /= crop.width - 24;
  CHECK(stepAfter(swatch, crop, places, crop.width - 1) < 1.5 * within);
}

TEST_CASE("a swatch too small to choose a part of is closed as it is") {
  const Swatch swatch = swatchOf(noise(20), Tileable::No);
  Workers workers(1);
  Monitor monitor(workers);
  const TorusCrop crop = bestTorusCrop(swatch, monitor);
  CHECK(crop.width == 20);
  CHECK(crop.height == 20);
  CHECK(closedTorus(swatch, crop, 4, monitor).size() == 400);
}
