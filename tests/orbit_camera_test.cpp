#include "app/render/orbit_camera.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "base/errors.h"
#include "base/hash_rng.h"

using namespace dapple;

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr Viewport kViewport{1280, 720};
const Bounds kCube{{-1, -1, -1}, {1, 1, 1}};

vec3 seenAt(const OrbitCamera& c, const vec3& p) {
  return projectPoint(c.camera(kCube), kViewport.width, kViewport.height, p);
}
float random(std::uint64_t key, std::uint64_t i, float low, float high) {
  return low + (high - low) * hashUniform(key, i);
}
vec3 randomPoint(std::uint64_t key, std::uint64_t i) {
  return {random(key, 3 * i, -1, 1), random(key, 3 * i + 1, -1, 1), random(key, 3 * i + 2, -1, 1)};
}

// Cameras as a person leaves them behind after a while.
OrbitCamera usedCamera(std::uint64_t i, bool orthographic) {
  OrbitCamera c;
  c.orthographic = orthographic;
  c.frame(kCube, kViewport);
  c.orbit({random(1, i, -900, 900), random(2, i, -300, 300)}, kViewport, OrbitStyle::Trackball);
  c.zoom(random(3, i, -5, 12), {random(4, i, 300, 900), random(5, i, 200, 500)}, kViewport);
  c.pan({random(6, i, -200, 200), random(7, i, -200, 200)}, kViewport);
  if (i % 3 == 0) c.setPivot(c.pointAtPivotDepth({random(8, i, 0, 1280), 100}, kViewport));
  return c;
}

template <class Check>
void forUsedCameras(const Check& check) {
  for (std::uint64_t i = 0; i < 40; ++i)
    for (const bool orthographic : {false, true}) {
      CAPTURE(i);
      CAPTURE(orthographic);
      check(usedCamera(i, orthographic), i);
    }
}

bool finite(const OrbitCamera& c) {
  const Camera camera = c.camera(kCube);
  const glm::mat4 view = viewMatrix(camera);
  bool good = std::isfinite(camera.nearPlane) && std::isfinite(camera.farPlane);
  for (int k = 0; k < 16; ++k) good = good && std::isfinite(view[k / 4][k % 4]);
  return good;
}

// The two agree on what they see.
void checkSame(const OrbitCamera& a, const OrbitCamera& b, float pixels) {
  for (std::uint64_t k = 0; k < 8; ++k) {
    const vec3 p = a.pointAtPivotDepth({160.f * static_cast<float>(k), 90.f * k}, kViewport);
    CHECK(glm::distance(vec2(seenAt(a, p)), vec2(seenAt(b, p))) < pixels);
  }
}

}  // namespace

TEST_CASE("projecting and unprojecting are each other's inverse, and rays hit what they aim at") {
  for (const bool orthographic : {false, true}) {
    Camera camera = lookAt({2, 1, 3}, {0.1f, 0, 0}, kCube);
    if (orthographic) camera.orthographicHeight = 2.5f;
    const PixelView view(camera, 640, 480);
    CHECK(glm::distance(vec2(view.project({0.1f, 0, 0})), vec2(320, 240)) < 1e-3f);
    const vec3 above = view.project({0.1f, 0.1f, 0}), beside = view.project({0.2f, 0, 0});
    CHECK(above.y < 239);
    CHECK(beside.x > 321);
    for (std::uint64_t i = 0; i < 50; ++i) {
      const vec3 p = randomPoint(1, i), q = view.project(p);
      CHECK(glm::distance(view.unproject(q, q.z), p) < 1e-5f);
      const Ray ray = view.rayThrough(q);
      CHECK(glm::length(ray.direction) == doctest::Approx(1));
      CHECK(glm::length(glm::cross(p - ray.origin, ray.direction)) < 1e-5f);
      CHECK(projectPoint(camera, 640, 480, p) == q);
      // A small step across the view axis at p is that many pixels.
      const vec3 step = view.project(p + 0.01f * view.right);
      CHECK(step.x - q.x == doctest::Approx(0.01f * view.pixelsPerUnit(q.z)).epsilon(1e-2));
    }
  }
}

TEST_CASE("panning keeps the point under the cursor at the pivot's depth") {
  forUsedCameras([](OrbitCamera c, std::uint64_t i) {
    const vec2 from(random(11, i, 0, 1280), random(12, i, 0, 720)),
        to(random(13, i, 0, 1280), random(14, i, 0, 720));
    const vec3 held = c.pointAtPivotDepth(from, kViewport);
    CHECK(glm::distance(vec2(seenAt(c, held)), from) < 0.5f);
    c.pan(to - from, kViewport);
    CHECK(glm::distance(vec2(seenAt(c, held)), to) < 0.5f);
  });
}

TEST_CASE("zooming keeps the surface point under the cursor, in steps and back") {
  forUsedCameras([](OrbitCamera c, std::uint64_t i) {
    const PixelView view(c.camera(kCube), kViewport.width, kViewport.height);
    const vec2 cursor(random(11, i, 0, 1280), random(12, i, 0, 720));
    const vec3 surface =
        view.unproject(cursor, view.nearest + 0.3f * (view.farthest - view.nearest));
    const float before = c.offset.z;
    for (int step = 0; step < 12; ++step) {
      c.zoom(step < 8 ? 1.5f : -2, cursor, kViewport, surface);
      CHECK(glm::distance(vec2(seenAt(c, surface)), cursor) < 0.5f);
      CHECK(seenAt(c, surface).z > 0);
    }
    CHECK(c.offset.z == doctest::Approx(before * std::pow(0.9, 4)).epsilon(1e-3));

    const vec3 atPivot = c.pointAtPivotDepth(cursor, kViewport);
    c.zoom(2, cursor, kViewport);
    CHECK(glm::distance(vec2(seenAt(c, atPivot)), cursor) < 0.5f);
  });
}

TEST_CASE("zooming has an end at both sides, and comes back from there") {
  OrbitCamera c;
  for (const float steps : {1000.f, -1000.f, 1000.f}) {
    c.zoom(steps, {100, 100}, kViewport);
    CHECK(finite(c));
    CHECK(c.offset.z > 1e-4f);
    CHECK(c.offset.z < 1e5f);
    const vec3 held = c.pointAtPivotDepth({700, 300}, kViewport);
    CHECK(glm::distance(vec2(seenAt(c, held)), vec2(700, 300)) < 0.5f);
  }
}

TEST_CASE("orbiting keeps the pivot's pixel, also when that is not the middle of the picture") {
  forUsedCameras([](OrbitCamera c, std::uint64_t i) {
    const vec3 pivot = c.pivot;
    const vec2 pixel = seenAt(c, pivot);
    for (const OrbitStyle style : {OrbitStyle::Turntable, OrbitStyle::Trackball}) {
      c.orbit({random(11, i, -500, 500), random(12, i, -500, 500)}, kViewport, style);
      CHECK(glm::distance(vec2(seenAt(c, pivot)), pixel) < 0.5f);
      CHECK(c.pivot == pivot);
    }
  });
}

TEST_CASE("the surface follows the hand when orbiting") {
  for (const OrbitStyle style : {OrbitStyle::Turntable, OrbitStyle::Trackball}) {
    OrbitCamera c;
    c.setView("front");
    const vec3 front(0, 0, 0.5f);
    const vec2 before = seenAt(c, front);
    c.orbit({40, 0}, kViewport, style);
    CHECK(seenAt(c, front).x > before.x + 10);
    c.setView("front");
    c.orbit({0, 40}, kViewport, style);
    CHECK(seenAt(c, front).y > before.y + 10);
  }
}

TEST_CASE("a full turn returns, in many small drags or in one") {
  for (const OrbitStyle style : {OrbitStyle::Turntable, OrbitStyle::Trackball})
    for (const int drags : {1, 7, 720}) {
      OrbitCamera c;
      c.orbit({100, 80}, kViewport);
      const OrbitCamera before = c;
      for (int k = 0; k < drags; ++k)
        c.orbit({1440.f / static_cast<float>(drags), 0}, kViewport, style);
      checkSame(before, c, 0.5f);
    }
}

TEST_CASE("the turntable stops at the poles, stays level and has no NaN there") {
  OrbitCamera c;
  c.orbit({200, 0}, kViewport);
  for (const float drag : {1e4f, 50.f, -1e4f, -50.f, 1e4f}) {
    c.orbit({0, drag}, kViewport);
    CHECK(finite(c));
    const vec3 back = c.orientation * vec3(0, 0, 1);
    CHECK(back.y == doctest::Approx(drag > 0 ? 1 : -1));
    for (int k = 0; k < 50; ++k) c.orbit({30, 0}, kViewport);
    CHECK(finite(c));
    CHECK((c.orientation * vec3(1, 0, 0)).y == doctest::Approx(0).scale(1));
  }
  // And it comes back down, to the horizon and no further than asked.
  c.orbit({0, -360}, kViewport);
  CHECK((c.orientation * vec3(0, 0, 1)).y == doctest::Approx(0).scale(1).epsilon(1e-3));
  CHECK((c.orientation * vec3(0, 1, 0)).y == doctest::Approx(1).epsilon(1e-3));
}

TEST_CASE("no drag is no turn, and the trackball goes over the pole") {
  OrbitCamera c;
  const OrbitCamera before = c;
  c.orbit({0, 0}, kViewport, OrbitStyle::Trackball);
  c.orbit({0, 0}, kViewport);
  checkSame(before, c, 0.01f);
  c.orbit({0, 720}, kViewport, OrbitStyle::Trackball);  // half a turn: upside down, from behind
  CHECK((c.orientation * vec3(0, 1, 0)).y == doctest::Approx(-1));
  CHECK((c.orientation * vec3(0, 0, 1)).z == doctest::Approx(-1));
}

TEST_CASE("rolling turns the picture clockwise around its middle") {
  forUsedCameras([](OrbitCamera c, std::uint64_t) {
    const vec3 p = c.pointAtPivotDepth({740, 360}, kViewport);
    c.roll(0.5f * kPi);
    CHECK(glm::distance(vec2(seenAt(c, p)), vec2(640, 460)) < 0.5f);
  });
}

TEST_CASE("the standard views are those of the command line, with any axis up") {
  for (const char* name : {"front", "back", "left", "right", "top", "bottom", "iso"}) {
    CAPTURE(name);
    OrbitCamera c = usedCamera(4, false);
    const vec3 pivot = c.pivot;
    c.setView(name);
    CHECK(c.pivot == pivot);
    const Camera standard = standardView(name, kCube, 1);
    const glm::mat3 wanted(viewMatrix(standard)), got(viewMatrix(c.camera(kCube)));
    for (int k = 0; k < 3; ++k) CHECK(glm::distance(wanted[k], got[k]) < 1e-4f);

    c.up = {0, 0, 1};
    c.setView(name);
    // y up has become z up: (x, y, z) is shown as (x, -z, y) was.
    const glm::mat3 turned(viewMatrix(c.camera(kCube)));
    const vec3 p(0.3f, 0.5f, 0.9f);
    CHECK(glm::distance(turned * vec3(p.x, -p.z, p.y), wanted * p) < 1e-4f);
  }
  OrbitCamera c;
  CHECK_THROWS_AS(c.setView("inside"), InvalidInput);
  c.up = {0, -1, 0};
  c.setView("front");
  CHECK(finite(c));
}

TEST_CASE("framing keeps the direction and shows all positions as large as they fit") {
  std::vector<vec3> positions;
  for (std::uint64_t i = 0; i < 200; ++i)
    positions.push_back(vec3(2, 1, 0) + vec3(0.3f, 0.2f, 0.4f) * randomPoint(1, i));
  forUsedCameras([&](OrbitCamera c, std::uint64_t) {
    const vec3 back = c.orientation * vec3(0, 0, 1);
    c.frame(positions, kViewport);
    CHECK(glm::distance(c.orientation * vec3(0, 0, 1), back) < 1e-5f);
    vec2 low(1e9f), high(-1e9f);
    for (const vec3& p : positions) {
      low = glm::min(low, vec2(seenAt(c, p)));
      high = glm::max(high, vec2(seenAt(c, p)));
    }
    CHECK(low.x + high.x == doctest::Approx(1280).epsilon(1e-3));
    CHECK(low.y + high.y == doctest::Approx(720).epsilon(1e-3));
    const vec2 filled = (high - low) / vec2(1280, 720);
    CHECK(std::max(filled.x, filled.y) == doctest::Approx(0.92).epsilon(2e-3));
  });
  OrbitCamera c;
  const OrbitCamera before = c;
  c.frame(std::vector<vec3>{}, kViewport);
  checkSame(before, c, 0.01f);
  c.frame(std::vector<vec3>{{1, 2, 3}}, kViewport);
  CHECK(finite(c));
  CHECK(glm::distance(vec2(seenAt(c, {1, 2, 3})), vec2(640, 360)) < 0.5f);
}

TEST_CASE("changing the projection keeps the pixels at the pivot's depth") {
  forUsedCameras([](const OrbitCamera& c, std::uint64_t) {
    OrbitCamera d = c;
    d.toggleProjection();
    checkSame(c, d, 0.5f);
    d.toggleProjection();
    checkSame(c, d, 0.01f);
  });
}

TEST_CASE("another pivot leaves the picture as it is, and the camera turns around it") {
  forUsedCameras([](const OrbitCamera& c, std::uint64_t i) {
    OrbitCamera d = c;
    const PixelView view(c.camera(kCube), kViewport.width, kViewport.height);
    const vec3 pivot = view.unproject({random(1, i, 0, 1280), random(2, i, 0, 720)}, 0.7f);
    d.setPivot(pivot);
    checkSame(c, d, 0.5f);
    const vec2 pixel = seenAt(d, pivot);
    d.orbit({77, -31}, kViewport);
    CHECK(glm::distance(vec2(seenAt(d, pivot)), pixel) < 0.5f);
  });
}

TEST_CASE("the planes enclose everything that lies before the eye") {
  forUsedCameras([](const OrbitCamera& c, std::uint64_t) {
    const Camera camera = c.camera(kCube);
    CHECK(camera.nearPlane > 0);
    CHECK(camera.farPlane > camera.nearPlane);
    for (std::uint64_t k = 0; k < 200; ++k) {
      const float depth = seenAt(c, randomPoint(9, k)).z;
      CHECK(depth < camera.farPlane);
      if (c.orthographic || depth > 0.01f * c.offset.z) CHECK(depth > camera.nearPlane);
    }
  });
  // From outside all of it, near plane not next to the eye.
  OrbitCamera c;
  c.frame(kCube, kViewport);
  const Camera camera = c.camera(kCube);
  for (const vec3& p : cornersOf(kCube)) CHECK(seenAt(c, p).z > camera.nearPlane);
  CHECK(camera.nearPlane > 0.2f * c.offset.z);
}

TEST_CASE("a transition starts and ends as asked, and a zoom keeps its point all the way") {
  forUsedCameras([](const OrbitCamera& a, std::uint64_t i) {
    const OrbitCamera b = usedCamera(i + 1, a.orthographic);
    checkSame(interpolate(a, b, 0), a, 0.01f);
    checkSame(interpolate(a, b, 1), b, 0.01f);
    checkSame(interpolate(a, b, 0.9999f), b, 2.f);
    checkSame(interpolate(a, b, 0.0001f), a, 2.f);
    CHECK(finite(interpolate(a, b, 0.37f)));

    const vec2 cursor(300, 500);
    const vec3 held = a.pointAtPivotDepth(cursor, kViewport);
    OrbitCamera near = a;
    near.zoom(6, cursor, kViewport);
    for (const float t : {0.1f, 0.5f, 0.8f}) {
      const OrbitCamera between = interpolate(a, near, t);
      CHECK(glm::distance(vec2(seenAt(between, held)), cursor) < 0.5f);
      CHECK(between.offset.z == doctest::Approx(a.offset.z * std::pow(0.9f, 6 * t)));
    }
  });
}
