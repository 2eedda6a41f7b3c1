#include "synthesis/patch_parameterization.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "fixtures.h"
#include "points/tangent_frames.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

struct Grown {
  PointSet points;
  Neighborhoods near;
  std::vector<TangentFrame> frames;
  SourceMap map;
  PatchStatistics statistics;
  float unit = 0;
};

// A field that patches are to follow; symmetry 0: they do not.
struct Field {
  std::vector<TangentFrame> frames;
  int symmetry = 0;
};

Grown grow(PointSet points, const Swatch& swatch, const PatchOptions& options, std::size_t k = 25,
           unsigned threads = 2, const Field& field = {}) {
  Workers workers(threads);
  Monitor monitor(workers);
  Grown out{.points = std::move(points)};
  out.near = buildNeighborhoods(out.points.positions, k, monitor);
  out.unit = static_cast<float>(meanSpacing(out.near, out.points.positions));
  out.frames = field.frames.empty() ? framesTowards(out.points, {0, 1, 0}) : field.frames;
  out.map = emptySourceMap(out.points.size(), out.unit);
  const SynthesisInput input{.points = out.points,
                             .neighborhoods = out.near,
                             .swatch = swatch,
                             .frames = out.frames,
                             .unit = out.unit,
                             .follow = field.symmetry > 0,
                             .symmetry = field.symmetry};
  out.statistics = growPatches(input, options, out.map, monitor);
  blendGaps(input, out.map, monitor);
  return out;
}

// Turned counter-clockwise by turns(point), in whole turns.
template <class Turns>
std::vector<TangentFrame> turnedFrames(const PointSet& points, const Turns& turns) {
  std::vector<TangentFrame> frames = framesTowards(points, {0, 1, 0});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto angle = static_cast<float>(2 * std::numbers::pi * turns(i));
    const TangentFrame frame = frames[i];
    frames[i].t = std::cos(angle) * frame.t - std::sin(angle) * frame.s;
    frames[i].s = glm::cross(frames[i].t, frame.n);
  }
  return frames;
}

// A cylinder of radius 1 along y, from y = 0 to `height`.
PointSet cylinder(float height, float spacing) {
  PointSet out;
  const int around = static_cast<int>(2 * std::numbers::pi / spacing);
  for (int row = 0; row < static_cast<int>(height / spacing); ++row)
    for (int column = 0; column < around; ++column) {
      const double shift = 0.5 * (row % 2);
      const double angle = 2 * std::numbers::pi * (column + shift) / around;
      const vec3 n(std::cos(angle), 0, std::sin(angle));
      out.positions.push_back(n + vec3(0, static_cast<float>(row) * spacing, 0));
      out.normals.push_back(n);
    }
  return out;
}

// 5th and 95th percentile of flattened over true distance, between near points of one patch.
std::pair<float, float> stretch(const Grown& g) {
  std::vector<float> ratios;
  for (std::size_t i = 0; i < g.points.size(); ++i)
    for (const Index j : g.near.of(i).first(8)) {
      if (g.map.state[i] != PointState::Patch || g.map.state[j] != PointState::Patch) continue;
      if (g.map.patch[i] != g.map.patch[j]) continue;
      ratios.push_back(glm::length(g.map.domain[i] - g.map.domain[j]) * g.unit /
                       glm::length(g.points.positions[i] - g.points.positions[j]));
    }
  std::sort(ratios.begin(), ratios.end());
  return {ratios[ratios.size() / 20], ratios[ratios.size() * 19 / 20]};
}

const Swatch& tile() {
  static const Swatch swatch = swatchOf(blobs(64), Tileable::Yes);
  return swatch;
}

}  // namespace

TEST_CASE("a plane flattens into one patch with no distortion and no gaps") {
  const Grown g = grow(makePlane(60, 60, 1), tile(), {});
  CHECK(g.statistics.patches == 1);
  CHECK(g.statistics.gapPoints == 0);
  CHECK(g.statistics.maxDistortion < 1e-3);
  const auto [low, high] = stretch(g);
  CHECK(low > 0.999f);
  CHECK(high < 1.001f);
}

TEST_CASE("on a plane the pattern stands upright and is not mirrored") {
  const Grown g = grow(makePlane(40, 40, 1), tile(), {});
  for (std::size_t i = 1; i < g.points.size(); ++i) {
    const vec3 step = g.points.positions[i] - g.points.positions[0];
    const vec2 texels = (g.map.domain[i] - g.map.domain[0]) * g.unit;
    REQUIRE(texels.x == doctest::Approx(step.x).epsilon(1e-3));   // z up to us: x is to the right,
    REQUIRE(texels.y == doctest::Approx(-step.y).epsilon(1e-3));  // and image rows run down
  }
}

TEST_CASE("patches that follow a field have its directions, and end where it cannot be flattened") {
  const PointSet plane = makePlane(80, 80, 1);
  // Circles around a place outside: their lengths differ, so that no flattening has all of them.
  const vec3 centre(-60, 40, 0);
  const auto around = turnedFrames(plane, [&](std::size_t i) {
    const vec3 out = plane.positions[i] - centre;
    return std::atan2(out.y, out.x) / (2 * std::numbers::pi);
  });
  const auto worst = [&](const Grown& g) {
    float least = 1;
    for (std::size_t i = 0; i < g.points.size(); ++i)
      if (g.map.state[i] != PointState::Free)
        least = std::min(least, glm::dot(g.map.frame[i].t, around[i].t));
    return least;
  };
  const Grown followed = grow(plane, tile(), {}, 25, 2, {around, 1});
  CHECK(worst(followed) > 0.99999f);
  CHECK(followed.statistics.maxDistortion > 0.1);
  const Grown straight = grow(plane, tile(), {}, 25, 2, {around, 0});
  CHECK(worst(straight) < 0.9f);
  CHECK(straight.statistics.gapPoints == 0);
  CHECK(grow(plane, tile(), {.distortion = 0.1f}, 25, 2, {around, 1}).statistics.gapPoints >
        followed.statistics.gapPoints);
}

TEST_CASE("a straight field is followed in one patch, whatever turn of its symmetry points have") {
  const PointSet plane = makePlane(40, 40, 1);
  for (const int symmetry : {1, 2, 4}) {
    CAPTURE(symmetry);
    const auto frames = turnedFrames(plane, [&](std::size_t i) {
      const auto folds = static_cast<std::uint64_t>(symmetry);
      return 0.1 + static_cast<double>(hashBelow(folds, 5, i)) / symmetry;
    });
    const Grown g = grow(plane, tile(), {}, 25, 2, {frames, symmetry});
    CHECK(g.statistics.patches == 1);
    CHECK(g.statistics.gapPoints == 0);
    CHECK(g.statistics.maxDistortion < 1e-3);
    for (std::size_t i = 0; i < g.points.size(); ++i)
      REQUIRE(glm::dot(g.map.frame[i].t, g.map.frame[0].t) > 0.99999f);
  }
}

TEST_CASE("a cylinder unrolls without stretch") {
  const Grown g = grow(cylinder(4, 0.05f), tile(), {});
  CHECK(g.statistics.patches == 1);
  CHECK(static_cast<double>(g.statistics.gapPoints) < 0.05 * static_cast<double>(g.points.size()));
  const auto [low, high] = stretch(g);
  CHECK(low > 0.98f);
  CHECK(high < 1.02f);
}

TEST_CASE("a sphere must have gaps, and fewer at a looser threshold") {
  const Grown tight = grow(makeSphere(16386, 1), tile(), {.distortion = 0.8f});
  const Grown usual = grow(makeSphere(16386, 1), tile(), {.distortion = 1.6f});
  CHECK(usual.statistics.gapPoints > 16386 * 4 / 100);
  CHECK(usual.statistics.gapPoints < 16386 * 13 / 100);
  CHECK(tight.statistics.gapPoints > usual.statistics.gapPoints);
  CHECK(usual.statistics.maxDistortion <= 1.6);
  const auto [low, high] = stretch(usual);
  CHECK(low > 0.8f);  // one patch closes around the whole sphere: it must stretch
  CHECK(high < 1.3f);
}

TEST_CASE("an infinite threshold leaves no gap") {
  const float everything = std::numeric_limits<float>::infinity();
  CHECK(grow(makeSphere(4000, 1), tile(), {.distortion = everything}).statistics.gapPoints == 0);
}

TEST_CASE("patches of a swatch that does not tile stay inside it") {
  const Swatch swatch = swatchOf(blobs(48), Tileable::No);
  const Grown g = grow(makeSphere(16386, 1), swatch, {.sizeLimit = 0.8f});
  CHECK(g.statistics.patches > 10);
  for (std::size_t i = 0; i < g.points.size(); ++i) {
    if (g.map.state[i] != PointState::Patch) continue;
    REQUIRE(usableTexel(swatch, g.map.texel[i]));
    REQUIRE(g.map.texel[i] == g.map.domain[i] + g.map.placement[g.map.patch[i]]);
  }
}

TEST_CASE("transparent texels are never used") {
  Image image = blobs(64);
  Image holed{.width = 64, .height = 64, .channels = 4};
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      for (int c = 0; c < 3; ++c) holed.pixels.push_back(0.5f * image.at(x, y, c));
      const bool hole = (x / 20 + y / 20) % 3 == 0;
      holed.pixels.push_back(hole ? 0.f : 1.f);
      if (hole)
        for (int c = 0; c < 3; ++c) holed.at(x, y, c) = 1;  // what must not be seen
    }
  const Grown g = grow(makeSphere(8000, 1), swatchOf(holed, Tileable::Auto), {});
  for (const vec3& colour : g.map.colour)
    REQUIRE(std::max({colour.x, colour.y, colour.z}) <= 0.5f + 1e-5f);
}

TEST_CASE("every point ends with a finite colour and a patch, and a blend sums to one") {
  const Grown g = grow(makeSphere(8000, 1), tile(), {.distortion = 0.4f});
  for (std::size_t i = 0; i < g.points.size(); ++i) {
    REQUIRE(g.map.state[i] != PointState::Free);
    REQUIRE(g.map.patch[i] != kNone);
    REQUIRE(std::isfinite(g.map.texel[i].x + g.map.texel[i].y + g.map.colour[i].x));
    float sum = 0;
    for (Index b = g.map.blendOffset[i]; b < g.map.blendOffset[i + 1]; ++b)
      sum += g.map.blend[b].weight;
    const float expected = g.map.state[i] == PointState::Gap ? 1.f : 0.f;
    REQUIRE(sum == doctest::Approx(expected).epsilon(1e-4));
  }
}

TEST_CASE("position noise of half a spacing leaves a plane mostly whole when smoothed") {
  PointSet plane = makePlane(80, 80, 1, 0.5f);
  for (std::size_t i = 0; i < plane.size(); ++i) plane.positions[i].z += hashUniform(5, i) - 0.5f;
  const Grown smooth = grow(plane, tile(), {});
  const Grown raw = grow(plane, tile(), {.smooth = false});
  CHECK(smooth.statistics.gapPoints * 8 < raw.statistics.gapPoints);
}

TEST_CASE("growth is the same at any number of threads, and changes with the seed") {
  const Grown one = grow(makeSphere(5000, 1), tile(), {}, 25, 1);
  const Grown three = grow(makeSphere(5000, 1), tile(), {}, 25, 3);
  CHECK(one.map.texel == three.map.texel);
  CHECK(one.map.colour == three.map.colour);
  CHECK(grow(makeSphere(5000, 1), tile(), {.seed = 2}).map.texel != one.map.texel);
}

TEST_CASE("growth can be stopped") {
  const PointSet points = makeSphere(5000, 1);
  std::stop_source stop;
  Workers workers(1);
  Monitor monitor(workers, stop.get_token());
  const Neighborhoods near = buildNeighborhoods(points.positions, 16, monitor);
  const auto frames = framesTowards(points, {0, 1, 0});
  SourceMap map = emptySourceMap(points.size(), 0.1f);
  stop.request_stop();
  CHECK_THROWS_AS(growPatches({points, near, tile(), frames, 0.1f}, {}, map, monitor), Cancelled);
}
