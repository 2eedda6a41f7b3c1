#include "swatch/swatch_analysis.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "swatch/autocorrelation.h"
#include "swatch/swatch_relief.h"

using namespace dapple;

namespace {

Image painted(int w, int h, const std::function<float(double, double)>& grey) {
  Image image{w, h, 1, {}};
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) image.pixels.push_back(grey(x + 0.5, y + 0.5));
  return image;
}

SwatchAnalysis analysed(const Image& image, Tileable tileable = Tileable::Auto,
                        unsigned threads = 1) {
  Workers workers(threads);
  Monitor monitor(workers);
  return analyse(makeSwatch(image, tileable, 1, "test"), monitor);
}

float wave(double phase) {
  return static_cast<float>(0.5 + 0.4 * std::cos(2 * std::numbers::pi * phase));
}

// Smooth noise: bilinear between hashed values `cell` pixels apart.
float noise(double x, double y, double cell) {
  const double u = x / cell, v = y / cell;
  const auto value = [](double i, double j) {
    return hashUniform(3, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j));
  };
  const double i = std::floor(u), j = std::floor(v);
  const float a = static_cast<float>(u - i), b = static_cast<float>(v - j);
  return glm::mix(glm::mix(value(i, j), value(i + 1, j), a),
                  glm::mix(value(i, j + 1), value(i + 1, j + 1), a), b);
}

// The definition, lag by lag.
double bluntCorrelation(const Swatch& swatch, int dx, int dy) {
  dvec3 mean(0);
  double count = 0, variance = 0, products = 0, pairs = 0;
  const auto opaqueAt = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < swatch.width && y < swatch.height &&
           swatch.opaque[y * swatch.width + x];
  };
  const auto colour = [&](int x, int y) { return dvec3(swatch.colours()[y * swatch.width + x]); };
  for (int y = 0; y < swatch.height; ++y)
    for (int x = 0; x < swatch.width; ++x)
      if (opaqueAt(x, y)) mean += colour(x, y), ++count;
  mean /= count;
  for (int y = 0; y < swatch.height; ++y)
    for (int x = 0; x < swatch.width; ++x) {
      if (!opaqueAt(x, y)) continue;
      const dvec3 d = colour(x, y) - mean;
      variance += glm::dot(d, d) / count;
      if (!opaqueAt(x + dx, y + dy)) continue;
      products += glm::dot(d, colour(x + dx, y + dy) - mean);
      ++pairs;
    }
  return products / pairs / variance;
}

}  // namespace

TEST_CASE("the autocorrelation is that of its definition, holes left out") {
  Image image{21, 14, 4, {}};
  for (int i = 0; i < 21 * 14; ++i)
    for (int c = 0; c < 4; ++c)
      image.pixels.push_back(c < 3 ? hashUniform(1, i, c) : hashUniform(2, i) < 0.9f);
  const Swatch swatch = makeSwatch(image, Tileable::Auto, 1, "test");
  REQUIRE(swatch.hasHoles);
  Workers workers(2);
  Monitor monitor(workers);
  const Autocorrelation correlation = autocorrelation(swatch, monitor);
  CHECK(correlation.reachX == 10);
  CHECK(correlation.reachY == 7);
  for (int y = -7; y <= 7; ++y)
    for (int x = -10; x <= 10; ++x)
      CHECK(correlation.at(x, y) == doctest::Approx(bluntCorrelation(swatch, x, y)).epsilon(1e-4));
}

TEST_CASE("stripes: one direction, half a turn alike, the period is found") {
  for (const double degrees : {0.0, 30.0, 90.0, 120.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    // Along the grain nothing changes; y points down in an image.
    const SwatchAnalysis a = analysed(painted(128, 128, [&](double x, double y) {
      return wave((x * std::sin(angle) + y * std::cos(angle)) / 16);
    }));
    CAPTURE(degrees);
    CHECK(a.anisotropy > 0.97);
    const double off = std::remainder(a.grain - degrees, 180);
    CHECK(std::abs(off) < 2);
    // The first minimum of the Bessel function J0: 0.61 of the period.
    CHECK(a.feature == doctest::Approx(0.61 * 16).epsilon(0.15));
    CHECK(a.regularity > 0.9);
    CHECK(a.folds() == 2);
    CHECK(a.turned.half < 1.1);
    CHECK(a.turned.quarter > 5);
  }
}

TEST_CASE("what shows in the heights alone is seen as well") {
  const Image grey = painted(96, 96, [](double, double) { return 0.5f; });
  const Image stripes = painted(96, 96, [](double, double y) { return wave(y / 16); });
  const Swatch swatch = makeSwatch(grey, Tileable::Auto, 1, "test");
  Workers workers(1);
  Monitor monitor(workers);
  const SwatchAnalysis a = analyse(withRelief(swatch, stripes.pixels, 0.5), monitor);
  CHECK(a.kind() != PatternKind::Isotropic);
  CHECK(a.folds() == 2);
  CHECK(a.anisotropy > 0.97);
  CHECK(a.feature == doctest::Approx(0.61 * 16).epsilon(0.15));
  CHECK(analyse(swatch, monitor).kind() == PatternKind::Isotropic);
}

TEST_CASE("checks: a quarter turn alike, an eighth not, and they repeat both ways") {
  const SwatchAnalysis a = analysed(painted(96, 96, [](double x, double y) {
    return (static_cast<int>(x / 8) + static_cast<int>(y / 8)) % 2 ? 0.8f : 0.2f;
  }));
  CHECK(a.kind() == PatternKind::Regular);
  CHECK(a.folds() == 4);
  CHECK(a.anisotropy < 0.05);
  CHECK(a.lattice > 0.9);
  CHECK(a.latticeFit > 0.9);
  CHECK(a.tileable == false);  // a whole step between its borders, an eighth of one inside
  CHECK(a.contrast == doctest::Approx(0.3).epsilon(0.01));
}

TEST_CASE("a grid of dots repeats every 12 pixels") {
  const SwatchAnalysis a = analysed(painted(120, 120, [](double x, double y) {
    return std::hypot(std::remainder(x - 6, 12), std::remainder(y - 6, 12)) < 3.5 ? 0.1f : 0.9f;
  }));
  CHECK(a.kind() == PatternKind::Regular);
  CHECK(a.regularity > 0.9);
  CHECK(std::remainder(a.period.x, 12) == 0);
  CHECK(std::remainder(a.period.y, 12) == 0);
  CHECK(a.feature >= 5);
  CHECK(a.feature <= 7);
}

TEST_CASE("noise has no direction, no repeat and features as large as its cells") {
  for (const double cell : {1.0, 4.0, 9.0}) {
    const SwatchAnalysis a =
        analysed(painted(128, 128, [&](double x, double y) { return noise(x, y, cell); }));
    CAPTURE(cell);
    CHECK(a.kind() == PatternKind::Isotropic);
    CHECK(a.folds() == 0);
    CHECK(a.anisotropy < 0.1);
    CHECK(a.regularity < 0.25);
    CHECK(a.feature >= cell);
    CHECK(a.feature <= 2.5 * cell + 2);
  }
}

TEST_CASE("rows show through noise that hides what a turn would change") {
  const auto roof = [](bool rows) {
    return analysed(painted(128, 128, [&](double x, double y) {
      const double row = std::floor(y / 16), across = x - (static_cast<int>(row) % 2) * 8;
      const double rim = std::hypot(std::remainder(across, 16), y - 16 * row);
      const float tile = rows && std::abs(rim - 10) < 1.5 ? 0.3f : 0.4f;
      return tile + 0.35f * (noise(x, y, 1.5) - 0.5f);
    }));
  };
  const SwatchAnalysis tiles = roof(true), dust = roof(false);
  CHECK(tiles.kind() == PatternKind::Regular);
  CHECK(tiles.latticeFit > 0.2);
  CHECK(dust.kind() == PatternKind::Isotropic);
  CHECK(dust.latticeFit < 0.1);
}

TEST_CASE("saw teeth look otherwise upside down") {
  const SwatchAnalysis a = analysed(painted(128, 128, [](double x, double y) {
    const double phase = y / 12 + 0.2 * noise(x, y, 20);
    return static_cast<float>(0.2 + 0.6 * (phase - std::floor(phase)));
  }));
  CHECK(a.folds() == 1);
  CHECK(a.turned.half > 1.5);
}

TEST_CASE("a gradient and a swatch of one colour have nothing to be found, and do no harm") {
  const SwatchAnalysis ramp =
      analysed(painted(64, 64, [](double x, double) { return static_cast<float>(x / 64); }));
  CHECK(ramp.anisotropy == doctest::Approx(1));
  CHECK(ramp.grain == doctest::Approx(90));
  CHECK(ramp.folds() == 1);
  const SwatchAnalysis flat = analysed(painted(64, 64, [](double, double) { return 0.5f; }));
  CHECK(flat.kind() == PatternKind::Isotropic);
  CHECK(flat.anisotropy == 0);
  CHECK(flat.regularity == 0);
  CHECK(flat.contrast == 0);
  for (const ivec2 size : {ivec2(2, 2), ivec2(3, 2), ivec2(2, 300), ivec2(900, 3)}) {
    const SwatchAnalysis tiny =
        analysed(painted(size.x, size.y, [](double x, double y) { return noise(x, y, 1); }));
    CHECK(tiny.feature >= 1);
    CHECK(std::isfinite(tiny.turned.half));
  }
}

TEST_CASE("a large swatch is reduced, and its lengths stay its own") {
  const SwatchAnalysis a =
      analysed(painted(700, 700, [](double x, double) { return wave(x / 50); }));
  CHECK(a.feature == doctest::Approx(0.61 * 50).epsilon(0.15));
  CHECK(std::abs(std::remainder(a.period.x, 50)) < 3);
}

TEST_CASE("an analysis is the same at any number of threads, and can be stopped") {
  const Image image = painted(90, 70, [](double x, double y) { return noise(x, y, 5); });
  const SwatchAnalysis one = analysed(image, Tileable::Auto, 1);
  const SwatchAnalysis three = analysed(image, Tileable::Auto, 3);
  CHECK(one.turned.half == three.turned.half);
  CHECK(one.turned.eighth == three.turned.eighth);
  CHECK(one.feature == three.feature);
  Workers workers(1);
  std::stop_source stop;
  stop.request_stop();
  Monitor monitor(workers, stop.get_token());
  CHECK_THROWS_AS(analyse(makeSwatch(image, Tileable::Auto, 1, "test"), monitor), Cancelled);
}
