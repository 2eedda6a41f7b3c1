#include "app/render/camera.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "base/errors.h"

using namespace dapple;

namespace {

// Position in the picture, -1..1 to the right and upwards.
vec2 projected(const Camera& camera, vec3 p, float aspect) {
  const glm::vec4 q = viewMatrix(camera) * glm::vec4(p, 1);
  const float slope = std::tan(0.5f * camera.verticalFov);
  return {q.x / (-q.z * slope * aspect), q.y / (-q.z * slope)};
}

float depthOf(const Camera& camera, vec3 p) {
  return -(viewMatrix(camera) * glm::vec4(p, 1)).z;
}

std::vector<vec3> corners(const Bounds& b) {
  std::vector<vec3> all;
  for (float x : {b.low.x, b.high.x})
    for (float y : {b.low.y, b.high.y})
      for (float z : {b.low.z, b.high.z}) all.push_back({x, y, z});
  return all;
}

}  // namespace

TEST_CASE("bounds hold all positions and touch the outermost") {
  const Bounds b = boundsOf({{1, 2, 3}, {-1, 5, 0}, {0, 0, 0}});
  CHECK(b.low == vec3(-1, 0, 0));
  CHECK(b.high == vec3(1, 5, 3));
  CHECK(boundsOf({}).high == vec3(0));
}

TEST_CASE("every standard view holds the bounds with a margin of 4 % and no more") {
  const Bounds shapes[] = {{{-1, -1, -1}, {1, 1, 1}},
                           {{0, 0, 0}, {1.5f, 0.1f, 0.4f}},
                           {{10, -3, 7}, {10.2f, -1, 7.1f}},
                           {{-0.1f, -0.2f, -5}, {0.3f, 0.1f, 5}}};
  for (const char* name : {"front", "back", "left", "right", "top", "bottom", "iso"})
    for (const Bounds& b : shapes)
      for (float aspect : {16.f / 9, 1.f, 0.5f}) {
        CAPTURE(std::string(name));
        const Camera camera = standardView(name, b, aspect);
        float left = 2, right = -2, down = 2, up = -2;
        for (const vec3& p : corners(b)) {
          const vec2 q = projected(camera, p, aspect);
          left = std::min(left, q.x), right = std::max(right, q.x);
          down = std::min(down, q.y), up = std::max(up, q.y);
          CHECK(depthOf(camera, p) > camera.nearPlane);
          CHECK(depthOf(camera, p) < camera.farPlane);
        }
        // In the middle, and one of the two directions is used up to 4 % of 2 at each side.
        CHECK(left + right == doctest::Approx(0).epsilon(1e-3).scale(1));
        CHECK(down + up == doctest::Approx(0).epsilon(1e-3).scale(1));
        CHECK(std::max(right, up) == doctest::Approx(0.92f).epsilon(1e-3));
      }
}

TEST_CASE("framing the positions comes nearer than framing the corners of their bounds") {
  std::vector<vec3> diamond{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const Camera loose = standardView("iso", boundsOf(diamond), 1);
  const Camera tight = standardView("iso", diamond, 1);
  CHECK(depthOf(tight, vec3(0)) < 0.8f * depthOf(loose, vec3(0)));
  for (const vec3& p : diamond)
    CHECK(glm::all(glm::lessThan(glm::abs(projected(tight, p, 1)), vec2(0.9201f))));
}

TEST_CASE("the standard views look from where their names say") {
  const Bounds cube{{-1, -1, -1}, {1, 1, 1}};
  const auto rightOf = [&](const char* name) {
    return projected(standardView(name, cube, 1), vec3(0.5f, 0, 0), 1);
  };
  CHECK(standardView("front", cube, 1).eye.z > 1);
  CHECK(rightOf("front").x > 0.1f);
  CHECK(standardView("back", cube, 1).eye.z < -1);
  CHECK(rightOf("back").x < -0.1f);
  CHECK(standardView("right", cube, 1).eye.x > 1);
  CHECK(standardView("left", cube, 1).eye.x < -1);
  CHECK(standardView("top", cube, 1).eye.y > 1);
  CHECK(projected(standardView("top", cube, 1), vec3(0, 0, 0.5f), 1).y < -0.1f);
  CHECK(standardView("bottom", cube, 1).eye.y < -1);
  CHECK(projected(standardView("bottom", cube, 1), vec3(0, 0, 0.5f), 1).y > 0.1f);
  CHECK(glm::all(glm::greaterThan(standardView("iso", cube, 1).eye, vec3(1))));
}

TEST_CASE("an unknown view is refused with the list of views") {
  try {
    standardView("frnt", Bounds{}, 1);
    FAIL("no exception");
  } catch (const InvalidInput& e) {
    CHECK(std::string(e.what()).find("'frnt'") != std::string::npos);
    CHECK(std::string(e.what()).find("front, back, left, right, top, bottom, iso") !=
          std::string::npos);
  }
}

TEST_CASE("a single point still has a camera") {
  const Camera camera = standardView("front", std::vector<vec3>{{1, 2, 3}}, 1);
  CHECK(camera.nearPlane > 0);
  CHECK(depthOf(camera, {1, 2, 3}) > camera.nearPlane);
  CHECK(glm::length(projected(camera, {1, 2, 3}, 1)) < 1e-3f);
}

TEST_CASE("looking from an eye to a target encloses the bounds, straight down too") {
  const Bounds b{{-1, -1, -1}, {1, 1, 1}};
  for (vec3 eye : {vec3(3, 1, 2), vec3(0, 5, 0), vec3(0, -5, 0), vec3(0, 0, 0.5f)}) {
    const Camera camera = lookAt(eye, {0, 0, 0}, b);
    CHECK(glm::length(projected(camera, {0, 0, 0}, 1)) < 1e-5f);
    CHECK(camera.nearPlane > 0);
    for (const vec3& p : corners(b)) CHECK(depthOf(camera, p) < camera.farPlane);
  }
  CHECK_THROWS_AS(lookAt({1, 1, 1}, {1, 1, 1}, b), InvalidInput);
}
