#include "synthesis/coordinate_synthesis.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "fixtures.h"
#include "synthesis/coordinate_relaxation.h"
#include "synthesis/surface_sites.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

constexpr float kSpacing = 1.0f / 64;

struct Scan {
  PointSet points;
  Neighborhoods neighborhoods;
  std::vector<TangentFrame> frames;

  explicit Scan(PointSet set)
      : points(inMortonOrder(set)),
        neighborhoods(neighbourhoods(points, 20)),
        frames(uprightFrames(points)) {}
  SynthesisInput input(const Swatch& swatch, float unit = kSpacing) const {
    return {points, neighborhoods, swatch, frames, unit};
  }
};

Scan plane(int side) {
  const float width = static_cast<float>(side) * kSpacing;
  return Scan(makePlane(width, width, kSpacing));
}

SourceMap synthesized(const SynthesisInput& input, Monitor& monitor, std::uint64_t seed = 1) {
  SourceMap map = emptySourceMap(input.points.size(), input.unit);
  synthesizeCoordinates(input, {.seed = seed}, map, monitor);
  return map;
}

template <class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

Image withHole(Image image) {
  Image out{image.width, image.height, 4, {}};
  out.pixels.assign(static_cast<std::size_t>(image.width) * image.height * 4, 1.0f);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = image.at(x, y, c);
      const int dx = x - image.width / 2, dy = y - image.height / 2;
      if (dx * dx + dy * dy < image.width * image.width / 20) out.at(x, y, 3) = 0;
    }
  return out;
}

}  // namespace

TEST_CASE("coordinates: the same bytes on 1, 2 and 3 threads, others for another seed") {
  const Scan scan = plane(48);
  for (const Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = swatchOf(noise(40), tileable);
    std::vector<SourceMap> bySeed;
    for (const std::uint64_t seed : {1, 2, 3}) {
      std::vector<SourceMap> maps;
      for (const unsigned threads : {1u, 2u, 3u}) {
        Workers workers(threads);
        Monitor monitor(workers);
        maps.push_back(synthesized(scan.input(swatch), monitor, seed));
      }
      for (const SourceMap& map : maps) {
        CHECK(sameBytes(map.texel, maps[0].texel));
        CHECK(sameBytes(map.colour, maps[0].colour));
        CHECK(sameBytes(map.error, maps[0].error));
        CHECK(sameBytes(map.patch, maps[0].patch));
      }
      bySeed.push_back(maps[0]);
    }
    CHECK(!sameBytes(bySeed[0].texel, bySeed[1].texel));
    CHECK(!sameBytes(bySeed[0].texel, bySeed[2].texel));
  }
}

TEST_CASE("coordinates stay inside a swatch that does not tile, and off its transparent part") {
  Workers workers(2);
  Monitor monitor(workers);
  const Scan scan = plane(64);
  for (const bool hole : {false, true}) {
    const Swatch swatch = swatchOf(hole ? withHole(noise(40)) : noise(40), Tileable::No);
    const SourceMap map = synthesized(scan.input(swatch), monitor);
    for (const vec2& texel : map.texel) REQUIRE(usableTexel(swatch, texel));
  }
}

TEST_CASE("the smallest swatches and scans are coloured too") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = plane(6);
  Image image{2, 3, 3, std::vector<float>(18)};
  for (std::size_t i = 0; i < 18; ++i) image.pixels[i] = hashUniform(1, i);
  for (const Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = swatchOf(image, tileable);
    const SourceMap map = synthesized(scan.input(swatch), monitor);
    for (const vec2& texel : map.texel) REQUIRE(usableTexel(swatch, texel));
    for (const PointState state : map.state) REQUIRE(state == PointState::Matched);
  }
}

TEST_CASE("coordinates: stopping throws Cancelled and leaves the map as it was") {
  Workers workers(2);
  const Scan scan = plane(48);
  const Swatch swatch = swatchOf(noise(40));
  for (const bool early : {true, false}) {
    std::stop_source stop;
    if (early) stop.request_stop();
    Monitor monitor(workers, stop.get_token(),
                    {.preview = [&](const Preview&) { stop.request_stop(); }});
    SourceMap map = emptySourceMap(scan.points.size(), kSpacing);
    const SourceMap before = map;
    CHECK_THROWS_AS(synthesizeCoordinates(scan.input(swatch), {}, map, monitor), Cancelled);
    CHECK(sameBytes(map.texel, before.texel));
    CHECK(sameBytes(map.state, before.state));
  }
}

TEST_CASE("ways there and back are the same, and quarters are counted") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan(makeSphere(3000, 1));
  const Swatch swatch = swatchOf(noise(40));
  Scan turned = scan;
  for (std::size_t i = 0; i < turned.frames.size(); ++i) {
    const TangentFrame f = scan.frames[i];
    if (hashBelow(2, 1, i) == 0) turned.frames[i] = {f.t, -f.s, f.n};  // a quarter to the left
  }
  const SurfaceWays plain(scan.input(swatch, 0.03f)), mixed(turned.input(swatch, 0.03f));
  for (Index i = 0; i < 3000; ++i) {
    if (std::abs(scan.points.positions[i].y) > 0.8f) continue;  // frames spin at the poles
    for (const Index j : scan.neighborhoods.of(i)) {
      const auto there = plain.between(i, j), back = plain.between(j, i);
      REQUIRE(there.seen);
      REQUIRE(there.pixels == -back.pixels);
      REQUIRE(there.quarters == 0);
      const int first = hashBelow(2, 1, i) == 0, second = hashBelow(2, 1, j) == 0;
      const auto across = mixed.between(i, j);
      REQUIRE(across.quarters == ((second - first) & 3));
      const vec2 expected = first ? vec2(-there.pixels.y, there.pixels.x) : there.pixels;
      REQUIRE(glm::length(across.pixels - expected) < 1e-4f);
    }
  }
}
