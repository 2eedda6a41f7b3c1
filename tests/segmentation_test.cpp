#include "regions/segmentation.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

struct Scene {
  PointSet points;
  Neighborhoods neighborhoods;
  Workers workers;
  Monitor monitor{workers};

  explicit Scene(PointSet set) : points(std::move(set)), neighborhoods(neighbourhoods(points)) {}
  LinkedPoints graph() const { return {points, neighborhoods}; }
  Index nearest(vec3 to) const {
    Index best = 0;
    for (Index i = 1; i < points.size(); ++i)
      if (glm::length(points.positions[i] - to) < glm::length(points.positions[best] - to))
        best = i;
    return best;
  }
};

// The surface of [-1, 1]^3, `side` x `side` points a face, none on an edge; unsorted.
PointSet makeCube(int side) {
  PointSet cube;
  for (int face = 0; face < 6; ++face)
    for (int a = 0; a < side; ++a)
      for (int b = 0; b < side; ++b) {
        const float u = (2 * (static_cast<float>(a) + 0.5f) / static_cast<float>(side)) - 1;
        const float v = (2 * (static_cast<float>(b) + 0.5f) / static_cast<float>(side)) - 1;
        vec3 p(0), n(0);
        const int axis = face / 2;
        p[axis] = n[axis] = face % 2 == 0 ? 1.f : -1.f;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = v;
        cube.positions.push_back(p);
        cube.normals.push_back(n);
      }
  return cube;
}

// Two planes, one above the other, closer than their points are to each other and facing away.
PointSet makeSheet() {
  PointSet sheet = makePlane(1, 1, 0.02f);
  const std::size_t n = sheet.size();
  for (std::size_t i = 0; i < n; ++i) {
    sheet.positions.push_back(sheet.positions[i] - vec3(0, 0, 0.005f));
    sheet.normals.emplace_back(0, 0, -1);
  }
  return sheet;
}

}  // namespace

TEST_CASE("masks count, list and combine their points") {
  PointMask a = maskOf(std::vector<Index>{0, 63, 64, 99}, 100);
  CHECK(a.count() == 4);
  CHECK(a.points() == std::vector<Index>{0, 63, 64, 99});
  PointMask all(100, true);
  CHECK(all.count() == 100);
  all -= a;
  a.invert();
  CHECK(all == a);
  CHECK_THROWS_AS(maskOf(std::vector<Index>{100}, 100), InvalidInput);
}

TEST_CASE("growing adds a ring, and shrinking is growing seen from outside") {
  Scene scene(makePlane(1, 1, 0.01f));
  PointMask mask(scene.points.size());
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (glm::length(scene.points.positions[i] - vec3(0.5f, 0.5f, 0)) < 0.2f) mask.add(i);
  const PointMask more = grown(scene.graph(), mask, scene.monitor);
  const PointMask less = shrunk(scene.graph(), mask, scene.monitor);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const float r = glm::length(scene.points.positions[i] - vec3(0.5f, 0.5f, 0));
    if (mask.has(i)) REQUIRE(more.has(i));
    if (less.has(i)) REQUIRE(mask.has(i));
    if (more.has(i)) REQUIRE(r < 0.2f + 0.05f);
    if (r < 0.2f + 0.005f) REQUIRE(more.has(i));
    if (!less.has(i)) REQUIRE(r > 0.2f - 0.05f);
    if (r > 0.2f - 0.005f) REQUIRE(!less.has(i));
  }
  PointMask outside = mask;
  outside.invert();
  PointMask twin = grown(scene.graph(), outside, scene.monitor);
  twin.invert();
  CHECK(twin == less);
}

TEST_CASE("what hangs together ends at a gap and at the other side of a thin sheet") {
  Scene sheet(makeSheet());
  const PointMask top = connectedTo(sheet.graph(), 0, sheet.monitor);
  CHECK(top.count() == sheet.points.size() / 2);
  CHECK(!top.has(sheet.points.size() - 1));
  CHECK_THROWS_AS(
      connectedTo(sheet.graph(), static_cast<Index>(sheet.points.size()), sheet.monitor),
      InvalidInput);
}

TEST_CASE("what hangs together does not depend on the point that one starts from") {
  PointSet uneven = makePlane(1, 1, 0.02f);
  for (vec3& p : uneven.positions) p.x *= p.x * p.x;  // dense at one end: links lack their twins
  Scene scene(std::move(uneven));
  const PointMask from = connectedTo(scene.graph(), 0, scene.monitor);
  for (const Index seed : {7u, 400u, 2000u})
    if (from.has(seed)) CHECK(connectedTo(scene.graph(), seed, scene.monitor) == from);
  CHECK(from.count() == scene.points.size());
}

TEST_CASE("the wand by normal takes one face of a cube, or all that look the same way") {
  Scene cube(makeCube(30));
  const Index seed = cube.nearest({1, 0, 0});
  const PointMask face =
      wand(cube.graph(), {}, seed, {.by = WandBy::Normal, .threshold = 20}, cube.monitor);
  CHECK(face.count() == 900);
  for (const Index i : face.points()) CHECK(cube.points.normals[i].x == 1);
  Scene ball(makeSphere(8000, 1));
  const PointMask cap = wand(ball.graph(), {}, ball.nearest({0, 0, 1}),
                             {.by = WandBy::Normal, .threshold = 60}, ball.monitor);
  CHECK(static_cast<double>(cap.count()) == doctest::Approx(8000 * 0.25).epsilon(0.03));
}

TEST_CASE("the wand by colour stops at an edge, unless it need not hang together") {
  Scene scene(makePlane(1, 1, 0.02f));
  std::vector<vec3> colours;
  for (const vec3& p : scene.points.positions)
    colours.push_back(std::abs(p.x - 0.5f) < 0.1f ? vec3(0, 0, 1) : vec3(0.9f, 0.1f, 0));
  const Index seed = scene.nearest({0.1f, 0.5f, 0});
  WandOptions options{.by = WandBy::Colour, .threshold = 0.2f};
  const PointMask left = wand(scene.graph(), colours, seed, options, scene.monitor);
  options.connected = false;
  const PointMask both = wand(scene.graph(), colours, seed, options, scene.monitor);
  for (std::size_t i = 0; i < colours.size(); ++i) {
    REQUIRE(left.has(i) == (scene.points.positions[i].x <= 0.4f));
    REQUIRE(both.has(i) == (colours[i].x > 0.5f));
  }
  CHECK_THROWS_AS(wand(scene.graph(), {}, seed, options, scene.monitor), InvalidInput);
  options.threshold = -1;
  CHECK_THROWS_AS(wand(scene.graph(), colours, seed, options, scene.monitor), InvalidInput);
}

TEST_CASE("distances along the surface are those of the sphere, within the links' zigzag") {
  Scene ball(makeSphere(20000, 1));
  const Index pole = ball.nearest({0, 0, 1});
  const std::vector<float> d = surfaceDistances(
      ball.graph(), {&pole, 1}, std::numeric_limits<float>::infinity(), ball.monitor);
  for (std::size_t i = 0; i < d.size(); ++i) {
    const float exact = std::acos(
        std::clamp(glm::dot(ball.points.positions[i], ball.points.positions[pole]), -1.f, 1.f));
    REQUIRE(d[i] >= exact * 0.995f);
    REQUIRE(d[i] <= exact * 1.12f + 0.03f);
  }
  const std::vector<float> near = surfaceDistances(ball.graph(), {&pole, 1}, 0.5f, ball.monitor);
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d[i] <= 0.5f)
      REQUIRE(near[i] == d[i]);
    else
      REQUIRE(std::isinf(near[i]));
  }
}

TEST_CASE("the shortest ways are those of Dijkstra's algorithm") {
  Scene scene(makePlane(1, 1, 0.04f));
  const std::array<Index, 2> seeds{3, 500};
  const std::vector<float> d =
      surfaceDistances(scene.graph(), seeds, std::numeric_limits<float>::infinity(), scene.monitor);
  std::vector<float> slow(d.size(), std::numeric_limits<float>::infinity());
  for (const Index s : seeds) slow[s] = 0;
  for (bool changed = true; changed;) {  // Bellman and Ford, links in both directions
    changed = false;
    for (Index i = 0; i < slow.size(); ++i)
      for (std::size_t c = 0; c < 12; ++c) {
        const Index j = scene.neighborhoods.of(i)[c];
        const float length = distanceBetween(scene.points.positions[i], scene.points.positions[j]);
        if (slow[i] + length < slow[j]) slow[j] = slow[i] + length, changed = true;
        if (slow[j] + length < slow[i]) slow[i] = slow[j] + length, changed = true;
      }
  }
  CHECK(d == slow);
}

TEST_CASE("a cube falls into its six faces") {
  Scene cube(makeCube(25));
  const auto parts = segment(cube.graph(), {}, {.parts = 6}, cube.monitor);
  for (int face = 0; face < 6; ++face) {
    std::array<int, 6> count{};
    for (int i = 0; i < 625; ++i) ++count[parts[static_cast<std::size_t>(face * 625 + i)]];
    CHECK(*std::max_element(count.begin(), count.end()) >= 619);
  }
  std::array<int, 6> size{};
  for (const std::uint8_t part : parts) ++size[part];
  for (const int s : size) CHECK(s == doctest::Approx(625).epsilon(0.05));
}

TEST_CASE("parts end where the colour changes") {
  Scene scene(makePlane(1, 1, 0.015f));
  std::vector<vec3> colours;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    const float noise = 0.04f * hashUniform(9, i);
    colours.push_back(scene.points.positions[i].x < 0.3f ? vec3(0.9f - noise, 0.2f, noise)
                                                         : vec3(noise, 0.5f - noise, 0.8f));
  }
  const auto parts = segment(scene.graph(), colours, {.parts = 2}, scene.monitor);
  std::array<std::array<int, 2>, 2> count{};
  for (std::size_t i = 0; i < parts.size(); ++i)
    ++count[scene.points.positions[i].x < 0.3f ? 0 : 1][parts[i]];
  const int left = std::max(count[0][0], count[0][1]), right = std::max(count[1][0], count[1][1]);
  CHECK(left + right > 0.96 * static_cast<double>(parts.size()));
  CHECK((count[0][0] > count[0][1]) != (count[1][0] > count[1][1]));
}

TEST_CASE("a smooth sphere falls into parts of about equal size, the same at any thread count") {
  Scene ball(makeSphere(6000, 1));
  const auto parts = segment(ball.graph(), {}, {.parts = 8}, ball.monitor);
  std::array<int, 8> size{};
  for (const std::uint8_t part : parts) ++size[part];
  for (const int s : size) {
    CHECK(s > 6000 / 8 / 3);
    CHECK(s < 6000 / 8 * 2.5);
  }
  Workers seven(7);
  Monitor monitor(seven);
  CHECK(segment(ball.graph(), {}, {.parts = 8}, monitor) == parts);
  CHECK_THROWS_AS(segment(ball.graph(), {}, {.parts = 251}, monitor), InvalidInput);
}

TEST_CASE("segmentation stops when asked to") {
  Scene ball(makeSphere(3000, 1));
  std::stop_source stop;
  stop.request_stop();
  Workers workers(1);
  Monitor monitor(workers, stop.get_token());
  CHECK_THROWS_AS(segment(ball.graph(), {}, {.parts = 3}, monitor), Cancelled);
  CHECK_THROWS_AS(connectedTo(ball.graph(), 0, monitor), Cancelled);
}
