#include "synthesis/score_window.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "base/hash_rng.h"
#include "fixtures.h"
#include "synthesis/score_patches.h"
#include "synthesis/sliced_distance.h"

using namespace dapple;

namespace {

std::vector<FlatPoint> scattered(float halfSide, float spacing) {
  std::vector<FlatPoint> points;
  const int n = static_cast<int>(halfSide / spacing);
  for (int y = -n; y <= n; ++y)
    for (int x = -n; x <= n; ++x)
      points.push_back(
          {static_cast<Index>(points.size()),
           spacing * vec2(static_cast<float>(x) + 0.3f * hashUniform(1, x + 99, y + 99),
                          static_cast<float>(y) + 0.3f * hashUniform(2, x + 99, y + 99))});
  return points;
}

}  // namespace

TEST_CASE("a resampled window shows the colours at its nodes, in its own axes") {
  const auto points = scattered(20, 0.25f);
  WindowSampler sampler;
  const float turn = 0.8f, step = 2;
  sampler.place(points, step, turn);
  REQUIRE(sampler.complete());
  std::vector<Float4> colours;
  for (const auto& sample : sampler.samples()) {
    const vec2 p = points[sample.id].position;  // a ramp along the unturned axes
    colours.push_back(Float4{p.x, p.y, 1, 0});
  }
  const Window window = sampler.window(colours);
  for (int i = 0; i < kWindowNodes; ++i) {
    const vec2 node = step * (vec2(i % 8, i / 8) - 3.5f);
    const vec2 expected(std::cos(turn) * node.x - std::sin(turn) * node.y,
                        std::sin(turn) * node.x + std::cos(turn) * node.y);
    CHECK(std::abs(window.node[i][0] - expected.x) < 0.1f);
    CHECK(std::abs(window.node[i][1] - expected.y) < 0.1f);
    CHECK(std::abs(window.node[i][2] - 1) < 1e-5f);
  }
}

TEST_CASE("a window that sticks out of the surface is incomplete") {
  auto points = scattered(20, 0.5f);
  WindowSampler sampler;
  sampler.place(points, 2, 0.3f);
  CHECK(sampler.complete());
  std::erase_if(points, [](const FlatPoint& p) { return p.position.x > 3; });
  sampler.place(points, 2, 0.3f);
  CHECK_FALSE(sampler.complete());
}

TEST_CASE("the image of a window is not mirrored") {
  const Swatch swatch = fixtures::swatchOf(fixtures::bricks(96));
  const ScoreImage image(swatch, 1);
  const Window window = image.read(turnedPlacement({40, 30}, 0));
  const Swatch soft = [&] {
    Swatch blurred = swatch;
    blurred.stack = {swatch.stack[1]};
    return blurred;
  }();
  // Node (0, 0) is lower left: 3.5 pixels to the left, and further down, where rows are larger.
  const vec3 lowerLeft = sampleSwatch(soft, {36.5f, 96 - 30 + 3.5f});
  const vec3 upperRight = sampleSwatch(soft, {43.5f, 96 - 30 - 3.5f});
  for (int c = 0; c < 3; ++c) {
    CHECK(std::abs(window.node[0][c] - lowerLeft[c]) < 0.15f);
    CHECK(std::abs(window.node[63][c] - upperRight[c]) < 0.15f);
  }
}

TEST_CASE("refinement recovers a moved, turned and stretched window") {
  for (const Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = fixtures::swatchOf(fixtures::noise(96), tileable);
    const ScoreImage image(swatch, 2);
    for (int trial = 0; trial < 20; ++trial) {
      Placement truth = image.randomPlacement({}, 5, trial);
      truth.right *= 1.1f;
      if (!image.holds(truth)) continue;
      const Window target = image.read(truth);
      Placement guess = truth;
      guess.centre += vec2(0.8f, -0.6f);
      const float before = windowDistance(image.read(guess), target);
      const float after = image.refine(target, {}, 12, guess);
      CHECK(after < 0.05f * before);
      CHECK(image.holds(guess));
    }
  }
}

TEST_CASE("refinement never mirrors nor turns beyond its limit") {
  const Swatch swatch = fixtures::swatchOf(fixtures::bricks(96));
  const ScoreImage image(swatch, 2);
  for (int trial = 0; trial < 30; ++trial) {
    Window target = image.read(image.randomPlacement({}, 6, trial));
    Placement placement = turnedPlacement({40, 50}, 0.3f);
    image.refine(target, {0.35f}, 12, placement);
    const float determinant =
        placement.right.x * placement.up.y - placement.right.y * placement.up.x;
    CHECK(determinant >= 0.7f * 0.7f - 1e-3f);
    CHECK(determinant <= 1.4f * 1.4f + 1e-3f);
    const float angle =
        std::atan2(placement.right.y - placement.up.x, placement.right.x + placement.up.y);
    CHECK(std::abs(angle) <= 0.351f);
  }
}

TEST_CASE("the search proposes the place that a window came from, on every path alike") {
  const Swatch swatch = fixtures::swatchOf(fixtures::blobs(96));
  const ScoreImage image(swatch, 2);
  Workers workers(2);
  Monitor monitor(workers);
  const PatchGrid grid(image, {}, 1);
  const PatchCoder coder(grid, monitor);
  const ScorePatches patches(grid, coder, monitor);
  std::vector<PatchCode> codes;
  std::vector<Placement> truths;
  for (int trial = 0; trial < 50; ++trial) {
    truths.push_back(image.randomPlacement({}, 7, trial));
    codes.push_back(coder.encode(image.read(truths.back())));
  }
  const auto starts = patches.search(codes, monitor);
  const auto portable = patches.search(codes, monitor, SearchPath::Portable);
  CHECK(std::memcmp(starts.data(), portable.data(), starts.size() * sizeof(PatchStarts)) == 0);
  int found = 0;
  for (std::size_t q = 0; q < codes.size(); ++q) {
    for (const Placement& start : starts[q]) {
      vec2 d = start.centre - truths[q].centre;
      d -= 96.0f * glm::round(d / 96.0f);
      if (glm::length(d) < 2 && glm::dot(start.right, truths[q].right) > 0.9f) {
        ++found;
        break;
      }
    }
  }
  CHECK(found >= 47);
}

TEST_CASE("the sliced distance is none for equal clouds and grows with a shift") {
  std::vector<PatchCode> a(500), b(500), moved(500);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int d = 0; d < kPatchNumbers; ++d) {
      a[i][d] = hashUniform(1, i, d);
      b[i][d] = hashUniform(2, i, d);
      moved[i][d] = b[i][d] + 0.5f;
    }
  CHECK(slicedDistance(a, a, 1) == 0);
  CHECK(slicedDistance(b, a, 1) < 0.1);
  CHECK(slicedDistance(moved, a, 1) > 1);
  CHECK(slicedDistance({}, a, 1) == 0);
  const std::vector<PatchCode> same(100, PatchCode{});
  CHECK(slicedDistance(same, same, 1) == 0);
}
