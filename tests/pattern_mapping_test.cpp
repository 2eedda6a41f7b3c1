#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.h"
#include "fixtures.h"
#include "synthesis/cluster_chart.h"
#include "synthesis/cluster_matching.h"
#include "synthesis/cluster_split.h"
#include "synthesis/pattern_mapping.h"

using namespace dapple;

namespace {

struct Scene {
  PointSet points;
  Swatch swatch;
  Neighborhoods near = fixtures::neighbourhoods(points, 16);
  std::vector<TangentFrame> frames = fixtures::uprightFrames(points);

  SynthesisInput input(bool follow) const {
    return {.points = points,
            .neighborhoods = near,
            .swatch = swatch,
            .frames = frames,
            .unit = 1,
            .follow = follow};
  }

  struct Result {
    SourceMap map;
    MappingStatistics statistics;
  };
  Result run(bool follow, unsigned threads = 1, const SourceMap* kept = nullptr) const {
    Workers workers(threads);
    Monitor monitor(workers);
    SynthesisInput in = input(follow);
    in.kept = kept;
    Result result{kept ? *kept : emptySourceMap(points.size(), 1), {}};
    result.statistics = mapPattern(in, {}, result.map, monitor);
    return result;
  }
  PointGraph graph() const {
    Workers workers(1);
    Monitor monitor(workers);
    return linkBothWays(near, points.normals, 0, monitor);
  }
};

PointSet plane(float width, float height) {
  return fixtures::inMortonOrder(fixtures::makePlane(width, height, 1, 0.7f));
}

// Radius 18: 4000 points, one a pixel.
Scene ball(Swatch swatch) {
  PointSet points = fixtures::makeSphere(4000, 18);
  return {fixtures::inMortonOrder(points), std::move(swatch)};
}

std::vector<Index> allOf(const PointSet& points) {
  std::vector<Index> ids(points.size());
  std::iota(ids.begin(), ids.end(), Index{0});
  return ids;
}

// All parts together, in order.
std::vector<Index> joined(const std::vector<std::vector<Index>>& parts) {
  std::vector<Index> out;
  for (const auto& part : parts) out.insert(out.end(), part.begin(), part.end());
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<float> wholeTurn(std::size_t angles) {
  std::vector<float> out;
  for (std::size_t a = 0; a < angles; ++a)
    out.push_back(2 * 3.14159265f * static_cast<float>(a) / static_cast<float>(angles));
  return out;
}

}  // namespace

TEST_CASE("mapping: every point has a place, and all of a cluster the same placement") {
  for (const Tileable tileable : {Tileable::Yes, Tileable::No})
    for (const bool follow : {true, false}) {
      const Scene scene = ball(fixtures::swatchOf(fixtures::blobs(40), tileable));
      const auto [map, statistics] = scene.run(follow);
      CHECK(statistics.clusters == map.placement.size());
      CHECK(statistics.clusters > 1);
      CHECK(statistics.flattened >= statistics.clusters);
      CHECK(statistics.borderError <= statistics.matchedError);
      std::vector<std::uint8_t> ranks(scene.points.size(), 0);
      for (Index i = 0; i < scene.points.size(); ++i) {
        REQUIRE(map.state[i] == PointState::Matched);
        REQUIRE(map.patch[i] < statistics.clusters);
        REQUIRE(map.texel[i] ==
                wrapTexel(scene.swatch, map.domain[i] + map.placement[map.patch[i]]));
        REQUIRE(usableTexel(scene.swatch, map.texel[i]));
        REQUIRE(map.order[i] < ranks.size());
        ranks[map.order[i]] += 1;
        const TangentFrame& f = map.frame[i];
        REQUIRE(glm::length(glm::cross(f.s, f.t) - f.n) < 1e-4f);
        REQUIRE(glm::dot(f.n, scene.points.normals[i]) > 0.8f);
      }
      CHECK(std::count(ranks.begin(), ranks.end(), 1) == static_cast<std::ptrdiff_t>(ranks.size()));
    }
}

TEST_CASE("mapping: a plane smaller than the swatch is a copy of it") {
  const Scene scene{plane(24, 24), fixtures::swatchOf(fixtures::blobs(48), Tileable::No)};
  const auto [map, statistics] = scene.run(true);
  CHECK(statistics.clusters == 1);
  CHECK(statistics.forcedPoints == 0);
  for (Index i = 0; i < scene.points.size(); ++i) {
    const vec3 step = scene.points.positions[i] - scene.points.positions[0];
    REQUIRE(glm::length(map.texel[i] - map.texel[0] - vec2(step.x, -step.y)) < 0.02f);
  }
}

TEST_CASE("mapping: a swatch of one colour fits at once and colours all with it") {
  const vec3 colour(0.25f, 0.5f, 0.75f);
  const Scene scene = ball(fixtures::swatchOf(fixtures::flat(40, colour)));
  for (const bool follow : {true, false}) {
    const auto [map, statistics] = scene.run(follow);
    CHECK(statistics.borderError == 0);
    CHECK(statistics.forcedPoints == 0);
    for (const vec3& c : map.colour) REQUIRE(glm::length(c - colour) < 1e-5f);
  }
}

TEST_CASE("mapping: no place is on a hole, whatever its shape") {
  Image image = fixtures::noise(40);
  Image holed{.width = 40, .height = 40, .channels = 4};
  holed.pixels.resize(40 * 40 * 4);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      for (int c = 0; c < 3; ++c) holed.at(x, y, c) = image.at(x, y, c);
      holed.at(x, y, 3) = (x / 10 + y / 10) % 3 == 0 ? 0.f : 1.f;
    }
  const Scene scene = ball(fixtures::swatchOf(holed, Tileable::No));
  REQUIRE(scene.swatch.hasHoles);
  for (const bool follow : {true, false})
    for (const vec2& texel : scene.run(follow).map.texel) REQUIRE(usableTexel(scene.swatch, texel));
}

TEST_CASE("mapping: kept points stay, and what is laid beside them goes on from them") {
  const Scene scene{plane(40, 20), fixtures::swatchOf(fixtures::blobs(30))};
  SourceMap kept = emptySourceMap(scene.points.size(), 1);
  kept.domain.assign(scene.points.size(), vec2(0));
  kept.placement = {{7, 9}};
  for (Index i = 0; i < scene.points.size(); ++i) {
    const vec3 p = scene.points.positions[i];
    if (p.x > 20) continue;
    kept.state[i] = PointState::Patch;
    kept.patch[i] = 0;
    kept.domain[i] = vec2(p.x, -p.y);
    kept.frame[i] = scene.frames[i];
    placePoint(kept, scene.swatch, i);
  }
  for (const bool follow : {true, false}) {
    const SourceMap map = scene.run(follow, 1, &kept).map;
    double off = 0, count = 0;
    for (Index i = 0; i < scene.points.size(); ++i) {
      if (kept.state[i] != PointState::Free) {
        REQUIRE(map.texel[i] == kept.texel[i]);
        REQUIRE(map.colour[i] == kept.colour[i]);
        continue;
      }
      const vec3 p = scene.points.positions[i];
      const vec2 size(30), d = map.texel[i] - (vec2(p.x, -p.y) + kept.placement[0]);
      off += glm::length(d - size * glm::round(d / size)) < 0.3f ? 0 : 1;
      ++count;
    }
    CHECK(off / count < 0.05);
  }
}

TEST_CASE("mapping: a monitor stops it, and counts every point once") {
  const Scene scene = ball(fixtures::swatchOf(fixtures::blobs(40)));
  Workers workers(2);
  std::stop_source stop;
  double fraction = 0;
  SourceMap map = emptySourceMap(scene.points.size(), 1);
  const SynthesisInput input = scene.input(true);
  {
    MonitorCallbacks callbacks;
    callbacks.progress = [&](const Progress& p) { fraction = std::max(fraction, p.fraction); };
    Monitor monitor(workers, {}, callbacks);
    monitor.begin(Stage::Synthesis, scene.points.size());
    mapPattern(input, {}, map, monitor);
    CHECK(fraction <= 1);
  }
  stop.request_stop();
  Monitor stopped(workers, stop.get_token());
  map = emptySourceMap(scene.points.size(), 1);
  CHECK_THROWS_AS(mapPattern(input, {}, map, stopped), Cancelled);
}

TEST_CASE("mapping: where the density changes tenfold every point still has a place") {
  PointSet points = fixtures::makePlane(30, 30, 1, 0.7f);
  const PointSet dense = fixtures::makePlane(30, 30, 0.3f, 0.7f);
  for (const vec3& p : dense.positions) {
    if (p.x > 15) continue;
    points.positions.push_back(p + vec3(-15.5f, 0, 0));
    points.normals.push_back({0, 0, 1});
  }
  const Scene scene{fixtures::inMortonOrder(points),
                    fixtures::swatchOf(fixtures::blobs(40), Tileable::No)};
  for (const bool follow : {true, false}) {
    const auto [map, statistics] = scene.run(follow);
    for (const vec2& texel : map.texel) REQUIRE(usableTexel(scene.swatch, texel));
    for (const Index patch : map.patch) REQUIRE(patch < statistics.clusters);
    CHECK(statistics.clusters < 60);
  }
}

TEST_CASE("clusters: parts of a split are all of it, near each other and of like size") {
  const Scene scene{plane(40, 40), fixtures::swatchOf(fixtures::noise(24))};
  const PointGraph graph = scene.graph();
  ClusterSplitter splitter(scene.points, graph);
  Workers workers(1);
  Monitor monitor(workers);
  const std::vector<Index> all = allOf(scene.points);
  CHECK(splitter.pieces(all, monitor).size() == 1);
  const auto parts = splitter.split(all, 5, monitor);
  REQUIRE(parts.size() == 5);
  CHECK(joined(parts) == all);
  for (const auto& part : parts) {
    CHECK(part.size() > all.size() / 15);
    CHECK(std::is_sorted(part.begin(), part.end()));
    CHECK(splitter.pieces(part, monitor).size() == 1);
    CHECK(joined(splitter.split(part, 5, monitor)) == part);
  }
  const std::vector<Index> two{3, 4};
  CHECK(splitter.split(two, 5, monitor).size() == 2);
}

TEST_CASE("clusters: what does not hang together comes in pieces") {
  PointSet points = plane(12, 12);
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    points.positions.push_back(points.positions[i] + vec3(100, 0, 0));
    points.normals.push_back(points.normals[i]);
  }
  const Scene scene{points, fixtures::swatchOf(fixtures::noise(24))};
  const PointGraph graph = scene.graph();
  ClusterSplitter splitter(scene.points, graph);
  Workers workers(1);
  Monitor monitor(workers);
  const auto pieces = splitter.pieces(allOf(scene.points), monitor);
  REQUIRE(pieces.size() == 2);
  CHECK(pieces[0].size() == n);
  CHECK(pieces[1].front() == n);
  for (const Index i : scene.run(true).map.patch) REQUIRE(i != kNone);
}

TEST_CASE("cluster charts: on a plane they are the plane, and the band is as wide as asked") {
  const Scene scene{plane(40, 40), fixtures::swatchOf(fixtures::noise(24))};
  const PointGraph graph = scene.graph();
  Workers workers(1);
  Monitor monitor(workers);
  std::vector<Index> cluster;
  std::vector<std::uint8_t> known(scene.points.size(), 0);
  for (Index i = 0; i < scene.points.size(); ++i) {
    const vec3 p = scene.points.positions[i];
    if (glm::length(p - vec3(20, 20, 0)) < 9)
      cluster.push_back(i);
    else
      known[i] = p.x < 20 ? 1 : 0;
  }
  const SynthesisInput input = scene.input(true);
  ClusterChart chart(input, graph);
  for (int again = 0; again < 2; ++again) {  // nothing is left from the time before
    chart.flatten(cluster, monitor);
    chart.addBand(known, 6, monitor);
    CHECK(chart.members() == cluster.size());
    CHECK(chart.strained() == 0);
    CHECK(chart.sites().size() > chart.members() + 100);
    const vec3 centre = scene.points.positions[chart.ids()[0]];
    CHECK(glm::length(centre - vec3(20, 20, 0)) < 1.5f);
    for (std::size_t s = 0; s < chart.sites().size(); ++s) {
      const Index i = chart.ids()[s];
      const vec3 step = scene.points.positions[i] - centre;
      REQUIRE(glm::length(chart.sites()[s].q - vec2(step.x, -step.y)) < 1e-3f);
      if (s < chart.members()) continue;
      REQUIRE(known[i] == 1);
      REQUIRE(glm::length(scene.points.positions[i] - vec3(20, 20, 0)) < 9 + 6.001f);
    }
  }
}

TEST_CASE("cluster matching: a piece of the swatch is found where it is, at its angle") {
  const Swatch swatch = fixtures::swatchOf(fixtures::blobs(40));
  const ClusterMatcher matcher(swatch, 0);
  Workers workers(2);
  Monitor monitor(workers);
  const std::vector<float> angles = wholeTurn(19);
  const DomainTurn turn(angles[7]);
  const vec2 placement(23.3f, 8.6f);
  std::vector<vec2> inside{{0, 0}};
  std::vector<BorderSample> samples;
  for (int y = -10; y <= 10; ++y)
    for (int x = -10; x <= 10; ++x) {
      const vec2 place(x, y);
      if (std::abs(glm::length(place) - 8) < 2)
        samples.push_back({place, wrapTexel(swatch, turn(place) + placement)});
    }
  const std::vector<ClusterMatch> all = matcher.matches({inside, samples}, angles, monitor);
  REQUIRE(all.size() == 19);
  const ClusterMatch& found = all[0];
  CHECK(all[1].error > 0.03f);
  CHECK(matcher.matches({inside, {}}, angles, monitor).empty());
  CHECK(found.error < 0.01f);
  const vec2 d = found.placement - placement;
  CHECK(glm::length(d - 40.f * glm::round(d / 40.f)) < 0.2f);
  CHECK(glm::length(found.turn(vec2(1, 0)) - turn(vec2(1, 0))) < 1e-6f);
}

TEST_CASE("cluster matching: a turned domain gives axes that turn the other way") {
  const DomainTurn turn(0.4f);
  const TangentFrame own, turned = turn.of(own);
  // A step along the swatch's x axis on the surface is a step to the right in the turned domain.
  const vec2 right = turn(vec2(turned.s.x, -turned.s.y)), up = turn(vec2(turned.t.x, -turned.t.y));
  CHECK(glm::length(right - vec2(1, 0)) < 1e-6f);
  CHECK(glm::length(up - vec2(0, -1)) < 1e-6f);
  CHECK(glm::length(glm::cross(turned.s, turned.t) - turned.n) < 1e-6f);
}

TEST_CASE("relaxation: never raises the difference, and undoes a shift of the features") {
  const Swatch swatch = fixtures::swatchOf(fixtures::blobs(64));
  const TexelReader coarse(swatch, 2), fine(swatch, 0);
  std::vector<BorderSample> samples;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x)
      if (x < 8 || y < 8)
        samples.push_back({vec2(x, y), wrapTexel(swatch, vec2(x, y) + vec2(5.5f + 1.5f, 5.5f))});
  const Relaxation relaxed = relaxBorder(coarse, fine, samples, vec2(5.5f));
  CHECK(relaxed.before > 0.05f);
  CHECK(relaxed.after < 0.3f * relaxed.before);
  CHECK(relaxed.lattice.at({4, 4}).x == doctest::Approx(1.5).epsilon(0.2));
  for (const vec2& node : relaxed.lattice.nodes())
    CHECK((std::abs(node.x) <= 5 && std::abs(node.y) <= 5));
  // What fits stays, and what cannot fit gets no worse.
  CHECK(relaxBorder(coarse, fine, samples, vec2(7, 5.5f)).after < 0.01f);
  for (int dx = 0; dx < 64; dx += 9) {
    const Relaxation any = relaxBorder(coarse, fine, samples, vec2(dx, 31.5f));
    CHECK(any.after <= any.before);
  }
  CHECK(relaxBorder(coarse, fine, {}, vec2(0)).after == 0);
}
