#include "points/surface_mesh.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "base/errors.h"
#include "base/hash_rng.h"

using namespace dapple;

namespace {

// A sheet over the unit square, cut into 2 n n triangles of unequal sizes.
SurfaceMesh makeSheet(std::size_t n, std::vector<dvec3>& positions) {
  SurfaceMesh mesh;
  for (std::size_t y = 0; y <= n; ++y)
    for (std::size_t x = 0; x <= n; ++x) {
      const double u = static_cast<double>(x) / static_cast<double>(n);
      const double v = static_cast<double>(y) / static_cast<double>(n);
      positions.emplace_back(u * u, v * v * v, 0);
    }
  for (std::size_t y = 0; y < n; ++y)
    for (std::size_t x = 0; x < n; ++x) {
      const auto a = static_cast<Index>(y * (n + 1) + x), b = static_cast<Index>(a + n + 1);
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  return mesh;
}

double areaOf(const std::vector<dvec3>& p, const std::array<Index, 3>& t) {
  return glm::length(glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]])) / 2;
}

}  // namespace

TEST_CASE("normals of a cube's corners point along its diagonals, however its sides are cut") {
  std::vector<vec3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
  SurfaceMesh cube;
  const auto addSide = [&](Index a, Index b, Index c, Index d) {
    cube.triangles.push_back({a, b, c});
    cube.triangles.push_back({a, c, d});
  };
  addSide(0, 2, 3, 1);
  addSide(4, 5, 7, 6);
  addSide(0, 1, 5, 4);
  addSide(2, 6, 7, 3);
  addSide(0, 4, 6, 2);
  addSide(1, 3, 7, 5);
  const std::vector<vec3> normals = vertexNormals(corners, cube);
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK(std::abs(glm::length(normals[i]) - 1) < 1e-6f);
    // Weights by area leave each side 1 or 2 shares: never below 2 + 1 + 1 of 3 x 2.
    CHECK(glm::dot(normals[i], glm::normalize(corners[i] - vec3(0.5f))) > 0.9f);
  }
}

TEST_CASE("a large triangle outweighs a small one, and a vertex without area has no normal") {
  const std::vector<vec3> positions = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 1, 0},
                                       {0, 0, 1}, {9, 9, 9}, {8, 8, 8}};
  const SurfaceMesh mesh{{{0, 1, 2}, {0, 3, 4}, {5, 6, 5}}};
  const std::vector<vec3> normals = vertexNormals(positions, mesh);
  CHECK(glm::distance(normals[0], glm::normalize(vec3(1, 0, 9))) < 1e-6f);
  CHECK(normals[1] == vec3(0, 0, 1));
  CHECK(normals[5] == vec3(0));
}

TEST_CASE("each triangle gets its share of the samples, rounded up or down") {
  std::vector<dvec3> positions;
  const SurfaceMesh mesh = makeSheet(8, positions);
  for (const std::size_t count : {1u, 7u, 1000u, 20000u}) {
    const SurfaceSamples samples = sampleMesh(positions, mesh, count, 5);
    REQUIRE(samples.positions.size() == count);
    REQUIRE(samples.normals.size() == count);
    // Samples come triangle by triangle; each lies in the next triangle that holds it.
    std::vector<std::size_t> counts(mesh.triangles.size());
    std::size_t t = 0;
    const auto holds = [&](const dvec3& p) {
      const auto& [a, b, c] = mesh.triangles[t];
      const double parts = areaOf({p, positions[a], positions[b]}, {0, 1, 2}) +
                           areaOf({p, positions[b], positions[c]}, {0, 1, 2}) +
                           areaOf({p, positions[c], positions[a]}, {0, 1, 2});
      return parts <= areaOf(positions, mesh.triangles[t]) + 1e-12;
    };
    for (const dvec3& p : samples.positions) {
      while (t < mesh.triangles.size() && !holds(p)) ++t;
      REQUIRE(t < mesh.triangles.size());
      ++counts[t];
    }
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const double share = static_cast<double>(count) * areaOf(positions, mesh.triangles[i]);
      CHECK(std::abs(static_cast<double>(counts[i]) - share) < 1.001);
    }
  }
}

TEST_CASE("samples are uniform inside a triangle") {
  const std::vector<dvec3> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const SurfaceSamples samples = sampleMesh(positions, {{{0, 1, 2}}}, 40000, 3);
  // The four triangles that the middles of the sides make, 10000 expected in each; 16.3 is the
  // 99.9th percentile of chi-square with 3 degrees of freedom.
  std::array<double, 4> counts{};
  for (const dvec3& p : samples.positions) {
    const std::size_t part = p.x > 0.5 ? 0 : p.y > 0.5 ? 1 : p.x + p.y < 0.5 ? 2 : 3;
    ++counts[part];
    REQUIRE(p.x >= 0);
    REQUIRE(p.y >= 0);
    REQUIRE(p.x + p.y <= 1 + 1e-12);
  }
  double chiSquare = 0;
  for (const double c : counts) chiSquare += (c - 10000) * (c - 10000) / 10000;
  CHECK(chiSquare < 16.3);
  for (const vec3& n : samples.normals) REQUIRE(n == vec3(0, 0, 1));
}

TEST_CASE("a seed gives the same samples, another seed others") {
  std::vector<dvec3> positions;
  const SurfaceMesh mesh = makeSheet(4, positions);
  CHECK(sampleMesh(positions, mesh, 100, 1).positions ==
        sampleMesh(positions, mesh, 100, 1).positions);
  CHECK(sampleMesh(positions, mesh, 100, 1).positions !=
        sampleMesh(positions, mesh, 100, 2).positions);
}

TEST_CASE("triangles without an area are passed over, and alone they are refused") {
  const std::vector<dvec3> positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  const SurfaceMesh flat{{{0, 1, 2}, {1, 1, 3}}};
  CHECK_THROWS_AS(sampleMesh(positions, flat, 10, 1), InvalidInput);
  CHECK_THROWS_AS(sampleMesh(positions, {}, 10, 1), InvalidInput);
  const SurfaceMesh mixed{{{0, 1, 2}, {0, 1, 3}, {1, 1, 3}}};
  for (const vec3& n : sampleMesh(positions, mixed, 10, 1).normals) CHECK(n == vec3(0, 0, 1));
}
