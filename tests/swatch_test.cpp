#include "swatch/swatch.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "fixtures.h"
#include "swatch/gaussian_blur.h"

using namespace dapple;

namespace {

Image randomImage(int w, int h, int channels) {
  Image image{w, h, channels, {}};
  for (int i = 0; i < w * h * channels; ++i) image.pixels.push_back(hashUniform(9, i));
  if (channels == 2 || channels == 4)
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) image.at(x, y, channels - 1) = 1;
  return image;
}

// The definition, one texel at a time, in double.
dvec3 bluntBlur(const Swatch& swatch, double sigma, int x, int y) {
  const int reach = static_cast<int>(std::ceil(3.5 * sigma));
  dvec3 sum(0);
  double weights = 0;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      int px = x + dx, py = y + dy;
      if (swatch.tileable) {
        px = ((px % swatch.width) + swatch.width) % swatch.width;
        py = ((py % swatch.height) + swatch.height) % swatch.height;
      }
      if (px < 0 || py < 0 || px >= swatch.width || py >= swatch.height) continue;
      if (!swatch.opaque[py * swatch.width + px]) continue;
      const double w = std::exp(-0.5 * (dx * dx + dy * dy) / (sigma * sigma));
      sum += w * dvec3(swatch.colours()[py * swatch.width + px]);
      weights += w;
    }
  return sum / weights;
}

}  // namespace

TEST_CASE("every level of the stack is the Gaussian of its definition, wrapped or cut off") {
  for (const Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = makeSwatch(randomImage(23, 17, 3), tileable, 5, "random");
    REQUIRE(swatch.stack.size() == 5);
    CHECK(swatch.tileable == (tileable == Tileable::Yes));
    for (int level = 1; level < 5; ++level)
      for (int y = 0; y < 17; ++y)
        for (int x = 0; x < 23; ++x) {
          const dvec3 expected = bluntBlur(swatch, 0.5 * std::pow(2, level), x, y);
          REQUIRE(glm::length(expected - dvec3(swatch.stack[level][y * 23 + x])) < 1e-5);
        }
  }
}

TEST_CASE("what is hidden in a hole never reaches a filter") {
  Image image = randomImage(20, 20, 4);
  for (int y = 5; y < 12; ++y)
    for (int x = 6; x < 15; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = 50;
      image.at(x, y, 3) = 0.2f;
    }
  const Swatch swatch = makeSwatch(image, Tileable::Yes, 4, "holed");
  CHECK(swatch.hasHoles);
  CHECK_FALSE(swatch.tileable);
  for (const auto& level : swatch.stack)
    for (const vec3& colour : level) REQUIRE(glm::length(colour) < 2);
  for (int level = 1; level < 4; ++level)
    CHECK(glm::length(bluntBlur(swatch, 0.5 * std::pow(2, level), 5, 8) -
                      dvec3(swatch.stack[level][8 * 20 + 5])) < 1e-5);
  CHECK(swatch.colours()[8 * 20 + 6] == swatch.colours()[8 * 20 + 5]);
  CHECK(swatch.colours()[5 * 20 + 10] == swatch.colours()[4 * 20 + 10]);
  CHECK(swatch.stack[2][8 * 20 + 6] == swatch.stack[2][8 * 20 + 5]);
  CHECK(usableTexel(swatch, {5.5f, 8.5f}));
  CHECK_FALSE(usableTexel(swatch, {5.6f, 8.5f}));
  CHECK_FALSE(usableTexel(swatch, {9, 9}));
}

TEST_CASE("a hole takes the colour of the nearest opaque texel") {
  Image image = randomImage(31, 29, 4);
  for (int y = 0; y < 29; ++y)
    for (int x = 0; x < 31; ++x) image.at(x, y, 3) = hashUniform(4, x, y) < 0.03f ? 1.0f : 0.0f;
  const Swatch swatch = makeSwatch(image, Tileable::No, 1, "sparse");
  for (int y = 0; y < 29; ++y)
    for (int x = 0; x < 31; ++x) {
      int best = 1 << 30;
      for (int v = 0; v < 29; ++v)
        for (int u = 0; u < 31; ++u)
          if (swatch.opaque[v * 31 + u])
            best = std::min(best, (u - x) * (u - x) + (v - y) * (v - y));
      bool found = false;
      for (int v = 0; v < 29; ++v)
        for (int u = 0; u < 31; ++u)
          found |= swatch.opaque[v * 31 + u] && (u - x) * (u - x) + (v - y) * (v - y) == best &&
                   swatch.colours()[v * 31 + u] == swatch.colours()[y * 31 + x];
      REQUIRE(found);
    }
}

TEST_CASE("tileable images are told from others") {
  CHECK(looksTileable(fixtures::bricks(96)));
  CHECK(looksTileable(fixtures::noise(64)));
  CHECK(looksTileable(fixtures::flat(8, vec3(0.5f))));
  Image ramp = fixtures::flat(32, vec3(0));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) ramp.at(x, y, 0) = static_cast<float>(x) / 31;
  CHECK_FALSE(looksTileable(ramp));
  Image holed = randomImage(16, 16, 4);
  CHECK(looksTileable(holed));
  holed.at(3, 3, 3) = 0;
  CHECK_FALSE(looksTileable(holed));
}

TEST_CASE("pixel centres read exactly and halfway reads average, wrapped where it tiles") {
  const Image image = randomImage(7, 5, 3);
  for (const Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = makeSwatch(image, tileable, 3, "random");
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 7; ++x) {
        const vec3 here = swatch.colours()[y * 7 + x];
        REQUIRE(sampleSwatch(swatch, {x + 0.5f, y + 0.5f}) == here);
        const int next = tileable == Tileable::Yes ? (x + 1) % 7 : std::min(x + 1, 6);
        const vec3 there = swatch.colours()[y * 7 + next];
        const vec3 between = sampleSwatch(swatch, {x + 1.0f, y + 0.5f});
        REQUIRE(glm::length(between - 0.5f * (here + there)) < 1e-6f);
      }
    const vec3 far = sampleSwatch(swatch, {2.25f - 70, 3.5f + 50});
    if (tileable == Tileable::Yes)
      CHECK(glm::length(far - sampleSwatch(swatch, {2.25f, 3.5f})) < 1e-4f);
    else
      CHECK(far == swatch.colours()[4 * 7]);
    const vec3 half = sampleSwatch(swatch, {2.5f, 2.5f}, 1.5f);
    CHECK(glm::length(half - 0.5f * (swatch.stack[1][2 * 7 + 2] + swatch.stack[2][2 * 7 + 2])) <
          1e-6f);
    CHECK(sampleSwatch(swatch, {2.5f, 2.5f}, 9) == swatch.stack[2][2 * 7 + 2]);
  }
}

TEST_CASE("texels wrap into a tileable swatch and stay as they are elsewhere") {
  const Swatch tile = makeSwatch(randomImage(7, 5, 3), Tileable::Yes, 1, "tile");
  CHECK(glm::length(wrapTexel(tile, {-0.5f, 12.25f}) - vec2(6.5f, 2.25f)) < 1e-5f);
  for (const float x : {-1e-9f, 7.0f, -7.0f, 1e6f, -1e6f}) {
    const vec2 wrapped = wrapTexel(tile, {x, x});
    CHECK((wrapped.x >= 0 && wrapped.x < 7 && wrapped.y >= 0 && wrapped.y < 5));
  }
  CHECK(usableTexel(tile, {-100, 100}));
  const Swatch sheet = makeSwatch(randomImage(7, 5, 3), Tileable::No, 1, "sheet");
  CHECK(wrapTexel(sheet, {-3, 9}) == vec2(-3, 9));
  CHECK(usableTexel(sheet, {0.5f, 4.5f}));
  CHECK_FALSE(usableTexel(sheet, {0.4f, 2}));
  CHECK_FALSE(usableTexel(sheet, {6.6f, 2}));
  CHECK_FALSE(usableTexel(sheet, {std::numeric_limits<float>::quiet_NaN(), 2}));
}

TEST_CASE("grey images become colours and contrast is the standard deviation") {
  Image grey{2, 2, 1, {0, 1, 1, 0}};
  const Swatch swatch = makeSwatch(grey, Tileable::No, 1, "grey");
  CHECK(swatch.colours()[1] == vec3(1));
  CHECK(swatchContrast(swatch) == doctest::Approx(0.5));
  Image greyAlpha{2, 2, 2, {0, 1, 1, 1, 0.5f, 1, 9, 0}};
  const Swatch holed = makeSwatch(greyAlpha, Tileable::No, 1, "grey alpha");
  CHECK(swatchContrast(holed) == doctest::Approx(std::sqrt(0.5 / 3)));
}

TEST_CASE("images that cannot be swatches are refused by name") {
  CHECK_THROWS_WITH_AS(makeSwatch(randomImage(1, 9, 3), Tileable::No, 1, "thin.png"),
                       doctest::Contains("thin.png: 1 x 9 pixels"), InvalidInput);
  Image clear = randomImage(4, 4, 4);
  for (int i = 0; i < 16; ++i) clear.pixels[i * 4 + 3] = 0;
  CHECK_THROWS_WITH_AS(makeSwatch(clear, Tileable::No, 1, "clear.png"),
                       doctest::Contains("clear.png"), InvalidInput);
  Image broken = randomImage(4, 4, 3);
  broken.at(1, 1, 0) = std::numeric_limits<float>::quiet_NaN();
  const Swatch swatch = makeSwatch(broken, Tileable::Auto, 3, "broken.exr");
  CHECK(swatch.hasHoles);
  for (const auto& level : swatch.stack)
    for (const vec3& colour : level) CHECK(std::isfinite(colour.x));
}
