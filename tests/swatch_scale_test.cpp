// The scale that strokes carry, in every method.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "fixtures.h"
#include "synthesis/synthesis.h"

using namespace dapple;

namespace {

constexpr Method kMethods[] = {Method::Hybrid,    Method::Coordinates, Method::Patches,
                               Method::Match,     Method::Grid,        Method::Mapping,
                               Method::Triplanar, Method::Random};
constexpr float kUnit = 0.25f;  // powers of two: scaling is exact

struct Scene {
  PointSet points;
  Swatch swatch = fixtures::swatchOf(fixtures::noise(48));
  Neighborhoods near = fixtures::neighbourhoods(points, 25);
  std::vector<TangentFrame> frames = fixtures::uprightFrames(points);

  SourceMap run(const TextureOptions& options, float unit,
                const std::vector<float>& scale = {}) const {
    Workers workers(1);
    Monitor monitor(workers);
    const SynthesisInput input{.points = points,
                               .neighborhoods = near,
                               .swatch = swatch,
                               .frames = frames,
                               .unit = unit,
                               .scale = scale};
    return synthesize(input, options, monitor).map;
  }
};

Scene plane() {
  return {fixtures::inMortonOrder(fixtures::makePlane(24, 12, 0.25f))};
}

// From 1 at the left to 2 at the right, in steps of 2^(1/8).
float scaleAt(const vec3& position) {
  return std::exp2(std::round(position.x / 24 * 8) / 8);
}

// Swatch pixels between neighbours, times the unit there, over how far they lie apart; where a
// neighbour's texel goes on.
std::vector<float> stretches(const Scene& scene, const SourceMap& map,
                             const std::vector<float>& scale) {
  std::vector<float> out;
  for (Index i = 0; i < scene.points.size(); ++i) {
    const Index j = scene.near.of(i)[7];
    vec2 step = map.texel[j] - map.texel[i];
    const vec2 size(scene.swatch.width, scene.swatch.height);
    step -= size * glm::round(step / size);
    const float apart = glm::length(scene.points.positions[j] - scene.points.positions[i]);
    const float stretch =
        glm::length(step) * kUnit * 0.5f * (scale[i] + scale[j]) / std::max(apart, 1e-6f);
    if (stretch < 3) out.push_back(stretch);
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

TEST_CASE("a scale of 2 everywhere is a unit twice as long, in every method") {
  const Scene scene = plane();
  const std::vector<float> twice(scene.points.size(), 2);
  for (const Method method : kMethods) {
    CAPTURE(static_cast<int>(method));
    TextureOptions options{.method = method, .levels = 3};
    const SourceMap scaled = scene.run(options, kUnit, twice),
                    plain = scene.run(options, 2 * kUnit);
    CHECK(scaled.texel == plain.texel);
    CHECK(scaled.colour == plain.colour);
    CHECK(scaled.scale == twice);
    CHECK(plain.scale.empty());
  }
}

TEST_CASE("where the scale changes the pattern grows with it") {
  const Scene scene = plane();
  std::vector<float> scale;
  for (const vec3& position : scene.points.positions) scale.push_back(scaleAt(position));
  for (const Method method : {Method::Hybrid, Method::Coordinates, Method::Patches, Method::Match,
                              Method::Grid, Method::Mapping}) {
    CAPTURE(static_cast<int>(method));
    const std::vector<float> found =
        stretches(scene, scene.run({.method = method}, kUnit, scale), scale);
    CHECK(found.size() > scene.points.size() * 8 / 10);
    CHECK(found[found.size() / 2] == doctest::Approx(1).epsilon(0.03));
    CHECK(found[found.size() / 10] > 0.75f);
    CHECK(found[found.size() * 9 / 10] < 1.35f);
  }
}
