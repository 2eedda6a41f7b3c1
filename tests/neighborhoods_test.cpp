#include "points/neighborhoods.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "points/kd_tree.h"

using namespace dapple;

namespace {

// n hashed points on the unit sphere; every 50th cluster 30 times denser than the rest.
std::vector<vec3> unevenSphere(std::size_t n) {
  std::vector<vec3> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint64_t place = i % 3 == 0 ? i % 150 : i;
    const float spread = i % 3 == 0 ? 0.02f : 0.f;
    const float z = 2 * hashUniform(1, place) - 1 + spread * hashUniform(2, i);
    const float angle = 6.2831853f * hashUniform(3, place) + spread * hashUniform(4, i);
    const float r = std::sqrt(std::max(0.f, 1 - z * z));
    points[i] = {r * std::cos(angle), r * std::sin(angle), z};
  }
  return points;
}

}  // namespace

TEST_CASE("k nearest neighbours equal a kd-tree's on uneven points, at any k and thread count") {
  const std::vector<vec3> points = unevenSphere(5000);
  const KdCloud cloud{points};
  KdTree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  tree.buildIndex();
  for (const std::size_t k : {1u, 8u, 25u, 49u}) {
    Workers workers(k % 3 + 1);
    Monitor monitor(workers);
    const Neighborhoods fast = buildNeighborhoods(points, k, monitor);
    const Neighborhoods portable = buildNeighborhoods(points, k, monitor, true);
    CHECK(fast.ids == portable.ids);
    std::vector<std::uint32_t> ids(k + 1);
    std::vector<float> distances(k + 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      tree.knnSearch(&points[i].x, k + 1, ids.data(), distances.data());
      for (std::size_t j = 0; j < k; ++j)  // the tree's first is the point itself
        REQUIRE(distanceBetween(points[i], points[fast.of(i)[j]]) == std::sqrt(distances[j + 1]));
      CHECK(std::find(fast.of(i).begin(), fast.of(i).end(), i) == fast.of(i).end());
    }
  }
}

TEST_CASE("equally far neighbours come in the order of their ids") {
  std::vector<vec3> grid;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) grid.emplace_back(x, y, 0);
  Workers workers(1);
  Monitor monitor(workers);
  const Neighborhoods near = buildNeighborhoods(grid, 8, monitor);
  const std::size_t centre = 20 * 40 + 20;
  const std::vector<Index> expected{centre - 40, centre - 1,  centre + 1,  centre + 40,
                                    centre - 41, centre - 39, centre + 39, centre + 41};
  CHECK(std::vector<Index>(near.of(centre).begin(), near.of(centre).end()) == expected);
}

TEST_CASE("many points in one place still have their neighbours") {
  std::vector<vec3> points(200, vec3(1, 2, 3));
  for (int i = 0; i < 100; ++i) points.emplace_back(i, 0, 0);
  Workers workers(2);
  Monitor monitor(workers);
  const Neighborhoods near = buildNeighborhoods(points, 20, monitor);
  for (std::size_t i = 0; i < 200; ++i)
    CHECK(distanceBetween(points[i], points[near.of(i)[19]]) == 0.f);
  CHECK(distanceBetween(points[299], points[near.of(299)[0]]) == 1.f);
}

TEST_CASE("too few points are refused with the number that is needed") {
  Workers workers(1);
  Monitor monitor(workers);
  try {
    buildNeighborhoods(std::vector<vec3>(10), 25, monitor);
    FAIL("no exception");
  } catch (const InvalidInput& error) {
    CHECK(std::string(error.what()).find("26") != std::string::npos);
  }
}

TEST_CASE("the spacing of a square grid is its step") {
  std::vector<vec3> grid;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) grid.emplace_back(0.5f * x, 0.5f * y, 0);
  Workers workers(1);
  Monitor monitor(workers);
  CHECK(meanSpacing(buildNeighborhoods(grid, 24, monitor), grid) ==
        doctest::Approx(0.5).epsilon(0.05));
}
