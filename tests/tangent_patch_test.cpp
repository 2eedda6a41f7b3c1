#include "points/tangent_patch.h"

#include <doctest/doctest.h>

#include <cmath>

#include "fixtures.h"

using namespace dapple;

TEST_CASE("on a plane the tangent patch is the plane itself") {
  const PointSet plane = fixtures::makePlane(40, 40, 1);
  const Neighborhoods neighborhoods = fixtures::neighbourhoods(plane);
  TangentPatch patch(plane, neighborhoods, 14);
  Index centre = 0;
  for (Index i = 0; i < plane.size(); ++i)
    if (glm::length(plane.positions[i] - vec3(20, 20, 0)) <
        glm::length(plane.positions[centre] - vec3(20, 20, 0)))
      centre = i;
  const float angle = 0.7f;
  const TangentFrame frame{
      {std::cos(angle), std::sin(angle), 0}, {-std::sin(angle), std::cos(angle), 0}, {0, 0, 1}};
  const auto flat = patch.grow(centre, frame, 12);
  CHECK(flat.front().id == centre);
  std::size_t inside = 0;
  for (const vec3& p : plane.positions) inside += glm::length(p - plane.positions[centre]) <= 11.9f;
  CHECK(flat.size() >= inside);
  for (const FlatPoint& f : flat) {
    const vec3 offset = plane.positions[f.id] - plane.positions[centre];
    const vec2 expected(glm::dot(offset, frame.s), glm::dot(offset, frame.t));
    REQUIRE(glm::length(f.position - expected) < 1e-3f);
  }
}

TEST_CASE("on a sphere distances and directions from the centre are those of great circles") {
  const float radius = 30;
  const PointSet sphere = fixtures::makeSphere(11310, radius);  // spacing 1
  const Neighborhoods neighborhoods = fixtures::neighbourhoods(sphere);
  const auto frames = fixtures::uprightFrames(sphere);
  TangentPatch patch(sphere, neighborhoods, 14);
  for (const Index centre : {Index{100}, Index{5000}, Index{11000}}) {
    const auto flat = patch.grow(centre, frames[centre], 25);
    CHECK(flat.size() > 1500);
    for (const FlatPoint& f : flat) {
      const vec3 n = sphere.normals[centre], m = sphere.normals[f.id];
      const float arc = radius * std::acos(std::min(1.0f, glm::dot(n, m)));
      REQUIRE(std::abs(glm::length(f.position) - arc) < 0.03f * arc + 0.02f);
      if (arc < 2) continue;
      const vec3 away = glm::normalize(m - glm::dot(n, m) * n);
      const vec2 direction(glm::dot(away, frames[centre].s), glm::dot(away, frames[centre].t));
      REQUIRE(glm::dot(direction, glm::normalize(f.position)) > 0.998f);
    }
  }
}

TEST_CASE("the two sides of a thin sheet stay apart") {
  PointSet sheet = fixtures::makePlane(30, 30, 1);
  const std::size_t half = sheet.size();
  for (std::size_t i = 0; i < half; ++i) {
    sheet.positions.push_back(sheet.positions[i] - vec3(0, 0, 0.3f));
    sheet.normals.push_back(-sheet.normals[i]);
  }
  const Neighborhoods neighborhoods = fixtures::neighbourhoods(sheet, 24);
  TangentPatch patch(sheet, neighborhoods, 24);
  const auto flat = patch.grow(static_cast<Index>(half / 2), {}, 10);
  CHECK(flat.size() > 100);
  for (const FlatPoint& f : flat) CHECK(f.id < half);
}

TEST_CASE("coinciding points share one place") {
  PointSet plane = fixtures::makePlane(20, 20, 1);
  const std::size_t twin = plane.size();
  plane.positions.push_back(plane.positions[twin / 2]);
  plane.normals.push_back(plane.normals[twin / 2]);
  const Neighborhoods neighborhoods = fixtures::neighbourhoods(plane);
  TangentPatch patch(plane, neighborhoods, 14);
  const auto flat = patch.grow(static_cast<Index>(twin / 2), {}, 5);
  bool seen = false;
  for (const FlatPoint& f : flat) {
    if (f.id != twin) continue;
    seen = true;
    CHECK(glm::length(f.position) < 1e-5f);
  }
  CHECK(seen);
}
