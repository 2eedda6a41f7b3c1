#include "points/point_hierarchy.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/errors.h"
#include "base/hash_rng.h"

using namespace dapple;

namespace {

struct Scan {
  PointSet points;
  std::vector<TangentFrame> frames;
  Neighborhoods neighborhoods;
};

// Evenly spread points of the unit sphere, in Morton order, t towards +y.
Scan sphere(std::size_t n, std::size_t k, Monitor& monitor) {
  std::vector<vec3> raw(n);
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(n);
    const double r = std::sqrt(1 - z * z), angle = golden * static_cast<double>(i);
    raw[i] = {static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)),
              static_cast<float>(z)};
  }
  Scan scan;
  for (Index i : mortonOrder(raw)) {
    const vec3 normal = glm::normalize(raw[i]);
    const vec3 t = glm::normalize(vec3(0, 1, 0) - normal * normal.y);
    scan.points.positions.push_back(raw[i]);
    scan.points.normals.push_back(normal);
    scan.frames.push_back({glm::cross(t, normal), t, normal});
  }
  scan.neighborhoods = buildNeighborhoods(scan.points.positions, k, monitor);
  return scan;
}

void checkFrame(const TangentFrame& f) {
  REQUIRE(glm::length(f.s) == doctest::Approx(1).epsilon(1e-5));
  REQUIRE(glm::length(f.t) == doctest::Approx(1).epsilon(1e-5));
  REQUIRE(std::abs(glm::dot(f.s, f.t)) < 1e-5f);
  REQUIRE(glm::length(glm::cross(f.s, f.t) - f.n) < 1e-5f);
}

}  // namespace

TEST_CASE("every point has one parent, and that parent has it as a child once") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = sphere(6000, 16, monitor);
  const auto levels = buildHierarchy(scan.points, scan.frames, scan.neighborhoods, 5, monitor);
  REQUIRE(levels.size() == 5);
  for (std::size_t l = 0; l + 1 < levels.size(); ++l) {
    const HierarchyLevel &fine = levels[l], &coarse = levels[l + 1];
    REQUIRE(fine.parent.size() == fine.positions.size());
    std::vector<int> seen(fine.positions.size(), 0);
    std::size_t incomplete = 0;
    for (std::size_t c = 0; c < coarse.positions.size(); ++c) {
      vec3 mean(0);
      float members = 0;
      for (Index child : coarse.children[c]) {
        if (child == kNone) continue;
        ++seen[child];
        REQUIRE(fine.parent[child] == c);
        mean += fine.positions[child];
        ++members;
      }
      REQUIRE(members > 0);
      REQUIRE(glm::length(mean / members - coarse.positions[c]) < 1e-5f);
      incomplete += members < 4;
      checkFrame(coarse.frames[c]);
      REQUIRE(glm::dot(coarse.frames[c].n, glm::normalize(coarse.positions[c])) > 0.9f);
    }
    for (int count : seen) REQUIRE(count == 1);
    CHECK(incomplete <= 2 + 3 * coarse.positions.size() / 100);
    CHECK(coarse.neighborhoods.size() == coarse.positions.size());
    // Numbered by first child: a coarse level stays as well ordered in memory as the finest.
    for (std::size_t c = 1; c < coarse.children.size(); ++c) {
      REQUIRE(coarse.children[c - 1][0] < coarse.children[c][0]);
    }
  }
  CHECK(levels.back().parent.empty());
}

TEST_CASE("clusters are compact: children lie within a few spacings of their parent") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = sphere(4000, 16, monitor);
  const auto levels = buildHierarchy(scan.points, scan.frames, scan.neighborhoods, 2, monitor);
  const auto spacing = static_cast<float>(meanSpacing(scan.neighborhoods, scan.points.positions));
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const vec3 parent = levels[1].positions[levels[0].parent[i]];
    REQUIRE(glm::distance(parent, scan.points.positions[i]) < 3 * spacing);
  }
}

TEST_CASE("a hierarchy ends before a level has fewer than 16 points") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = sphere(300, 16, monitor);
  const auto levels = buildHierarchy(scan.points, scan.frames, scan.neighborhoods, 8, monitor);
  REQUIRE(levels.size() == 3);  // 300, about 75, about 19
  CHECK(levels.back().positions.size() >= 16);
}

TEST_CASE("opposite frames in one cluster still give a right-handed parent") {
  Workers workers(1);
  Monitor monitor(workers);
  Scan scan = sphere(400, 12, monitor);
  for (std::size_t i = 0; i < scan.frames.size(); ++i) {
    if (hashBelow(2, 3, i) == 0) continue;
    scan.frames[i].s = -scan.frames[i].s;
    scan.frames[i].t = -scan.frames[i].t;
  }
  const auto levels = buildHierarchy(scan.points, scan.frames, scan.neighborhoods, 2, monitor);
  for (const TangentFrame& frame : levels[1].frames) checkFrame(frame);
}

TEST_CASE("a stopped monitor ends the clustering with Cancelled") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = sphere(20000, 12, monitor);
  std::stop_source stop;
  stop.request_stop();
  Monitor stopped(workers, stop.get_token());
  CHECK_THROWS_AS(buildHierarchy(scan.points, scan.frames, scan.neighborhoods, 3, stopped),
                  Cancelled);
}
