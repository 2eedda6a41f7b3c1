#include "app/render/image_compare.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/errors.h"
#include "base/hash_rng.h"

using namespace dapple;

namespace {

constexpr double kGoldenError = 0.04;

// A textured disc on white that fills a small part of the picture.
Image disc(int channels = 3, float shift = 0, float noise = 0) {
  Image image{128, 96, channels, std::vector<float>(std::size_t{128} * 96 * channels, 1.0f)};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (std::hypot(x - 64, y - 48) < 24)
        for (int c = 0; c < std::min(channels, 3); ++c)
          image.at(x, y, c) = 0.5f + 0.4f * std::sin(0.8f * (static_cast<float>(x) + shift) + c) +
                              noise * (hashUniform(1, x, y, c) - 0.5f);
  return image;
}

}  // namespace

TEST_CASE("a picture is like itself and the measure is symmetric") {
  CHECK(structuralSimilarity(disc(), disc()) == doctest::Approx(1));
  CHECK(structuralSimilarity(disc(), disc(3, 1)) ==
        doctest::Approx(structuralSimilarity(disc(3, 1), disc())));
}

TEST_CASE("alpha does not count") {
  CHECK(structuralSimilarity(disc(3), disc(4)) == doctest::Approx(1));
}

TEST_CASE("invisible noise passes a golden test") {
  CHECK(structuralSimilarityError(disc(), disc(3, 0, 0.01f)) < 0.5 * kGoldenError);
}

TEST_CASE("wrong pictures fail a golden test") {
  const Image right = disc();
  SUBCASE("shifted by two pixels") {
    CHECK(structuralSimilarityError(right, disc(3, 2)) > 5 * kGoldenError);
  }
  SUBCASE("upside down") {
    Image wrong = right;
    for (int y = 0; y < wrong.height; ++y)
      for (int x = 0; x < wrong.width; ++x)
        for (int c = 0; c < 3; ++c) wrong.at(x, y, c) = right.at(x, (y + 20) % wrong.height, c);
    CHECK(structuralSimilarityError(right, wrong) > 5 * kGoldenError);
  }
  SUBCASE("the object is missing, though most of the picture is background") {
    Image wrong = right;
    std::fill(wrong.pixels.begin(), wrong.pixels.end(), 1.0f);
    CHECK(structuralSimilarityError(right, wrong) > 5 * kGoldenError);
  }
  SUBCASE("noisy") {
    CHECK(structuralSimilarityError(right, disc(3, 0, 0.6f)) > kGoldenError);
  }
  SUBCASE("red and blue swapped") {
    Image wrong = right;
    for (std::size_t i = 0; i < wrong.pixels.size(); i += 3)
      std::swap(wrong.pixels[i], wrong.pixels[i + 2]);
    CHECK(structuralSimilarityError(right, wrong) > kGoldenError);
  }
}

TEST_CASE("two flat greys of different lightness are not alike") {
  Image dark{16, 16, 1, std::vector<float>(256, 0.2f)}, light = dark;
  std::fill(light.pixels.begin(), light.pixels.end(), 0.8f);
  CHECK(structuralSimilarityError(dark, light) > 0.3);
}

TEST_CASE("pictures of different or too small a size are refused") {
  Image small{4, 4, 3, std::vector<float>(48, 0.f)}, wide{16, 8, 3, std::vector<float>(384, 0.f)};
  CHECK_THROWS_AS(structuralSimilarity(small, small), InvalidInput);
  CHECK_THROWS_AS(structuralSimilarity(small, wide), InvalidInput);
}
