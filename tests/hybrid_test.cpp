#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "base/errors.h"
#include "fixtures.h"
#include "synthesis/hybrid_synthesis.h"

using namespace dapple;

namespace {

struct Scene {
  PointSet points;
  Swatch swatch;
  Neighborhoods near = fixtures::neighbourhoods(points, 25);
  std::vector<TangentFrame> frames = fixtures::uprightFrames(points);
  float unit = static_cast<float>(meanSpacing(near, points.positions));
  SynthesisInput input{points, near, swatch, frames, unit};

  struct Result {
    SourceMap map;
    HybridStatistics statistics;
  };
  Result run(const HybridOptions& options, unsigned threads = 1) const {
    Workers workers(threads);
    Monitor monitor(workers);
    Result result{emptySourceMap(points.size(), unit), {}};
    result.statistics = synthesizeHybrid(input, options, result.map, monitor);
    return result;
  }
};

Scene sphere(Swatch swatch) {
  return {fixtures::makeSphere(8000, 1), std::move(swatch)};
}

// Noise with two round holes.
Swatch holedSwatch() {
  const Image rgb = fixtures::noise(64);
  Image image{64, 64, 4, std::vector<float>(64 * 64 * 4, 1.0f)};
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = rgb.at(x, y, c);
      const bool hole = std::hypot(x - 14, y - 45) < 7 || std::hypot(x - 50, y - 12) < 5;
      if (hole) image.at(x, y, 3) = 0;
    }
  return fixtures::swatchOf(image);
}

double contrast(const SourceMap& map, PointState state) {
  dvec3 sum(0), squares(0);
  double count = 0;
  for (std::size_t i = 0; i < map.state.size(); ++i) {
    if (map.state[i] != state) continue;
    const dvec3 c(map.colour[i]);
    sum += c, squares += c * c, ++count;
  }
  const dvec3 variance = squares / count - sum / count * (sum / count);
  return std::sqrt((variance.x + variance.y + variance.z) / 3);
}

}  // namespace

TEST_CASE("hybrid: every point of a sphere gets a texel inside the swatch") {
  const Swatch swatches[] = {fixtures::swatchOf(fixtures::noise(48), Tileable::Yes),
                             fixtures::swatchOf(fixtures::noise(48), Tileable::No),
                             fixtures::swatchOf(fixtures::blobs(16), Tileable::No), holedSwatch()};
  for (const Swatch& swatch : swatches) {
    const Scene scene = sphere(swatch);
    const auto [map, statistics] = scene.run({});
    CHECK(statistics.patches.gapPoints > 0);
    for (std::size_t i = 0; i < map.state.size(); ++i) {
      REQUIRE(map.state[i] != PointState::Free);
      REQUIRE(map.state[i] != PointState::Matched);
      REQUIRE(map.patch[i] < statistics.patches.patches);
      REQUIRE(usableTexel(swatch, map.texel[i]));
      REQUIRE(map.colour[i] == sampleSwatch(swatch, map.texel[i]));
      REQUIRE(map.texel[i] == wrapTexel(swatch, map.domain[i] + map.placement[map.patch[i]]));
      REQUIRE(glm::length(glm::cross(map.frame[i].s, map.frame[i].t) - map.frame[i].n) < 1e-4f);
      REQUIRE(std::isfinite(map.error[i]));
    }
    CHECK(statistics.seams.energyAfter <= statistics.seams.energyBefore);
    CHECK(map.blendOffset.empty());
  }
}

TEST_CASE("hybrid: gap points keep the swatch's contrast, which blending loses") {
  const Scene scene = sphere(fixtures::swatchOf(fixtures::noise(48), Tileable::No));
  const SourceMap cut = scene.run({}).map;
  Workers workers(1);
  Monitor monitor(workers);
  SourceMap blended = emptySourceMap(scene.points.size(), scene.unit);
  growPatches(scene.input, {}, blended, monitor);
  blendGaps(scene.input, blended, monitor);
  const double full = swatchContrast(scene.swatch);
  CHECK(contrast(cut, PointState::Gap) > 0.85 * full);
  CHECK(contrast(blended, PointState::Gap) < 0.85 * full);
}

TEST_CASE("hybrid: without a threshold a plane has neither gaps nor seams") {
  const Scene scene{fixtures::makePlane(60, 40, 1),
                    fixtures::swatchOf(fixtures::noise(32), Tileable::Yes)};
  HybridOptions options;
  options.patches.distortion = std::numeric_limits<float>::infinity();
  for (const GapFill gaps : {GapFill::Cut, GapFill::Match}) {
    options.gaps = gaps;
    const HybridStatistics statistics = scene.run(options).statistics;
    CHECK(statistics.patches.patches == 1);
    CHECK(statistics.patches.gapPoints == 0);
    CHECK(statistics.matching.matched == 0);
    CHECK(statistics.seams.energyBefore == 0);
    CHECK(statistics.seams.changed == 0);
  }
}

TEST_CASE("hybrid: gaps that are matched leave patch points alone; expansion widens the gaps") {
  const Scene scene = sphere(fixtures::swatchOf(fixtures::noise(48), Tileable::No));
  Workers workers(1);
  Monitor monitor(workers);
  SourceMap grown = emptySourceMap(scene.points.size(), scene.unit);
  const PatchStatistics patches = growPatches(scene.input, {}, grown, monitor);
  HybridOptions options;
  options.gaps = GapFill::Match;
  for (const bool expand : {false, true}) {
    options.expand = expand;
    const auto [map, statistics] = scene.run(options);
    CHECK((statistics.expanded > 0) == expand);
    CHECK(statistics.matching.matched == patches.gapPoints + statistics.expanded);
    for (std::size_t i = 0; i < map.state.size(); ++i) {
      if (grown.state[i] == PointState::Gap) REQUIRE(map.state[i] == PointState::Matched);
      if (map.state[i] == PointState::Patch) REQUIRE(map.texel[i] == grown.texel[i]);
      REQUIRE(glm::length(glm::cross(map.frame[i].s, map.frame[i].t) - map.frame[i].n) < 1e-4f);
      REQUIRE(usableTexel(scene.swatch, map.texel[i]));
    }
  }
}

TEST_CASE("hybrid: the result is the same at any number of threads") {
  const Scene scene = sphere(fixtures::swatchOf(fixtures::noise(48), Tileable::No));
  HybridOptions options;
  for (const GapFill gaps : {GapFill::Cut, GapFill::Match}) {
    options.gaps = gaps;
    const SourceMap one = scene.run(options, 1).map;
    for (const unsigned threads : {2u, 3u}) {
      const SourceMap more = scene.run(options, threads).map;
      CHECK(more.texel == one.texel);
      CHECK(more.colour == one.colour);
      CHECK(more.patch == one.patch);
      CHECK(more.state == one.state);
      CHECK(more.error == one.error);
    }
  }
}

TEST_CASE("hybrid: a stop at any progress ends it before the end") {
  const Scene scene{fixtures::makeSphere(30000, 1),
                    fixtures::swatchOf(fixtures::noise(48), Tileable::No)};
  Workers workers(2);
  for (const double fraction : {0.0, 0.3, 0.5, 0.7, 0.9}) {
    CAPTURE(fraction);
    std::stop_source stop;
    double asked = 2, last = 0;
    Monitor monitor(workers, stop.get_token(), {.progress = [&](const Progress& progress) {
                      last = progress.fraction;
                      if (last < fraction || last >= 1 || asked <= 1) return;
                      asked = last;
                      stop.request_stop();
                    }});
    SourceMap map = emptySourceMap(scene.points.size(), scene.unit);
    monitor.begin(Stage::Synthesis, scene.points.size(), hybridPasses(GapFill::Cut));
    if (fraction == 0) {
      CHECK_THROWS_AS(synthesizeHybrid(scene.input, {}, map, monitor), Cancelled);
    } else {
      // Progress comes ten times a second: a fast machine may be through before it is asked.
      try {
        synthesizeHybrid(scene.input, {}, map, monitor);
        CHECK(asked == 2);
      } catch (const Cancelled&) {
        CHECK(asked <= 1);
      }
    }
    if (asked <= 1) CHECK(last < 1);
  }
}

TEST_CASE("hybrid: progress ends at the end, each point counted as often as said") {
  const Scene scene = sphere(fixtures::swatchOf(fixtures::noise(48), Tileable::No));
  Workers workers(1);
  double last = 0;
  Monitor monitor(workers, {}, {.progress = [&](const Progress& p) { last = p.fraction; }});
  const std::size_t passes = hybridPasses(GapFill::Cut);
  monitor.begin(Stage::Synthesis, scene.points.size(), passes);
  SourceMap map = emptySourceMap(scene.points.size(), scene.unit);
  synthesizeHybrid(scene.input, {}, map, monitor);
  monitor.advance(512);  // growth counts in steps of as many
  CHECK(last == 1);
}

TEST_CASE("hybrid: it can be stopped, and refuses options out of range") {
  const Scene scene = sphere(fixtures::swatchOf(fixtures::noise(48), Tileable::No));
  Workers workers(1);
  std::stop_source stop;
  stop.request_stop();
  Monitor stopped(workers, stop.get_token()), monitor(workers);
  SourceMap map = emptySourceMap(scene.points.size(), scene.unit);
  CHECK_THROWS_AS(synthesizeHybrid(scene.input, {}, map, stopped), Cancelled);
  for (const float overlap : {-1.f, 65.f, std::nanf("")}) {
    HybridOptions options;
    options.overlap = overlap;
    CHECK_THROWS_AS(synthesizeHybrid(scene.input, options, map, monitor), InvalidInput);
  }
}
