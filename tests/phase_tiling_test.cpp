#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.h"
#include "fixtures.h"
#include "same_maps.h"
#include "synthesis/coordinate_synthesis.h"
#include "synthesis/phase_field.h"
#include "synthesis/tiling_synthesis.h"
#include "synthesis/torus_crop.h"

using namespace dapple;
using dapple::testing::sameBytes;
using namespace dapple::fixtures;

namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;
constexpr int kSize = 24;  // of the swatch, pixels

struct Scan {
  PointSet points;
  Neighborhoods neighborhoods;
  std::vector<TangentFrame> frames;
  float unit = 1;
  std::vector<float> scale;

  SynthesisInput input(const Swatch& swatch) const {
    return {points, neighborhoods, swatch, frames, unit, scale};
  }
};

// Points about a pixel apart: a rectangle of pixels that is bent by `bend`, which gives each place
// a frame and a position.
struct Bent {
  vec3 position;
  TangentFrame frame;
};
template <class Bend>
Scan bent(float width, float height, const Bend& bend) {
  Scan out;
  out.points = inMortonOrder(makePlane(width, height, 1, 0.6f));
  for (std::size_t i = 0; i < out.points.size(); ++i) {
    const Bent b = bend(out.points.positions[i]);
    out.points.positions[i] = b.position;
    out.points.normals[i] = b.frame.n;
    out.frames.push_back(b.frame);
  }
  out.neighborhoods = neighbourhoods(out.points, 20);
  return out;
}

Scan plane(float width, float height) {
  return bent(width, height, [](const vec3& p) {
    return Bent{p, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  });
}

Scan cylinder(float around, float height) {
  const float radius = around / kTurn;
  return bent(around, height, [&](const vec3& p) {
    const float a = p.x / radius;
    const vec3 n(std::sin(a), 0, std::cos(a));
    return Bent{radius * n + vec3(0, p.y, 0), {{n.z, 0, -n.x}, {0, 1, 0}, n}};
  });
}

Scan torus(float around, float tube) {
  const float radius = around / kTurn, small = tube / kTurn;
  return bent(around, tube, [&](const vec3& p) {
    const float a = p.x / radius, b = p.y / small;
    const vec3 out(std::sin(a), 0, std::cos(a));
    const vec3 n = std::cos(b) * out + vec3(0, std::sin(b), 0);
    const vec3 t = vec3(0, std::cos(b), 0) - std::sin(b) * out;
    return Bent{radius * out + small * n, {{out.z, 0, -out.x}, t, n}};
  });
}

// Of a radius in pixels; upright, so that the axes spin around the poles.
Scan sphere(float radius) {
  Scan out;
  const float area = 2 * kTurn * radius * radius;
  out.points = inMortonOrder(makeSphere(static_cast<std::size_t>(area), radius));
  out.frames = uprightFrames(out.points);
  out.neighborhoods = neighbourhoods(out.points, 20);
  return out;
}

SourceMap tiled(const Scan& scan, const Swatch& swatch, const TilingOptions& options = {},
                unsigned threads = 2) {
  Workers workers(threads);
  Monitor monitor(workers);
  SourceMap map = emptySourceMap(scan.points.size(), scan.unit);
  synthesizeTiling(scan.input(swatch), options, map, monitor);
  return map;
}

constexpr TilingOptions kPhasesOnly{.stretch = 1e6f};

float mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += v;
  return static_cast<float>(sum / static_cast<double>(values.size()));
}

float most(const std::vector<float>& values) {
  return *std::max_element(values.begin(), values.end());
}

double shareAbove(const std::vector<float>& values, float limit) {
  const auto count =
      std::count_if(values.begin(), values.end(), [&](float v) { return v > limit; });
  return static_cast<double>(count) / static_cast<double>(values.size());
}

// How far `way` is from a whole number of swatches, pixels.
float misfit(vec2 way) {
  const vec2 period(kSize, kSize);
  return glm::length(way - period * vec2(std::round(way.x / kSize), std::round(way.y / kSize)));
}

// Mean difference between the neighbours' colours and what the swatch shows where they should be,
// over the points that are `chosen`.
double seamError(const Scan& scan, const Swatch& swatch, const SourceMap& map,
                 const std::vector<std::uint8_t>& chosen) {
  const SynthesisInput input = scan.input(swatch);
  const SiteWays ways(input);
  double sum = 0, count = 0;
  for (Index i = 0; i < scan.points.size(); ++i) {
    if (!chosen[i]) continue;
    for (const Index j : scan.neighborhoods.of(i)) {
      const auto way = ways.between(i, j);
      if (!way.seen || way.quarters != 0) continue;
      sum += glm::length(sampleSwatch(swatch, map.texel[i] + way.pixels) -
                         sampleSwatch(swatch, map.texel[j]));
      ++count;
    }
  }
  return sum / count;
}

}  // namespace

TEST_CASE("tiling a plane repeats the swatch exactly") {
  const Scan scan = plane(100, 80);
  const Swatch swatch = swatchOf(noise(kSize));
  const SourceMap map = tiled(scan, swatch);
  CHECK(most(map.error) < 1e-3f);
  std::vector<std::uint8_t> shown(kSize * kSize, 0);
  const vec2 origin = map.texel[0] - vec2(scan.points.positions[0].x, -scan.points.positions[0].y);
  for (std::size_t i = 0; i < map.texel.size(); ++i) {
    const vec3& p = scan.points.positions[i];
    REQUIRE(misfit(map.texel[i] - vec2(p.x, -p.y) - origin) < 0.01f);
    shown[static_cast<std::size_t>(map.texel[i].y) * kSize +
          static_cast<std::size_t>(map.texel[i].x)] = 1;
  }
  CHECK(std::count(shown.begin(), shown.end(), 0) == 0);
}

TEST_CASE("tiling a cylinder closes without a seam, or spreads what does not fit evenly") {
  const Swatch swatch = swatchOf(noise(kSize));
  const SourceMap whole = tiled(cylinder(4 * kSize, 60), swatch, kPhasesOnly);
  CHECK(most(whole.error) < 0.02f);
  for (const float times : {3.7f, 4.3f}) {
    const SourceMap map = tiled(cylinder(times * kSize, 60), swatch, kPhasesOnly);
    // A whole number is 4; the way around takes part in half of the squares.
    const float spread = std::abs(4 / times - 1) / std::sqrt(2.0f);
    CAPTURE(times);
    CHECK(mean(map.error) == doctest::Approx(spread).epsilon(0.2));
    CHECK(most(map.error) < 3 * spread);
  }
}

TEST_CASE("tiling a torus hides what does not fit in few dislocations") {
  const Scan scan = torus(10 * kSize, 3 * kSize);
  const SourceMap map = tiled(scan, swatchOf(noise(kSize)), kPhasesOnly);
  CHECK(mean(map.error) < 0.2f);
  CHECK(shareAbove(map.error, 0.4f) < 0.02);
}

TEST_CASE("tiling turns with the input") {
  const Swatch swatch = swatchOf(noise(kSize));
  const Scan scan = plane(80, 60);
  Scan turned = scan;
  const auto turn = [](const vec3& v) {  // about x by 53 degrees, then about z by 37
    const vec3 a(v.x, 0.6f * v.y - 0.8f * v.z, 0.8f * v.y + 0.6f * v.z);
    return vec3(0.8f * a.x - 0.6f * a.y, 0.6f * a.x + 0.8f * a.y, a.z);
  };
  for (vec3& p : turned.points.positions) p = turn(p);
  for (vec3& n : turned.points.normals) n = turn(n);
  for (TangentFrame& f : turned.frames) f = {turn(f.s), turn(f.t), turn(f.n)};
  const SourceMap a = tiled(scan, swatch), b = tiled(turned, swatch);
  const vec2 shift = b.texel[0] - a.texel[0];
  for (std::size_t i = 0; i < a.texel.size(); ++i)
    REQUIRE(misfit(b.texel[i] - a.texel[i] - shift) < 0.02f);
}

TEST_CASE("tiling: others for another seed") {
  const Scan scan = sphere(30);
  const Swatch swatch = swatchOf(noise(kSize));
  std::vector<SourceMap> bySeed;
  for (const std::uint64_t seed : {1, 2, 3}) bySeed.push_back(tiled(scan, swatch, {.seed = seed}));
  CHECK(!sameBytes(bySeed[0].texel, bySeed[1].texel));
  CHECK(!sameBytes(bySeed[0].texel, bySeed[2].texel));
}

TEST_CASE("tiling follows the scale of the points") {
  Scan scan = plane(100, 80);
  scan.scale.assign(scan.points.size(), 2.0f);
  const SourceMap map = tiled(scan, swatchOf(noise(kSize)));
  CHECK(most(map.error) < 1e-3f);
  const vec3 first = scan.points.positions[0];
  for (std::size_t i = 0; i < map.texel.size(); ++i) {
    const vec3 way = 0.5f * (scan.points.positions[i] - first);
    REQUIRE(misfit(map.texel[i] - map.texel[0] - vec2(way.x, -way.y)) < 0.01f);
  }
}

TEST_CASE("tiling: the residual shows the poles of a sphere, and handing them over mends seams") {
  const Scan scan = sphere(50);
  const Swatch swatch = swatchOf(noise(kSize));
  const SourceMap phases = tiled(scan, swatch, kPhasesOnly), mended = tiled(scan, swatch);
  CHECK(sameBytes(phases.error, mended.error));
  double pole = 0, poles = 0;
  std::vector<std::uint8_t> open(scan.points.size());
  for (std::size_t i = 0; i < open.size(); ++i) {
    open[i] = phases.error[i] > TilingOptions{}.stretch;
    if (!open[i]) REQUIRE(phases.texel[i] == mended.texel[i]);
    if (std::abs(scan.points.positions[i].y) < 49) continue;
    pole += phases.error[i] > 0.4f ? 1 : 0, ++poles;
  }
  CHECK(pole > 0.4 * poles);
  CHECK(shareAbove(phases.error, 0.4f) < 0.12);
  CHECK(seamError(scan, swatch, mended, open) < 0.8 * seamError(scan, swatch, phases, open));
}

TEST_CASE("tiling leaves a surface that hardly holds the swatch to coordinates") {
  const Scan scan = cylinder(kSize, 60);  // less than half around
  const Swatch swatch = swatchOf(noise(2 * kSize + kSize / 4));
  const SourceMap phases = tiled(scan, swatch, kPhasesOnly), map = tiled(scan, swatch);
  Workers workers(2);
  Monitor monitor(workers);
  SourceMap coordinates = emptySourceMap(scan.points.size(), scan.unit);
  synthesizeCoordinates(scan.input(swatch), {.seed = 1}, coordinates, monitor);
  CHECK(shareAbove(phases.error, TilingOptions{}.stretch) > 0.6);
  CHECK(sameBytes(map.texel, coordinates.texel));
  CHECK(sameBytes(map.error, phases.error));
}

TEST_CASE("tiling: stopping throws Cancelled and leaves the map as it was") {
  Workers workers(2);
  std::stop_source stop;
  Monitor monitor(workers, stop.get_token(),
                  {.preview = [&](const Preview&) { stop.request_stop(); }});
  const Scan scan = plane(100, 80);
  const Swatch swatch = swatchOf(noise(kSize));
  SourceMap map = emptySourceMap(scan.points.size(), scan.unit);
  const SourceMap before = map;
  CHECK_THROWS_AS(synthesizeTiling(scan.input(swatch), {}, map, monitor), Cancelled);
  CHECK(sameBytes(map.texel, before.texel));
  CHECK(sameBytes(map.state, before.state));
}

TEST_CASE("of a swatch that does not tile, a part that does is made and repeated") {
  const Scan scan = plane(150, 110);
  const Swatch swatch = swatchOf(noise(2 * kSize), Tileable::No);
  Workers workers(2);
  const Monitor monitor(workers);
  const auto period = static_cast<float>(bestTorusCrop(swatch, monitor).width);
  const SourceMap map = tiled(scan, swatch);
  std::size_t goesOn = 0, same = 0, pairs = 0;
  for (Index i = 0; i < scan.points.size(); ++i) {
    REQUIRE(usableTexel(swatch, map.texel[i]));
    const Index j = scan.neighborhoods.of(i)[0];
    const vec3 way = scan.points.positions[j] - scan.points.positions[i];
    const vec2 off = map.texel[j] - map.texel[i] - vec2(way.x, -way.y);
    goesOn += glm::length(off) < 0.6f ? 1 : 0;
  }
  // Pieces of the swatch, not single texels; and the same again where the torus begins anew.
  CHECK(goesOn > scan.points.size() * 8 / 10);
  for (Index i = 0; i < scan.points.size(); i += 7) {
    const vec3 wanted = scan.points.positions[i] + vec3(period, 0, 0);
    for (Index j = 0; j < scan.points.size(); ++j) {
      const vec3 way = wanted - scan.points.positions[j];
      if (glm::length(way) > 0.35f) continue;
      ++pairs;
      same += glm::length(map.texel[j] - map.texel[i] + vec2(way.x, -way.y)) < 0.6f ? 1 : 0;
      break;
    }
  }
  CHECK(pairs > 300);
  CHECK(same > pairs * 8 / 10);
}

TEST_CASE("tiling refuses a swatch that nothing can be read from between texels") {
  Image image = noise(4);
  image.channels = 4;
  image.pixels.assign(4 * 4 * 4, 0);
  image.at(1, 1, 3) = 1;
  const Scan scan = plane(20, 20);
  CHECK_THROWS_AS(tiled(scan, swatchOf(image, Tileable::No)), InvalidInput);
}
