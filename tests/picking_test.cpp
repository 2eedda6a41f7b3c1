#include "app/render/picking.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "app/render/polygon_mask.h"
#include "base/hash_rng.h"
#include "base/monitor.h"

using namespace dapple;

namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr float kPi = std::numbers::pi_v<float>;

struct Scan {
  std::vector<vec3> positions, normals;
  std::vector<float> radii;

  void add(const vec3& position, const vec3& normal, float spacing) {
    positions.push_back(position);
    normals.push_back(normal);
    radii.push_back(splatRadius(spacing));
  }
};

// n points evenly over the unit sphere, moved along their normals by up to `noise` spacings.
Scan sphere(int n, float noise = 0) {
  Scan scan;
  const float spacing = std::sqrt(4 * kPi / static_cast<float>(n));
  for (int i = 0; i < n; ++i) {
    const double y = 1 - (2.0 * i + 1) / n, r = std::sqrt(1 - y * y);
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const vec3 p(r * std::cos(angle), y, r * std::sin(angle));
    const float moved = noise * spacing * (2 * hashUniform(5, static_cast<std::uint64_t>(i)) - 1);
    scan.add((1 + moved) * p, p, spacing);
  }
  return scan;
}

struct Scene {
  Scan scan;
  Camera camera;
  Workers workers{2};
  Picker picker{workers};
  Raster traced;

  Scene(Scan points, const Camera& from, int samples = 1) : scan(std::move(points)), camera(from) {
    const std::vector<vec3> colours(scan.positions.size(), vec3(0.5f));
    CpuSplatter splatter(workers);
    splatter.update({scan.positions, scan.normals, colours, scan.radii});
    traced.trace = true;
    splatter.draw(camera, kWidth, kHeight, {.samples = samples}, traced);
    picker.update(scan.positions, scan.normals, scan.radii);
  }
  PickView seen() const { return {camera, kWidth, kHeight, &traced}; }
  PickView through() const { return {camera, kWidth, kHeight}; }

  // What the loop over all points says.
  template <class Inside>
  std::vector<Index> brute(const Inside& inside) const {
    const PixelView view(camera, kWidth, kHeight);
    std::vector<Index> all;
    for (std::size_t i = 0; i < scan.positions.size(); ++i) {
      const vec3 q = view.project(scan.positions[i]);
      if (q.z > camera.nearPlane && q.x >= 0 && q.y >= 0 && q.x < kWidth && q.y < kHeight &&
          inside(vec2(q)))
        all.push_back(static_cast<Index>(i));
    }
    return all;
  }
};

Camera frontOf(const Scan& scan, bool orthographic) {
  const float aspect = static_cast<float>(kWidth) / kHeight;
  const Camera camera = standardView("front", scan.positions, aspect);
  return orthographic ? orthographicView(camera, scan.positions, aspect) : camera;
}

// How many of both are in only one of them.
std::size_t different(const std::vector<Index>& a, const std::vector<Index>& b) {
  std::vector<Index> only;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(only));
  return only.size();
}

bool insideOf(const std::vector<vec2>& corners, vec2 p) {
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const dvec3 a(corners[i], 0), b(corners[j], 0);
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) * (b.x - a.x) / (b.y - a.y))
      inside = !inside;
  }
  return inside;
}

// A five-pointed star that crosses itself: its middle is outside by the even-odd rule.
std::vector<vec2> star(vec2 centre, float radius) {
  std::vector<vec2> corners;
  for (int i = 0; i < 5; ++i) {
    const float angle = 2 * kPi * static_cast<float>(2 * i) / 5 + 0.1f;
    corners.push_back(centre + radius * vec2(std::sin(angle), -std::cos(angle)));
  }
  return corners;
}

}  // namespace

TEST_CASE("through everything, a disc and a rectangle hold what the loop over all points holds") {
  for (const bool orthographic : {false, true}) {
    const Scan scan = sphere(30000);
    const Scene scene(scan, frontOf(scan, orthographic));
    for (const auto& [centre, radius] : {std::pair{vec2(320, 240), 60.f},
                                         {vec2(100, 200), 150.f},
                                         {vec2(650, 10), 300.f},
                                         {vec2(320, 240), 0.f}}) {
      const auto found = scene.picker.inDisc(scene.through(), centre, radius);
      CHECK(std::is_sorted(found.begin(), found.end()));
      CHECK(different(found, scene.brute([&, c = centre, r = radius](vec2 p) {
              return glm::distance(p, c) <= r;
            })) <= found.size() / 10000);
    }
    const auto found = scene.picker.inRectangle(scene.through(), {400, 300}, {250, 100});
    CHECK(found.size() > 1000);
    CHECK(different(found, scene.brute([](vec2 p) {
            return p.x >= 250 && p.y >= 100 && p.x < 400 && p.y < 300;
          })) <= 1);
  }
}

TEST_CASE("a lasso holds what the even-odd rule says, simple or crossing itself or far outside") {
  const Scan scan = sphere(30000);
  for (const bool orthographic : {false, true}) {
    const Scene scene(scan, frontOf(scan, orthographic));
    std::vector<std::vector<vec2>> outlines{star({320, 240}, 200),
                                            {{200, 100}, {420, 120}, {300, 400}},
                                            {{-900, 2000}, {300, -1000}, {330, 3000}}};
    std::vector<vec2> scribble;
    for (std::uint64_t i = 0; i < 500; ++i)
      scribble.emplace_back(800 * hashUniform(1, i) - 80, 600 * hashUniform(2, i) - 60);
    outlines.push_back(scribble);
    for (const auto& outline : outlines) {
      const auto found = scene.picker.inPolygon(scene.through(), outline);
      const auto wanted = scene.brute([&](vec2 p) { return insideOf(outline, p); });
      CHECK(wanted.size() > 500);
      CHECK(different(found, wanted) <= 2);  // floats against doubles on the outline itself
    }
    // The middle of the star is outside, its arms are inside.
    const auto found = scene.picker.inPolygon(scene.through(), star({320, 240}, 200));
    const auto middle = scene.picker.inDisc(scene.through(), {320, 240}, 60);
    CHECK(different(found, middle) == found.size() + middle.size());
  }
}

TEST_CASE("the grid of an outline agrees with the rule at every place") {
  for (const std::vector<vec2>& outline :
       {star({100, 100}, 90), std::vector<vec2>{{10, 10}, {190, 10}, {190, 11}, {10, 10.5f}},
        std::vector<vec2>{{20, 20},
                          {20, 180},
                          {180, 180},
                          {180, 20},
                          {20, 20},
                          {60, 60},
                          {60, 120},
                          {120, 120},
                          {120, 60},
                          {60, 60}},
        star({100, 100}, 9000), star({-40, 100}, 90)}) {
    const PolygonMask mask(outline, 200, 200);
    std::size_t wrong = 0;
    for (std::uint64_t i = 0; i < 50000; ++i) {
      const vec2 p(200 * hashUniform(3, i), 200 * hashUniform(4, i));
      const bool maybe =
          glm::all(glm::greaterThanEqual(p, mask.low())) && glm::all(glm::lessThan(p, mask.high()));
      wrong += (maybe && mask.contains(p)) != insideOf(outline, p);
    }
    CHECK(wrong <= 1);
  }
}

TEST_CASE("an outline without an inside holds nothing") {
  const Scan scan = sphere(2000);
  const Scene scene(scan, frontOf(scan, false));
  const float nan = std::nanf("");
  for (const std::vector<vec2>& outline : {std::vector<vec2>{},
                                           {{300, 200}},
                                           {{300, 200}, {400, 200}},
                                           {{-5, -5}, {-1, -9}, {-9, -1}},
                                           {{nan, 0}, {300, nan}, {nan, nan}, {1, 1}}})
    CHECK(scene.picker.inPolygon(scene.through(), outline).empty());
}

TEST_CASE("what is seen of a sphere in a disc is its front cap, every point of it") {
  for (const bool orthographic : {false, true})
    for (const float noise : {0.f, 0.4f})
      for (const int samples : {1, 2}) {
        CAPTURE(orthographic);
        CAPTURE(noise);
        CAPTURE(samples);
        const Scan scan = sphere(40000, noise);
        const Scene scene(scan, frontOf(scan, orthographic), samples);
        const PixelView view(scene.camera, kWidth, kHeight);
        for (const float radius : {30.f, 120.f, 200.f}) {
          const auto found = scene.picker.inDisc(scene.seen(), {320, 240}, radius);
          const auto wanted = scene.brute([&](vec2 p) {
            return glm::distance(p, {320, 240}) <= radius;
          });
          std::size_t front = 0, missed = 0, behind = 0;
          for (const Index i : wanted) {
            const bool isFront = glm::dot(scan.normals[i], view.towardsEye(scan.positions[i])) > 0;
            front += isFront;
            const bool isFound = std::binary_search(found.begin(), found.end(), i);
            missed += isFront && !isFound;
            behind += !isFront && isFound;
          }
          CHECK(front > 100);
          CHECK(missed == 0);
          CHECK(behind == 0);
          // Analytic: of a disc of that radius the share of the sphere, with a ring a spacing wide.
          if (!orthographic) continue;
          const float unit = radius / view.pixelsPerUnit(1);
          const float share = 0.5f * (1 - std::sqrt(1 - unit * unit));
          const float ring = std::sqrt(4 * kPi * 40000) * unit;
          CHECK(std::abs(static_cast<float>(found.size()) - 40000 * share) < ring);
        }
      }
}

TEST_CASE("a brush over the whole picture takes the front and a ring no wider than a few splats") {
  const Scan scan = sphere(40000);
  const Scene scene(scan, frontOf(scan, false));
  const PixelView view(scene.camera, kWidth, kHeight);
  const auto found = scene.picker.inDisc(scene.seen(), {320, 240}, 1000);
  std::size_t missed = 0, beyond = 0;
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    const float facing = glm::dot(scan.normals[i], view.towardsEye(scan.positions[i]));
    const bool isFound = std::binary_search(found.begin(), found.end(), static_cast<Index>(i));
    missed += facing > 0.02f && !isFound;
    beyond += facing < -0.3f && isFound;
  }
  CHECK(missed == 0);
  CHECK(beyond == 0);
}

TEST_CASE("far away, where a pixel holds many points, the front is taken and not the back") {
  const Scan scan = sphere(40000);
  Camera camera = frontOf(scan, false);
  camera.eye *= 20;
  camera.farPlane *= 20;
  const Scene scene(scan, camera);
  const PixelView view(scene.camera, kWidth, kHeight);
  const auto found = scene.picker.inDisc(scene.seen(), {320, 240}, 100);
  std::size_t missed = 0, behind = 0;
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    const float facing = glm::dot(scan.normals[i], view.towardsEye(scan.positions[i]));
    const bool isFound = std::binary_search(found.begin(), found.end(), static_cast<Index>(i));
    missed += facing > 0.3f && !isFound;
    behind += facing < -0.5f && isFound;
  }
  CHECK(missed == 0);
  CHECK(behind == 0);
}

TEST_CASE("of a thin wall the near side is taken alone, from either side and without normals too") {
  Scan wall;
  for (const float side : {1.f, -1.f})
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 100; ++x)
        wall.add({0.02f * x - 1, 0.02f * y - 1, 0.015f * side}, {0, 0, side}, 0.02f);
  for (const float eye : {4.f, -4.f}) {
    const Scene scene(wall, lookAt({0, 0, eye}, {0, 0, 0}, boundsOf(wall.positions)));
    const auto found = scene.picker.inDisc(scene.seen(), {320, 240}, 80);
    CHECK(found.size() > 100);
    for (const Index i : found) REQUIRE((i < 10000) == (eye > 0));
    const auto both = scene.picker.inDisc(scene.through(), {320, 240}, 80);
    CHECK(both.size() == doctest::Approx(2 * found.size()).epsilon(0.05));
  }
  // A single sheet is seen from behind, too.
  Scan sheet;
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) sheet.add({0.02f * x - 1, 0.02f * y - 1, 0}, {0, 0, 1}, 0.02f);
  const Scene scene(sheet, lookAt({1, 0.3f, -3}, {0, 0, 0}, boundsOf(sheet.positions)));
  CHECK(scene.picker.inDisc(scene.seen(), {320, 240}, 80) ==
        scene.picker.inDisc(scene.through(), {320, 240}, 80));
}

TEST_CASE("the point under a pixel is the one whose splat is seen there") {
  const Scan scan = sphere(5000);
  for (const bool orthographic : {false, true}) {
    const Scene scene(scan, frontOf(scan, orthographic));
    const PixelView view(scene.camera, kWidth, kHeight);
    for (std::uint64_t i = 0; i < 200; ++i) {
      const float angle = 2 * kPi * hashUniform(1, i), radius = 200 * std::sqrt(hashUniform(2, i));
      const vec2 pixel = vec2(320, 240) + radius * vec2(std::cos(angle), std::sin(angle));
      const auto picked = scene.picker.pointAt(scene.seen(), pixel, 0),
                 untraced = scene.picker.pointAt(scene.through(), pixel, 0);
      REQUIRE(picked);
      REQUIRE(untraced);
      const float splat = scan.radii[0] * view.pixelsPerUnit(view.project(picked->position).z);
      for (const auto& p : {picked, untraced}) {
        CHECK(glm::distance(vec2(view.project(scan.positions[p->point])), pixel) < splat + 1);
        CHECK(scan.positions[p->point].z > 0);
        CHECK(glm::dot(p->normal, scan.normals[p->point]) == doctest::Approx(1));
      }
      // On the surface, under the pixel.
      CHECK(glm::distance(vec2(view.project(picked->position)), pixel) < 0.01f);
      CHECK(glm::length(picked->position) == doctest::Approx(1).epsilon(0.01));
    }
  }
}

TEST_CASE("beside everything the nearest point within the tolerance is taken, or none") {
  Scan scan;
  scan.add({0, 0, 0}, {0, 0, 1}, 0.01f);
  scan.add({0.5f, 0, 0}, {0, 0, 0}, 0.01f);
  const Scene scene(scan, {.eye = {0, 0, 3}, .target = {0, 0, 0}});
  for (const PickView& view : {scene.seen(), scene.through()}) {
    const vec2 second = projectPoint(scene.camera, kWidth, kHeight, scan.positions[1]);
    CHECK(!scene.picker.pointAt(view, {320, 260}, 5));
    // Where a window says that the cursor is when there is none.
    const float far = std::numeric_limits<float>::max(), none = std::nanf("");
    for (const vec2 nowhere : {vec2(-far), vec2(far, 260), vec2(none, 260), vec2(320, none)})
      CHECK(!scene.picker.pointAt(view, nowhere, 5));
    CHECK(scene.picker.pointAt(view, {320, 260}, 25)->point == 0);
    const auto picked = scene.picker.pointAt(view, second + vec2(12, 0), 20);
    REQUIRE(picked);
    CHECK(picked->point == 1);
    CHECK(picked->position == scan.positions[1]);
    CHECK(picked->normal.z > 0.9f);  // without a normal: towards the eye
    CHECK(scene.picker.pointAt(view, 0.4f * vec2(320, 240) + 0.6f * second, 1000)->point == 1);
    CHECK(!scene.picker.pointAt(view, {-500, 9000}, 10));
  }
}

TEST_CASE("a ball holds the points of the surface around a place, and only what is connected") {
  Scan scan = sphere(20000);
  const std::size_t n = scan.positions.size();
  for (std::size_t i = 0; i < n; ++i)  // a second sphere inside, as the other side of a wall
    scan.add(0.97f * scan.positions[i], -scan.normals[i], 0.025f);
  const Scene scene(scan, frontOf(scan, false));
  Monitor monitor(const_cast<Workers&>(scene.workers));
  const Neighborhoods neighborhoods = buildNeighborhoods(scan.positions, 16, monitor);
  const auto picked = scene.picker.pointAt(scene.seen(), {320, 240}, 0);
  REQUIRE(picked);
  const float radius = 0.3f;
  const auto both = scene.picker.inBall({picked->position, radius});
  std::vector<Index> wanted, outer;
  for (std::size_t i = 0; i < scan.positions.size(); ++i)
    if (glm::distance(scan.positions[i], picked->position) <= radius) {
      wanted.push_back(static_cast<Index>(i));
      if (i < n) outer.push_back(static_cast<Index>(i));
    }
  CHECK(different(both, wanted) <= 1);
  CHECK(outer.size() < wanted.size() - 300);
  const auto connected =
      scene.picker.inBall({picked->position, radius, picked->point, &neighborhoods});
  CHECK(different(connected, outer) <= 1);
  const PickView view = scene.seen();
  CHECK(different(scene.picker.inBall({picked->position, radius}, &view), outer) <= 1);
  // 4 pi r^2 n share of a cap of that chord: (r / 2)^2.
  CHECK(outer.size() == doctest::Approx(n * radius * radius / 4).epsilon(0.05));
}

TEST_CASE("picking gives the same points on 1, 2 and 3 threads") {
  const Scan scan = sphere(100000);
  const Scene scene(scan, frontOf(scan, false));
  for (const unsigned threads : {1u, 3u}) {
    Workers workers(threads);
    Picker picker(workers);
    picker.update(scan.positions, scan.normals, scan.radii);
    CHECK(picker.inPolygon(scene.seen(), star({320, 240}, 300)) ==
          scene.picker.inPolygon(scene.seen(), star({320, 240}, 300)));
    CHECK(picker.inBall({vec3(0, 0, 1), 0.5f}) == scene.picker.inBall({vec3(0, 0, 1), 0.5f}));
  }
}

TEST_CASE("points that are not drawn are not picked, through neither") {
  Scan scan = sphere(3000);
  for (std::size_t i = 0; i < scan.radii.size(); ++i)
    if (scan.positions[i].x > 0) scan.radii[i] = 0;
  const Camera camera = standardView("front", Bounds{vec3(-1), vec3(1)}, 4.f / 3);
  Scene scene(scan, camera);
  const PickView through{camera, kWidth, kHeight};
  const vec2 middle(kWidth / 2, kHeight / 2);
  for (const auto& found : {scene.picker.inDisc(through, middle, kWidth),
                            scene.picker.inDisc(scene.seen(), middle, kWidth),
                            scene.picker.inRectangle(through, {0, 0}, {kWidth, kHeight}),
                            scene.picker.inBall({vec3(0), 2})}) {
    CHECK(found.size() > 500);
    for (const Index i : found) CHECK(scan.positions[i].x <= 0);
  }
  CHECK_FALSE(scene.picker.pointAt(through, middle + vec2(100, 0), 5).has_value());
}

TEST_CASE("without points nothing is picked") {
  const Scene scene(Scan{}, Camera{});
  CHECK(!scene.picker.pointAt(scene.seen(), {1, 1}, 10));
  CHECK(scene.picker.inDisc(scene.through(), {1, 1}, 10).empty());
  CHECK(scene.picker.inBall({vec3(0), 1}).empty());
}
