#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>

#include "base/errors.h"
#include "document/options_table.h"
#include "fixtures.h"
#include "same_maps.h"
#include "synthesis/grid_matching.h"
#include "synthesis/grid_neighborhood.h"
#include "synthesis/surface_order.h"

using namespace dapple;
using dapple::testing::sameMaps;

namespace {

struct Scene {
  PointSet points;
  Swatch swatch;
  float unit = 1;
  Neighborhoods near = fixtures::neighbourhoods(points, 16);
  std::vector<TangentFrame> frames = fixtures::uprightFrames(points);

  SynthesisInput input(std::span<const Index> starts = {}) const {
    return {.points = points,
            .neighborhoods = near,
            .swatch = swatch,
            .frames = frames,
            .unit = unit,
            .starts = starts};
  }

  struct Result {
    SourceMap map;
    GridStatistics statistics;
  };
  Result run(const GridOptions& options, std::span<const Index> starts = {},
             unsigned threads = 1) const {
    Workers workers(threads);
    Monitor monitor(workers);
    Result result{emptySourceMap(points.size(), unit), {}};
    result.statistics = matchGrid(input(starts), options, result.map, monitor);
    return result;
  }
};

// Unit spacing, one point a swatch pixel.
Scene plane(int side, float jitter, Swatch swatch) {
  return {fixtures::makePlane(static_cast<float>(side), static_cast<float>(side), 1, jitter),
          std::move(swatch)};
}

PointSet joined(PointSet a, const PointSet& b, vec3 moved) {
  for (std::size_t i = 0; i < b.size(); ++i) {
    a.positions.push_back(b.positions[i] + moved);
    a.normals.push_back(b.normals[i]);
  }
  return a;
}

// From b to a across the borders of a swatch that tiles.
vec2 around(const Swatch& swatch, vec2 a, vec2 b) {
  const vec2 size(swatch.width, swatch.height), d = a - b;
  return d - size * glm::round(d / size);
}

std::vector<Index> byOrder(const SourceMap& map) {
  std::vector<Index> ids(map.order.size());
  for (Index i = 0; i < ids.size(); ++i) ids[map.order[i]] = i;
  return ids;
}

Index nearestTo(const PointSet& points, vec3 position) {
  Index best = 0;
  for (Index i = 0; i < points.size(); ++i)
    if (distanceBetween(points.positions[i], position) <
        distanceBetween(points.positions[best], position))
      best = i;
  return best;
}

// Dijkstra over the links of surfaceOrder(), both ways.
std::vector<float> shortestWays(const Scene& scene, Index start) {
  const std::size_t n = scene.points.size();
  std::vector<std::vector<Index>> links(n);
  for (Index i = 0; i < n; ++i)
    for (const Index j : scene.near.of(i).first(8)) links[i].push_back(j), links[j].push_back(i);
  std::vector<float> distance(n, std::numeric_limits<float>::infinity());
  using Entry = std::pair<float, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  distance[start] = 0;
  for (queue.push({0.f, start}); !queue.empty();) {
    const auto [d, i] = queue.top();
    queue.pop();
    if (d > distance[i]) continue;
    for (const Index j : links[i]) {
      const float far = d + distanceBetween(scene.points.positions[i], scene.points.positions[j]);
      if (far < distance[j]) queue.push({distance[j] = far, j});
    }
  }
  return distance;
}

}  // namespace

TEST_CASE("grid: from one start a plane is a verbatim copy of the swatch, in every mode") {
  for (const float jitter : {0.f, 0.7f}) {
    const Scene scene = plane(40, jitter, fixtures::swatchOf(fixtures::blobs(30)));
    for (const GridAssign assign : {GridAssign::Single, GridAssign::Multi})
      for (const bool seams : {false, true}) {
        const auto [map, statistics] = scene.run({.size = 9, .assign = assign, .seams = seams});
        CHECK(statistics.meanError < (jitter > 0 ? 1e-3 : 1e-6));
        const vec3 p0 = scene.points.positions[0];
        for (std::size_t i = 0; i < scene.points.size(); ++i) {
          const vec3 step = scene.points.positions[i] - p0;
          const vec2 expected = map.texel[0] + vec2(step.x, -step.y);
          REQUIRE(glm::length(around(scene.swatch, map.texel[i], expected)) < 0.02f);
          REQUIRE(map.state[i] == PointState::Matched);
        }
      }
  }
}

TEST_CASE("grid: points of one square keep their exact offsets from its centre") {
  const Scene scene = plane(36, 0.8f, fixtures::swatchOf(fixtures::noise(48)));
  for (const bool seams : {false, true}) {
    const auto [map, statistics] = scene.run({.size = 11, .coherent = false, .seams = seams});
    REQUIRE(map.placement.size() == statistics.matches);
    std::vector<Index> centre(statistics.matches, kNone);
    for (Index i = 0; i < map.patch.size(); ++i)
      if (map.domain[i] == vec2(0)) centre[map.patch[i]] = i;
    std::size_t compared = 0;
    for (std::size_t i = 0; i < map.patch.size(); ++i) {
      const Index patch = map.patch[i];
      REQUIRE(patch < statistics.matches);
      REQUIRE(map.texel[i] == wrapTexel(scene.swatch, map.domain[i] + map.placement[patch]));
      REQUIRE(std::max(std::abs(map.domain[i].x), std::abs(map.domain[i].y)) <= 5.5f);
      if (centre[patch] == kNone) continue;  // the cut gave it to another square
      const vec3 step = scene.points.positions[i] - scene.points.positions[centre[patch]];
      REQUIRE(glm::length(map.domain[i] - vec2(step.x, -step.y)) < 1e-4f);
      ++compared;
    }
    CHECK(compared > scene.points.size() / 2);
  }
}

TEST_CASE("grid: points are matched in the order of their distance from the start") {
  const Scene scene = plane(24, 0.8f, fixtures::swatchOf(fixtures::noise(24)));
  const Index start = nearestTo(scene.points, {5, 17, 0});
  const std::vector<float> ways = shortestWays(scene, start);
  const auto [map, statistics] =
      scene.run({.size = 5, .assign = GridAssign::Single}, std::array{start});
  const std::vector<Index> order = byOrder(map);
  CHECK(order[0] == start);
  for (std::size_t r = 1; r < order.size(); ++r)
    REQUIRE(ways[order[r]] >= ways[order[r - 1]] * (1 - 1e-5f));
  // Squares too: their centres.
  const auto multi = scene.run({.size = 5, .seams = false}, std::array{start});
  float last = 0;
  Index patch = kNone;
  for (const Index i : byOrder(multi.map)) {
    if (multi.map.patch[i] == patch) continue;
    patch = multi.map.patch[i];
    REQUIRE(ways[i] >= last * (1 - 1e-5f));
    last = ways[i];
  }
}

TEST_CASE("surface order: every point once, one side of a thin sheet after the other") {
  const PointSet square = fixtures::makePlane(16, 16, 1, 0.8f);
  PointSet sheet = joined(square, square, {0, 0, -0.3f});
  const std::size_t n = square.size();
  for (std::size_t i = n; i < 2 * n; ++i) sheet.normals[i] = {0, 0, -1};
  Workers workers(1);
  Monitor monitor(workers);
  const Neighborhoods near = fixtures::neighbourhoods(sheet, 16);
  const std::array start{static_cast<Index>(n + 3)};
  const std::vector<Index> order = surfaceOrder(sheet, near, start, 1, monitor);
  REQUIRE(order.size() == 2 * n);
  CHECK(order[0] == start[0]);
  for (std::size_t r = 0; r < n; ++r) REQUIRE(order[r] >= n);
  std::vector<Index> sorted(order);
  std::sort(sorted.begin(), sorted.end());
  for (Index i = 0; i < 2 * n; ++i) REQUIRE(sorted[i] == i);
  // Without a start the seed decides.
  const std::vector<Index> other = surfaceOrder(sheet, near, {}, 1, monitor);
  CHECK(other == surfaceOrder(sheet, near, {}, 1, monitor));
  CHECK(other != surfaceOrder(sheet, near, {}, 2, monitor));
}

TEST_CASE("grid: points sparser than pixels show the swatch filtered, with and without cuts") {
  const Scene scene = {fixtures::makePlane(40, 40, 1, 0.8f),
                       fixtures::swatchOf(fixtures::noise(48)), 0.4f};
  const std::vector<float> spacing = localSpacing(scene.near, scene.points.positions);
  for (const bool seams : {false, true}) {
    const auto [map, statistics] = scene.run({.size = 11, .seams = seams});
    for (std::size_t i = 0; i < map.texel.size(); ++i)
      REQUIRE(map.colour[i] ==
              sampleSwatch(scene.swatch, map.texel[i], filterLevel(spacing[i], scene.unit)));
  }
}

TEST_CASE("grid: single colours one point a match, multi many") {
  const Scene scene = plane(30, 0.8f, fixtures::swatchOf(fixtures::noise(32)));
  const auto single = scene.run({.size = 9, .assign = GridAssign::Single});
  CHECK(single.statistics.matches == scene.points.size());
  const auto multi = scene.run({.size = 9});
  CHECK(multi.statistics.matches * 8 < scene.points.size());
  for (const auto& result : {single, multi}) {
    std::vector<Index> ranks(result.map.order);
    std::sort(ranks.begin(), ranks.end());
    for (Index r = 0; r < ranks.size(); ++r) REQUIRE(ranks[r] == r);
  }
}

TEST_CASE("grid: the same bytes at 1 and 3 threads and again, others for another seed") {
  const Scene scene = {fixtures::makeSphere(4500, 19), fixtures::swatchOf(fixtures::blobs(32))};
  for (const GridAssign assign : {GridAssign::Single, GridAssign::Multi}) {
    GridOptions options{.size = 7, .assign = assign};
    const auto one = scene.run(options);
    for (const unsigned threads : {1u, 3u})
      CHECK(sameMaps(one.map, scene.run(options, {}, threads).map));
    options.seed = 2;
    CHECK(!sameMaps(one.map, scene.run(options).map));
  }
}

TEST_CASE("grid: no texel is outside a swatch that does not tile, or on a transparent part") {
  Image holed{40, 40, 4, std::vector<float>(40 * 40 * 4, 1.f)};
  const Image noise = fixtures::noise(40);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      for (int c = 0; c < 3; ++c) holed.at(x, y, c) = noise.at(x, y, c);
      if (std::hypot(x - 12, y - 25) < 6) holed.at(x, y, 3) = 0;
    }
  // The last is smaller than the square.
  for (const Image& image : {noise, holed, fixtures::noise(12)}) {
    const Scene scene = plane(30, 0.8f, fixtures::swatchOf(image, Tileable::No));
    REQUIRE(!scene.swatch.tileable);
    for (const GridAssign assign : {GridAssign::Single, GridAssign::Multi}) {
      const auto [map, statistics] = scene.run({.size = 15, .assign = assign});
      for (std::size_t i = 0; i < map.texel.size(); ++i) {
        REQUIRE(map.state[i] == PointState::Matched);
        REQUIRE(usableTexel(scene.swatch, map.texel[i]));
      }
    }
  }
}

TEST_CASE("grid: every part of a scan has a start of its own, the user's comes first") {
  const PointSet square = fixtures::makePlane(16, 16, 1, 0.8f);
  const Scene scene = {joined(square, square, {100, 0, 0}),
                       fixtures::swatchOf(fixtures::noise(24))};
  const auto n = static_cast<Index>(square.size());
  for (const Index start : {Index{7}, static_cast<Index>(n + 30)}) {
    const auto [map, statistics] = scene.run({.size = 7}, std::array{start});
    const std::vector<Index> order = byOrder(map);
    CHECK(order[0] == start);
    for (Index r = 0; r < n; ++r) REQUIRE((order[r] < n) == (start < n));
    for (const PointState state : map.state) REQUIRE(state == PointState::Matched);
  }
  const std::array both{Index{7}, static_cast<Index>(n + 30)};
  const auto [map, statistics] = scene.run({.size = 7}, both);
  CHECK(map.order[both[0]] == 0);
  CHECK(map.patch[both[1]] == 1);
  CHECK_THROWS_AS(scene.run({}, std::array{static_cast<Index>(2 * n)}), InvalidInput);
}

TEST_CASE("grid: a node takes the nearest point, and none across a hole") {
  Scene whole = plane(24, 0, fixtures::swatchOf(fixtures::noise(24)));
  PointSet left;  // without a band of 3 columns
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    const vec3 p = whole.points.positions[i];
    if (p.x > 13 && p.x < 16) continue;
    left.positions.push_back(p);
    left.normals.push_back(whole.points.normals[i]);
  }
  const Scene scene = {left, whole.swatch};
  const SynthesisInput input = scene.input();
  GridNeighborhood grid(input, 9, 0);
  const Index centre = nearestTo(scene.points, {11.5f, 11.5f, 0});
  grid.gather(centre);
  REQUIRE(grid.points()[0].id == centre);
  std::size_t empty = 0;
  for (std::size_t node = 0; node < 81; ++node) {
    const vec2 at(static_cast<float>(node % 9) - 4, static_cast<float>(node / 9) - 4);
    const Index p = grid.nodes()[node];
    if (p == kNone) {
      ++empty;
      REQUIRE(at.x >= 2);
      continue;
    }
    REQUIRE(glm::length(grid.points()[p].offset - at) < 1e-4f);
    const vec3 step = scene.points.positions[grid.points()[p].id] - scene.points.positions[centre];
    REQUIRE(glm::length(vec2(step.x, -step.y) - at) < 1e-4f);
  }
  CHECK(empty == 9 * 3);
}

TEST_CASE("grid: at most as many neighbours as asked for, the nearest") {
  const Scene scene = plane(24, 0.5f, fixtures::swatchOf(fixtures::noise(24)));
  const SynthesisInput input = scene.input();
  GridNeighborhood all(input, 9, 0), some(input, 9, 20);
  const Index centre = nearestTo(scene.points, {12, 12, 0});
  all.gather(centre), some.gather(centre);
  REQUIRE(some.points().size() == 21);
  CHECK(all.points().size() > 1.8 * 81 * 0.8);
  CHECK(some.points()[0].id == centre);
  float furthest = 0;
  for (const GridPoint& point : some.points())
    furthest = std::max(furthest, glm::length(point.offset));
  std::size_t nearer = 0;
  for (const GridPoint& point : all.points()) nearer += glm::length(point.offset) < furthest;
  CHECK(nearer == 20);
}

TEST_CASE("grid: a sphere's far side and distances are kept") {
  const Scene scene = {fixtures::makeSphere(4000, 8), fixtures::swatchOf(fixtures::noise(24)),
                       0.5f};
  const SynthesisInput input = scene.input();
  GridNeighborhood grid(input, 31, 0);
  grid.gather(5);
  const vec3 p = scene.points.positions[5], n = scene.points.normals[5];
  for (const GridPoint& point : grid.points().subspan(1)) {
    const vec3 q = scene.points.positions[point.id];
    REQUIRE(glm::dot(scene.points.normals[point.id], n) > 0);
    REQUIRE(glm::length(point.offset) ==
            doctest::Approx(distanceBetween(p, q) / 0.5f).epsilon(1e-4));
  }
}

TEST_CASE("grid: the cut never makes seams more expensive") {
  const Scene scene = {fixtures::makeSphere(9000, 27), fixtures::swatchOf(fixtures::blobs(48))};
  const auto [map, statistics] = scene.run({.size = 15, .coherent = false});
  CHECK(statistics.seams.energyBefore > 0);
  CHECK(statistics.seams.energyAfter < 0.8 * statistics.seams.energyBefore);
  CHECK(statistics.seams.stranded == 0);
}

TEST_CASE("grid: stopping throws Cancelled at any moment") {
  const Scene scene = plane(40, 0.8f, fixtures::swatchOf(fixtures::noise(32)));
  Workers workers(2);
  for (const bool early : {true, false}) {
    std::stop_source stop;
    if (early) stop.request_stop();
    Monitor monitor(workers, stop.get_token(),
                    {.preview = [&](const Preview&) { stop.request_stop(); }});
    SourceMap map = emptySourceMap(scene.points.size(), 1);
    CHECK_THROWS_AS(matchGrid(scene.input(), {.assign = GridAssign::Single}, map, monitor),
                    Cancelled);
  }
}

TEST_CASE("grid: an impossible size is refused by name") {
  const Scene scene = plane(8, 0, fixtures::swatchOf(fixtures::noise(24)));
  for (const int size : {-3, 0, 1, 10, 20, 33})
    CHECK_THROWS_WITH_AS(scene.run({.size = size}), doctest::Contains("odd number from 3 to 31"),
                         InvalidInput);
  CHECK_THROWS_AS(scene.run({.neighbours = -1}), InvalidInput);
  TextureOptions options;
  for (const char* text : {"20", "1", "33", "9.5"})
    CHECK_THROWS_WITH_AS(setOption(options, *findOption("grid"), text),
                         doctest::Contains("3 to 31, odd"), InvalidInput);
  setOption(options, *findOption("grid"), "11");
  CHECK(options.grid == 11);
}
