#include "synthesis/seam_repair.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/errors.h"
#include "fixtures.h"
#include "synthesis/surface_sites.h"
#include "synthesis/synthesis.h"
#include "synthesis/texture_score.h"

using namespace dapple;

namespace {

// A plane in two patches that meet at x = 40; the right one shows the pattern `shift` away.
struct TwoPatches {
  PointSet points = fixtures::makePlane(80, 60, 1);
  Neighborhoods near = fixtures::neighbourhoods(points);
  std::vector<TangentFrame> frames = fixtures::uprightFrames(points);
  Swatch swatch;
  SynthesisInput input{points, near, swatch, frames, 1};
  SourceMap map = emptySourceMap(points.size(), 1);

  explicit TwoPatches(vec2 shift, Tileable tileable = Tileable::Yes, int size = 64)
      : swatch(fixtures::swatchOf(fixtures::blobs(size), tileable)) {
    map.domain.assign(points.size(), vec2(0));
    map.placement = {vec2(0.5f, 60.5f), vec2(0.5f, 60.5f) + shift};
    for (std::size_t i = 0; i < points.size(); ++i) {
      map.state[i] = PointState::Patch;
      map.patch[i] = points.positions[i].x > 40.5f ? 1 : 0;
      map.domain[i] = {points.positions[i].x, -points.positions[i].y};
      map.frame[i] = frames[i];
      placePoint(map, swatch, i);
    }
  }

  float x(std::size_t i) const { return points.positions[i].x; }
  void repair(const RepairOptions& options, Monitor& monitor) {
    statistics = repairSeams(input, options, map, monitor);
  }
  RepairStatistics statistics;
};

// A row of the left patch's points that belong to the right one.
void insertSliver(TwoPatches& scene) {
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    const vec3 p = scene.points.positions[i];
    const bool inside = std::abs(p.x - 20) < 0.6f && std::abs(p.y - 30) < 6;
    if (inside) scene.map.patch[i] = 1, placePoint(scene.map, scene.swatch, i);
  }
}

// Alpha blends the points beside the seam, as growth does.
void blendSeam(TwoPatches& scene) {
  SourceMap& map = scene.map;
  map.blendOffset.assign(1, 0);
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (std::abs(scene.x(i) - 40.5f) < 2) {
      for (const Index patch : {0u, 1u})
        map.blend.push_back(
            {wrapTexel(scene.swatch, map.domain[i] + map.placement[patch]), patch, 0.5f});
      map.state[i] = PointState::Gap;
    }
    map.blendOffset.push_back(static_cast<Index>(map.blend.size()));
    map.colour[i] = mappedColour(map, scene.swatch, i);
  }
}

// Links to the eight nearest, of points left of x, that the swatch does not go on along.
std::size_t broken(const TwoPatches& scene, float x) {
  const SiteWays ways(scene.input);
  const vec2 size(scene.swatch.width, scene.swatch.height);
  std::size_t count = 0;
  for (Index i = 0; i < scene.points.size(); ++i) {
    if (scene.x(i) > x) continue;
    for (const Index j : scene.near.of(i).first(8)) {
      vec2 d = scene.map.texel[j] - scene.map.texel[i] - ways.between(i, j).pixels;
      d -= size * glm::round(d / size);
      count += glm::length(d) > 0.8f;
    }
  }
  return count;
}

bool sameSource(const SourceMap& a, const SourceMap& b, std::size_t i) {
  return a.texel[i] == b.texel[i] && a.patch[i] == b.patch[i] && a.domain[i] == b.domain[i] &&
         a.colour[i] == b.colour[i];
}

}  // namespace

TEST_CASE("repair changes nothing further than its width from a seam") {
  Workers workers(1);
  Monitor monitor(workers);
  for (const float width : {1.5f, 3.f}) {
    TwoPatches scene(vec2(9, 5));
    const SourceMap before = scene.map;
    scene.repair({.width = width}, monitor);
    CHECK(scene.statistics.moved > 0);
    CHECK(scene.statistics.open > scene.statistics.seams);
    std::size_t moved = 0;
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      moved += scene.map.texel[i] != before.texel[i];
      // Points at the seam have a neighbour of the other patch: not more than 3 away in a grid.
      if (std::abs(scene.x(i) - 40.5f) > width + 3) REQUIRE(sameSource(scene.map, before, i));
      REQUIRE(scene.map.state[i] == before.state[i]);
      REQUIRE(scene.map.colour[i] == sampleSwatch(scene.swatch, scene.map.texel[i]));
    }
    CHECK(moved == scene.statistics.moved);
  }
}

TEST_CASE("repaired points belong to the patch that they continue") {
  Workers workers(1);
  Monitor monitor(workers);
  TwoPatches scene(vec2(9, 5));
  scene.repair({}, monitor);
  const vec2 size(scene.swatch.width, scene.swatch.height);
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    REQUIRE(scene.map.patch[i] < 2);
    vec2 d = scene.map.domain[i] + scene.map.placement[scene.map.patch[i]] - scene.map.texel[i];
    d -= size * glm::round(d / size);
    REQUIRE(glm::length(d) < 1e-3f);
  }
}

TEST_CASE("a map without a seam is not touched by repair") {
  Workers workers(1);
  Monitor monitor(workers);
  TwoPatches scene(vec2(0));
  const SourceMap before = scene.map;
  scene.repair({}, monitor);
  CHECK(scene.statistics.seams == 0);
  CHECK(scene.map.texel == before.texel);
  CHECK(scene.map.colour == before.colour);
  CHECK(scene.map.patch == before.patch);
}

TEST_CASE("repair takes a sliver of another patch back") {
  Workers workers(1);
  Monitor monitor(workers);
  TwoPatches scene(vec2(9, 5));
  insertSliver(scene);
  const std::size_t before = broken(scene, 30);
  CHECK(before > 50);
  scene.repair({}, monitor);
  CHECK(broken(scene, 30) < before / 4);
}

TEST_CASE("blends end where seams are repaired, and stay elsewhere") {
  Workers workers(1);
  Monitor monitor(workers);
  TwoPatches scene(vec2(9, 5));
  blendSeam(scene);
  scene.repair({}, monitor);
  CHECK(scene.map.blend.empty());
  CHECK(scene.map.blendOffset.empty());
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    REQUIRE(scene.map.colour[i] == sampleSwatch(scene.swatch, scene.map.texel[i]));

  TwoPatches kept(vec2(9, 5));
  blendSeam(kept);
  const SourceMap before = kept.map;
  kept.input.kept = &before;
  kept.repair({}, monitor);
  CHECK(kept.map.blendOffset == before.blendOffset);
  CHECK(kept.map.colour == before.colour);
}

TEST_CASE("repair leaves kept points as they are") {
  Workers workers(1);
  Monitor monitor(workers);
  TwoPatches scene(vec2(9, 5));
  SourceMap kept = scene.map;
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    if (scene.points.positions[i].y < 30) kept.state[i] = PointState::Free;
  scene.input.kept = &kept;
  const SourceMap before = scene.map;
  scene.repair({}, monitor);
  CHECK(scene.statistics.moved > 0);
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    if (kept.state[i] != PointState::Free) REQUIRE(sameSource(scene.map, before, i));
}

TEST_CASE("repaired points stay inside a swatch that does not tile") {
  Workers workers(1);
  Monitor monitor(workers);
  TwoPatches scene(vec2(9, 5), Tileable::No, 100);
  scene.repair({.width = 6, .levels = 3}, monitor);
  CHECK(scene.statistics.moved > 0);
  for (const vec2& texel : scene.map.texel) REQUIRE(usableTexel(scene.swatch, texel));
}

TEST_CASE("repair is the same at any number of threads, and can be stopped") {
  TwoPatches one(vec2(9, 5));
  Workers single(1);
  Monitor monitor(single);
  const SourceMap before = one.map;
  std::stop_source stop;
  stop.request_stop();
  Monitor stopped(single, stop.get_token());
  CHECK_THROWS_AS(one.repair({}, stopped), Cancelled);
  CHECK(one.map.texel == before.texel);
  CHECK_THROWS_AS(one.repair({.width = -1}, monitor), InvalidInput);
  one.repair({}, monitor);
  for (const unsigned threads : {2u, 3u}) {
    TwoPatches more(vec2(9, 5));
    Workers workers(threads);
    Monitor busy(workers);
    more.repair({}, busy);
    CHECK(more.map.texel == one.map.texel);
    CHECK(more.map.colour == one.map.colour);
    CHECK(more.map.patch == one.map.patch);
    CHECK(more.map.domain == one.map.domain);
  }
}

TEST_CASE("repair does not lower the score of what has seams") {
  Workers workers(2);
  Monitor monitor(workers);
  constexpr float kUnit = 0.035f;  // about the spacing
  const PointSet points = fixtures::inMortonOrder(fixtures::makeSphere(10000, 1));
  const Neighborhoods near = fixtures::neighbourhoods(points, 20);
  const std::vector<TangentFrame> frames = fixtures::uprightFrames(points);
  const Swatch swatch = fixtures::swatchOf(fixtures::blobs(48), Tileable::No);
  const SynthesisInput input{points, near, swatch, frames, kUnit};
  for (const Method method : {Method::Patches, Method::Hybrid}) {
    double score[2];
    for (const double width : {0.0, 3.0}) {
      TextureOptions options;
      options.method = method, options.repair = width;
      const SourceMap map = synthesize(input, options, monitor).map;
      score[width > 0] = scoreTexture({.points = points,
                                       .neighborhoods = near,
                                       .colours = map.colour,
                                       .swatch = swatch,
                                       .unit = kUnit,
                                       .map = &map},
                                      {.evaluationPoints = 800}, monitor)
                             .F;
    }
    CAPTURE(score[0]);
    CHECK(score[1] >= score[0] - 0.01);
  }
}
