#include "points/point_set.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "base/errors.h"
#include "base/hash_rng.h"

using namespace dapple;

namespace {

std::vector<vec3> randomPoints(std::size_t n) {
  std::vector<vec3> points(n);
  for (std::size_t i = 0; i < n; ++i)
    points[i] = {hashUniform(1, i, 0), hashUniform(1, i, 1), hashUniform(1, i, 2)};
  return points;
}

std::vector<std::uint64_t> codesOf(const std::vector<vec3>& points) {
  Workers workers(2);
  Monitor monitor(workers);
  return mortonCodes(points, monitor);
}

double pathLength(const std::vector<vec3>& points, const std::vector<Index>& order) {
  double sum = 0;
  for (std::size_t i = 1; i < order.size(); ++i)
    sum += glm::distance(points[order[i]], points[order[i - 1]]);
  return sum;
}

}  // namespace

TEST_CASE("the corners of a cube come in the order of the Z curve, x fastest") {
  std::vector<vec3> corners;
  for (int i = 7; i >= 0; --i) corners.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
  CHECK(mortonOrder(corners) == std::vector<Index>{7, 6, 5, 4, 3, 2, 1, 0});
  const std::vector<std::uint64_t> codes = codesOf(corners);
  CHECK(codes[7] == 0);
  CHECK(codes[0] == (std::uint64_t{1} << 63) - 1);
  CHECK(codes[6] == 0x1249249249249249ull);  // all bits of x, none of y and z
}

TEST_CASE("a cell is a cube: the longest side of the bounds has 2^21 of them") {
  const std::vector<std::uint64_t> codes = codesOf({{0, 0, 0}, {4, 0, 0}, {0, 2, 0}});
  // Half of the grid along y is bit 20 of y, at 3 * 20 + 1.
  CHECK(codes[2] == std::uint64_t{1} << 61);
}

TEST_CASE("the order is a permutation, sorted by code, with ties by id") {
  std::vector<vec3> points = randomPoints(5000);
  for (std::size_t i = 0; i < 1000; ++i) points.push_back(points[i * 3]);
  const std::vector<Index> order = mortonOrder(points);
  const std::vector<std::uint64_t> codes = codesOf(points);
  for (std::size_t i = 1; i < order.size(); ++i) {
    const auto a = std::pair(codes[order[i - 1]], order[i - 1]);
    const auto b = std::pair(codes[order[i]], order[i]);
    REQUIRE(a < b);
  }
  std::vector<Index> sorted = order, ids(points.size());
  std::sort(sorted.begin(), sorted.end());
  std::iota(ids.begin(), ids.end(), Index{0});
  CHECK(sorted == ids);
}

TEST_CASE("neighbours along the order are near in space") {
  const std::vector<vec3> points = randomPoints(20000);
  std::vector<Index> given(points.size());
  std::iota(given.begin(), given.end(), Index{0});
  CHECK(pathLength(points, mortonOrder(points)) < 0.1 * pathLength(points, given));
}

TEST_CASE("points crowded together by one far away are sorted all the same") {
  std::vector<vec3> points = randomPoints(20000);
  for (vec3& p : points) p *= 1e-4f;
  points.emplace_back(1, 1, 1);
  const std::vector<std::uint64_t> codes = codesOf(points);
  std::vector<Index> expected(points.size());
  std::iota(expected.begin(), expected.end(), Index{0});
  std::stable_sort(expected.begin(), expected.end(),
                   [&](Index a, Index b) { return codes[a] < codes[b]; });
  CHECK(mortonOrder(points) == expected);
}

TEST_CASE("no point, one point and equal points have an order, too") {
  CHECK(mortonOrder({}).empty());
  CHECK(mortonOrder({{3, 4, 5}}) == std::vector<Index>{0});
  CHECK(mortonOrder({{3, 4, 5}, {3, 4, 5}, {3, 4, 5}}) == std::vector<Index>{0, 1, 2});
}

TEST_CASE("sorting can be stopped") {
  Workers workers(1);
  std::stop_source stop;
  stop.request_stop();
  Monitor monitor(workers, stop.get_token());
  CHECK_THROWS_AS(mortonCodes(randomPoints(10), monitor), Cancelled);
  CHECK_THROWS_AS(orderByCode(std::vector<std::uint64_t>(10), monitor), Cancelled);
}
