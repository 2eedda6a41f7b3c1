#include "points/normals.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/hash_rng.h"
#include "fixtures.h"

using namespace dapple;

TEST_CASE("normals of a sphere point outward, whichever way the fit leaves them") {
  const std::vector<vec3> points = fixtures::makeSphere(4000, 1).positions;
  Workers workers(2);
  Monitor monitor(workers);
  const Neighborhoods near = buildNeighborhoods(points, 16, monitor);
  std::vector<vec3> normals = estimateNormals(points, near, 12, monitor);
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (hashUniform(1, i) < 0.5f) normals[i] = -normals[i];
  orientNormals(points, near, normals, monitor);
  for (std::size_t i = 0; i < points.size(); ++i) REQUIRE(glm::dot(normals[i], points[i]) > 0.995f);
}

TEST_CASE("two separate spheres are both turned outward") {
  std::vector<vec3> points = fixtures::makeSphere(1000, 1).positions;
  const PointSet other = fixtures::makeSphere(1000, 1);
  for (const vec3& p : other.positions) points.push_back(p + vec3(10, 0, 0));
  Workers workers(1);
  Monitor monitor(workers);
  const Neighborhoods near = buildNeighborhoods(points, 16, monitor);
  std::vector<vec3> normals = estimateNormals(points, near, 16, monitor);
  orientNormals(points, near, normals, monitor);
  for (std::size_t i = 0; i < 2000; ++i)
    REQUIRE(glm::dot(normals[i], points[i] - vec3(i < 1000 ? 0 : 10, 0, 0)) > 0.98f);
}

TEST_CASE("smoothing takes noise along the normal away and leaves a plane alone") {
  PointSet plane;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) plane.positions.emplace_back(x, y, 0);
  plane.normals.assign(3600, vec3(0, 0, 1));
  Workers workers(1);
  Monitor monitor(workers);
  const Neighborhoods near = buildNeighborhoods(plane.positions, 25, monitor);
  const std::vector<vec3> same = smoothedPositions(plane, near, monitor);
  CHECK(same == plane.positions);
  PointSet noisy = plane;
  for (std::size_t i = 0; i < 3600; ++i) noisy.positions[i].z = hashUniform(1, i) - 0.5f;
  const std::vector<vec3> smooth =
      smoothedPositions(noisy, buildNeighborhoods(noisy.positions, 25, monitor), monitor);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < 3600; ++i) {
    before += noisy.positions[i].z * noisy.positions[i].z;
    after += smooth[i].z * smooth[i].z;
  }
  CHECK(after < before / 8);
}
