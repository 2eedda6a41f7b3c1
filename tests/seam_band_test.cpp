#include "synthesis/seam_band.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/errors.h"
#include "fixtures.h"

using namespace dapple;

namespace {

// A plane in two patches that meet at x = 40; the right one shows the pattern `shift` away.
struct TwoPatches {
  PointSet points = fixtures::makePlane(80, 60, 1);
  Neighborhoods near = fixtures::neighbourhoods(points);
  std::vector<TangentFrame> frames = fixtures::uprightFrames(points);
  Swatch swatch = fixtures::swatchOf(fixtures::blobs(64), Tileable::Yes);
  SynthesisInput input{points, near, swatch, frames, 1};
  SourceMap map = emptySourceMap(points.size(), 1);

  explicit TwoPatches(vec2 shift) {
    map.domain.assign(points.size(), vec2(0));
    map.placement = {vec2(0.5f), vec2(0.5f) + shift};
    for (std::size_t i = 0; i < points.size(); ++i) {
      map.state[i] = PointState::Patch;
      map.patch[i] = isRight(i) ? 1 : 0;
      map.domain[i] = {points.positions[i].x, -points.positions[i].y};
      map.frame[i] = frames[i];
      placePoint(map, swatch, i);
    }
  }

  bool isRight(std::size_t i) const { return points.positions[i].x > 40.5f; }
};

// A row of the left patch's points that belong to the right one.
void insertSliver(TwoPatches& scene) {
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    const vec3 p = scene.points.positions[i];
    const bool inside = std::abs(p.x - 20) < 0.6f && std::abs(p.y - 30) < 6;
    if (inside) scene.map.patch[i] = 1, placePoint(scene.map, scene.swatch, i);
  }
}

}  // namespace

TEST_CASE("the band changes nothing further than its width from a seam") {
  Workers workers(1);
  Monitor monitor(workers);
  for (const float width : {1.5f, 3.f}) {
    TwoPatches scene(vec2(9, 5));
    const SourceMap before = scene.map;
    const std::size_t changed = matchBand(scene.input, {.width = width}, scene.map, monitor);
    CHECK(changed > 0);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const bool same =
          scene.map.texel[i] == before.texel[i] && scene.map.patch[i] == before.patch[i];
      seen += same ? 0 : 1;
      // Points at the seam have a neighbour of the other patch: not more than 3 away in a grid.
      const float x = scene.points.positions[i].x;
      if (x < 40.5f - width - 3 || x > 40.5f + width + 3) REQUIRE(same);
      REQUIRE(scene.map.state[i] == before.state[i]);
      REQUIRE(
          scene.map.texel[i] ==
          wrapTexel(scene.swatch, scene.map.domain[i] + scene.map.placement[scene.map.patch[i]]));
      REQUIRE(scene.map.colour[i] == sampleSwatch(scene.swatch, scene.map.texel[i]));
    }
    CHECK(seen <= changed);
  }
}

TEST_CASE("the band has nothing to do where the pattern goes on without a break") {
  Workers workers(1);
  Monitor monitor(workers);
  TwoPatches scene(vec2(0));
  const SourceMap before = scene.map;
  matchBand(scene.input, {}, scene.map, monitor);
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    REQUIRE(glm::length(scene.map.colour[i] - before.colour[i]) < 1e-3f);
}

TEST_CASE("the band takes a sliver of another patch back") {
  Workers workers(1);
  Monitor monitor(workers);
  TwoPatches scene(vec2(9, 5));
  insertSliver(scene);
  const auto strays = [&] {
    std::size_t count = 0;
    for (std::size_t i = 0; i < scene.points.size(); ++i)
      count += scene.points.positions[i].x < 30 && scene.map.patch[i] == 1 ? 1 : 0;
    return count;
  };
  const std::size_t before = strays();
  CHECK(before >= 10);
  matchBand(scene.input, {}, scene.map, monitor);
  CHECK(strays() < before / 2);
}

TEST_CASE("the band is the same at any number of threads, and can be stopped") {
  TwoPatches one(vec2(9, 5));
  Workers single(1);
  Monitor monitor(single);
  const SourceMap before = one.map;
  std::stop_source stop;
  stop.request_stop();
  Monitor stopped(single, stop.get_token());
  CHECK_THROWS_AS(matchBand(one.input, {}, one.map, stopped), Cancelled);
  CHECK(one.map.texel == before.texel);
  matchBand(one.input, {}, one.map, monitor);
  for (const unsigned threads : {2u, 3u}) {
    TwoPatches more(vec2(9, 5));
    Workers workers(threads);
    Monitor busy(workers);
    matchBand(more.input, {}, more.map, busy);
    CHECK(more.map.texel == one.map.texel);
    CHECK(more.map.colour == one.map.colour);
    CHECK(more.map.patch == one.map.patch);
  }
}
