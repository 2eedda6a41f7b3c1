#include "swatch/continuation.h"

#include <doctest/doctest.h>

#include <cmath>

#include "fixtures.h"
#include "swatch/appearance.h"
#include "synthesis/coordinate_synthesis.h"
#include "synthesis/synthesis.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

// Every second course of squares of a noise is moved by half a square.
Image bonded(int width, int height, int square) {
  const Image pattern = noise(square);
  Image out{.width = width, .height = height, .channels = 3};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        out.pixels.push_back(pattern.at((x + y / square % 2 * square / 2) % square, y % square, c));
  return out;
}

Swatch sampleOf(const Image& image) {
  return swatchOf(image, Tileable::No);
}

}  // namespace

TEST_CASE("a periodic swatch goes on a whole number of periods away beyond every side") {
  // Reduced before it is searched, and not.
  for (const int period : {24, 150}) {
    const Swatch swatch =
        sampleOf(cutOf(noise(period), 5, 11, period * 7 / 2 + 2, period * 7 / 2 - 1));
    const Continuation found = findContinuation(swatch);
    REQUIRE(!found.none());
    const int signs[] = {1, -1, 1, -1};
    for (std::size_t side = 0; side < 4; ++side) {
      CAPTURE(side);
      const ivec2 way = found.back[side];
      CHECK(way.x % period == 0);
      CHECK(way.y % period == 0);
      CHECK((side < 2 ? way.x : way.y) * signs[side] >=
            (side < 2 ? swatch.width : swatch.height) / 2);
    }
  }
}

TEST_CASE("courses that are moved by half a brick go on in their bond") {
  // Between half of the height and all but the rim there is one course only, not two.
  const Continuation found = findContinuation(sampleOf(bonded(220, 72, 40)));
  for (const ivec2 way : found.back) {
    CHECK(way.y % 40 == 0);
    CHECK((way.x - way.y / 2) % 40 == 0);
  }
  CHECK(std::abs(found.back[2].x) == 20);
  CHECK(std::abs(found.back[3].x) == 20);
}

TEST_CASE("a swatch that tiles, has holes or is very small does not go on anywhere") {
  CHECK(findContinuation(swatchOf(noise(48))).none());
  CHECK(findContinuation(sampleOf(noise(31))).none());
  CHECK(!findContinuation(sampleOf(noise(32))).none());
  Image holed{48, 48, 4, std::vector<float>(48 * 48 * 4, 0.5f)};
  holed.at(20, 20, 3) = 0;
  CHECK(findContinuation(sampleOf(holed)).none());
}

TEST_CASE("a place beyond a side goes on inside, where the swatch looks the same") {
  const Swatch swatch = sampleOf(cutOf(noise(24), 5, 11, 86, 67));
  const Swatch period = swatchOf(cutOf(noise(24), 5, 11, 24, 24));
  const PlaceDomain domain = PlaceDomain::continuing(swatch), plain(swatch);
  CHECK(domain.continues());
  CHECK(!plain.continues());
  for (int y = -60; y < 130; y += 7)
    for (int x = -80; x < 160; x += 7) {
      const vec2 texel(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const Place place = placeOf(texel), to = domain.continued(place);
      REQUIRE(domain.contains(to));
      REQUIRE(glm::length(sampleSwatch(swatch, texelOf(to)) - sampleSwatch(period, texel)) < 1e-5f);
      if (domain.contains(place)) REQUIRE(to == place);
      CHECK(plain.continued(place) == place);
    }
  const Place from = placeOf({80, 30});
  CHECK(domain.contains(domain.moved(from, placeOf({30, 0}))));
  CHECK(!(domain.moved(from, placeOf({30, 0})) == plain.moved(from, placeOf({30, 0}))));
}

TEST_CASE("what lies beyond a side looks as where the swatch goes on") {
  const Swatch swatch = sampleOf(cutOf(noise(24), 5, 11, 86, 67));
  const PlaceDomain domain = PlaceDomain::continuing(swatch);
  Workers workers(1);
  Monitor monitor(workers);
  const AppearanceLevel level = makeAppearance(swatch, 0, false, monitor);
  double off = 0, fromElsewhere = 0;
  for (int y = 2; y < 65; y += 3) {
    const Place beyond = placeOf({-1.5f, static_cast<float>(y) + 0.5f});
    const Place inside = domain.continued(beyond);
    const Place elsewhere = domain.moved(inside, placeOf({12, 12}));  // half a period
    off += appearanceDistance(level.at(beyond), level.at(inside));
    fromElsewhere += appearanceDistance(level.at(beyond), level.at(elsewhere));
  }
  CHECK(off < 0.02 * fromElsewhere);
}

TEST_CASE("coordinates of a periodic swatch that does not tile fit all over a plane") {
  PointSet points = inMortonOrder(makePlane(2, 2, 1.0f / 64));
  const Neighborhoods near = neighbourhoods(points, 20);
  const std::vector<TangentFrame> frames = uprightFrames(points);
  Workers workers(2);
  Monitor monitor(workers);
  const auto meanError = [&](const Swatch& swatch) {
    const SynthesisInput input{points, near, swatch, frames, 1.0f / 64};
    SourceMap map = emptySourceMap(points.size(), input.unit);
    synthesizeCoordinates(input, {.seed = 1}, map, monitor);
    double sum = 0;
    for (const float error : map.error) sum += error;
    return sum / static_cast<double>(points.size());
  };
  // One transparent texel in a corner is enough for it not to go on.
  const Image image = cutOf(noise(24), 5, 11, 86, 67);
  Image holed{image.width, image.height, 4, {}};
  for (std::size_t i = 0; i < image.pixels.size(); i += 3)
    holed.pixels.insert(holed.pixels.end(), {image.pixels[i], image.pixels[i + 1],
                                             image.pixels[i + 2], i > 0 ? 1.f : 0.f});
  const double without = meanError(sampleOf(holed)), cut = meanError(sampleOf(image));
  CAPTURE(without);
  CHECK(cut < 0.5 * without);
}
