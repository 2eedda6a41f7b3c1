// What the score makes of planes coloured from the shared swatches: the table of the quality
// measure's own figures.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include "base/hash_rng.h"
#include "fixtures.h"
#include "io/image_io.h"
#include "synthesis/texture_score.h"

using namespace dapple;

namespace {

constexpr float kLargest = 160;  // side of a plane, pixels

// A plane whose flat positions are the swatch's pixels, turned so that no row of points is one of
// the image. A swatch that does not tile is shown once, another by whole tiles.
struct Plane {
  PointSet points;
  Neighborhoods neighborhoods;
  std::vector<vec2> flat;
};

Plane planeFor(const Swatch& swatch) {
  const float shorter = static_cast<float>(std::min(swatch.width, swatch.height));
  const float side = swatch.tileable && shorter < kLargest ? 2 * shorter : shorter;
  Plane plane;
  plane.points = fixtures::makePlane(side, side, 1);
  const float c = std::cos(0.6f), s = std::sin(0.6f);
  for (vec3& p : plane.points.positions) {
    plane.flat.emplace_back(p);
    p = vec3(c * p.x - s * p.y, s * p.x + c * p.y, 0);
  }
  plane.neighborhoods = fixtures::neighbourhoods(plane.points);
  return plane;
}

double scoreOf(const Plane& plane, const std::vector<vec3>& colours, const Swatch& swatch,
               std::size_t evaluated) {
  Workers workers(2);
  Monitor monitor(workers);
  return scoreTexture({plane.points, plane.neighborhoods, colours, swatch, 1},
                      {.evaluationPoints = evaluated}, monitor)
      .F;
}

}  // namespace

TEST_CASE("planes of the shared swatches score high, mirrored ones low, random pixels nothing") {
  const std::filesystem::path folder = std::filesystem::path(DAPPLE_SHARED_DATA) / "textures";
  if (!std::filesystem::exists(folder)) {
    MESSAGE("skipped: no shared data at " << folder.string());
    return;
  }
  // None is its own mirror image.
  const std::array<const char*, 8> names = {
      "acg_fabric015.png", "acg_rocks023.png", "acg_roofingtiles002.png", "acg_terrazzo009.png",
      "efros_berries.png", "efros_olives.png", "gimp_burlap.png",         "gimp_leopard.png"};
  double mirroredSum = 0;
  for (const std::string name : names) {
    CAPTURE(name);
    const Image image = readImage(folder / name);
    const Swatch swatch = makeSwatch(image, Tileable::Auto, 1, name);
    const Plane plane = planeFor(swatch);
    const float width = static_cast<float>(swatch.width),
                height = static_cast<float>(swatch.height);
    std::vector<vec3> perfect, mirrored, random;
    for (const vec2& p : plane.flat) {
      perfect.push_back(sampleSwatch(swatch, {p.x, height - p.y}));
      mirrored.push_back(sampleSwatch(swatch, {width - p.x, height - p.y}));
      random.push_back(swatch.colours()[hashBelow(swatch.pixels(), 3, random.size())]);
    }
    CHECK(scoreOf(plane, perfect, swatch, 400) >= 0.95);
    CHECK(scoreOf(plane, random, swatch, 80) <= 0.05);
    mirroredSum += scoreOf(plane, mirrored, swatch, 120);
  }
  CHECK(mirroredSum / names.size() <= 0.4);
}
