#include "swatch/swatch_search.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/hash_rng.h"

using namespace dapple;

namespace {

constexpr SimdPath kPaths[] = {SimdPath::Scalar, SimdPath::Avx2, SimdPath::Avx512Vnni};

// Random texels; `levels` distinct values a channel, so that few levels give many ties.
Swatch randomSwatch(ivec2 size, bool tileable, float holes, int levels, std::uint64_t seed) {
  const int width = size.x, height = size.y;
  Image image{width, height, 4, {}};
  image.pixels.resize(static_cast<std::size_t>(width) * height * 4);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const float value = hashUniform(seed, i, 1);
    image.pixels[i] = std::floor(value * static_cast<float>(levels)) / static_cast<float>(levels);
    if (i % 4 == 3) image.pixels[i] = value < holes ? 0.0f : 1.0f;
  }
  image.pixels[3] = 1;
  return makeSwatch(image, tileable ? Tileable::Yes : Tileable::No, 2, "random");
}

std::vector<SearchTerm> randomTerms(std::size_t count, float reach, int layers,
                                    std::uint64_t seed) {
  std::vector<SearchTerm> terms(count);
  for (std::size_t t = 0; t < count; ++t) {
    const auto draw = [&](std::uint64_t c) { return hashUniform(seed, t, c, 2); };
    terms[t].offset = {(draw(0) * 2 - 1) * reach, (draw(1) * 2 - 1) * reach};
    terms[t].colour = {draw(2), draw(3), draw(4)};
    terms[t].layer = static_cast<int>(hashBelow(layers, seed, t, 5, 2));
  }
  return terms;
}

double sevenBits(float value) {
  return std::floor(static_cast<double>(std::clamp(value, 0.0f, 1.0f)) * 127 + 0.5);
}

// What the header promises, in doubles, one place at a time. -1 where a place does not count.
double errorAt(const Swatch& swatch, const std::vector<SearchTerm>& terms, int phases, int x,
               int y) {
  const auto opaque = [&](int px, int py) { return swatch.opaque[py * swatch.width + px] != 0; };
  if (!opaque(x, y)) return -1;
  double sum = 0;
  for (const SearchTerm& term : terms) {
    const int steps = term.layer == 0 ? phases : std::min(phases, 2);
    double u = x + std::floor(term.offset.x * steps + 0.5) / steps;
    double v = y + std::floor(term.offset.y * steps + 0.5) / steps;
    int px[2] = {static_cast<int>(std::floor(u)), static_cast<int>(std::ceil(u))};
    int py[2] = {static_cast<int>(std::floor(v)), static_cast<int>(std::ceil(v))};
    u -= px[0];
    v -= py[0];
    if (!swatch.tileable) {
      if (px[0] < 0 || py[0] < 0 || px[1] >= swatch.width || py[1] >= swatch.height) return -1;
    }
    vec3 corner[2][2];
    for (int b = 0; b < 2; ++b) {
      for (int a = 0; a < 2; ++a) {
        const int cx = ((px[a] % swatch.width) + swatch.width) % swatch.width;
        const int cy = ((py[b] % swatch.height) + swatch.height) % swatch.height;
        if (!opaque(cx, cy)) return -1;
        corner[b][a] = swatch.stack[term.layer][cy * swatch.width + cx];
      }
    }
    const auto fu = static_cast<float>(u), fv = static_cast<float>(v);
    const vec3 upper = corner[0][0] * (1 - fu) + corner[0][1] * fu;
    const vec3 lower = corner[1][0] * (1 - fu) + corner[1][1] * fu;
    const vec3 colour = upper * (1 - fv) + lower * fv;
    for (int c = 0; c < 3; ++c) {
      const double d = sevenBits(colour[c]) - sevenBits(term.colour[c]);
      sum += d * d;
    }
  }
  return sum;
}

SearchResult bruteForce(const Swatch& swatch, const std::vector<SearchTerm>& terms, int phases) {
  SearchResult best;
  double least = 1e30;
  for (int y = 0; y < swatch.height; ++y) {
    for (int x = 0; x < swatch.width; ++x) {
      const double error = errorAt(swatch, terms, phases, x, y);
      if (error < 0 || error >= least) continue;
      least = error;
      best = {{x + 0.5f, y + 0.5f}, static_cast<std::uint32_t>(error), true};
    }
  }
  return best;
}

void checkSame(const SearchResult& got, const SearchResult& want) {
  REQUIRE(got.found == want.found);
  REQUIRE(got.error == want.error);
  REQUIRE(got.texel.x == want.texel.x);
  REQUIRE(got.texel.y == want.texel.y);
}

}  // namespace

TEST_CASE("the exhaustive search finds the true minimum, ties to the smallest y, then x") {
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    const int width = 2 + static_cast<int>(hashBelow(seed < 60 ? 12 : 70, seed, 1));
    const int height = 2 + static_cast<int>(hashBelow(seed < 60 ? 12 : 40, seed, 2));
    const bool tileable = hashBelow(2, seed, 3) == 1;
    const bool holes = !tileable && hashBelow(2, seed, 4) == 1;
    const int phases = 1 << hashBelow(4, seed, 5);
    const int levels = hashBelow(2, seed, 6) == 1 ? 2 : 1000;
    const Swatch swatch = randomSwatch({width, height}, tileable, holes ? 0.03f : 0, levels, seed);
    const SwatchSearch search(swatch, 0, phases, 2);
    const float reach =
        tileable ? 1.7f * static_cast<float>(width) : 0.3f * static_cast<float>(height);
    const auto terms = randomTerms(hashBelow(30, seed, 7), reach, 2, seed);
    const SearchResult want = bruteForce(swatch, terms, phases);
    for (SimdPath path : kPaths) checkSame(search.search(terms, path), want);
  }
}

TEST_CASE("all instruction sets give the same place on large swatches") {
  const int sizes[][2] = {{300, 200}, {64, 64}, {65, 3}, {33, 97}, {128, 128}, {2, 2}, {31, 190}};
  std::uint64_t seed = 1000;
  for (const auto& size : sizes) {
    for (int kind = 0; kind < 3; ++kind) {
      const Swatch swatch = randomSwatch({size[0], size[1]}, kind == 0, kind == 2 ? 0.01f : 0,
                                         kind == 1 ? 2 : 1000, ++seed);
      const SwatchSearch search(swatch, 0, 2);
      for (std::size_t count : {0, 1, 7, 25, 49, 100}) {
        const auto terms = randomTerms(count, 4, 1, ++seed);
        const SearchResult want = search.search(terms, SimdPath::Scalar);
        checkSame(search.search(terms, SimdPath::Avx2), want);
        checkSame(search.search(terms, SimdPath::Avx512Vnni), want);
        checkSame(search.search(terms), want);
      }
    }
  }
}

TEST_CASE("the largest possible errors do not overflow") {
  Image black{40, 3, 3, std::vector<float>(40 * 3 * 3, 0.0f)};
  const Swatch swatch = makeSwatch(black, Tileable::Yes, 1, "black");
  const SwatchSearch search(swatch, 0, 1);
  const std::vector<SearchTerm> terms(65536, SearchTerm{{0, 0}, {1, 1, 1}});
  for (SimdPath path : kPaths) {
    const SearchResult result = search.search(terms, path);
    REQUIRE(result.found);
    CHECK(result.error == 65536u * 3u * 127u * 127u);
    CHECK(result.texel == vec2(0.5f, 0.5f));
  }
}

TEST_CASE("a place is not found where the terms do not fit, or only on holes") {
  const Swatch small = randomSwatch({8, 8}, false, 0, 1000, 5);
  const SwatchSearch search(small, 0, 4);
  const std::vector<SearchTerm> wide = {{{-4, 0}, vec3(0)}, {{4.25f, 0}, vec3(0)}};
  const std::vector<SearchTerm> fits = {{{-4, 0}, vec3(0)}, {{3, 0}, vec3(0)}};
  const std::vector<SearchTerm> far = {{{1e30f, -1e30f}, vec3(0)}};
  for (SimdPath path : kPaths) {
    CHECK(!search.search(wide, path).found);
    CHECK(search.search(fits, path).texel.x == 4.5f);
    CHECK(!search.search(far, path).found);
  }
  // A row of opaque texels: a neighbour one row down is always on a hole.
  Image image{5, 5, 4, std::vector<float>(100, 0.0f)};
  for (int x = 0; x < 5; ++x) image.at(x, 2, 3) = 1;
  const Swatch row = makeSwatch(image, Tileable::No, 1, "row");
  const SwatchSearch rowSearch(row, 0, 2);
  const std::vector<SearchTerm> down = {{{0, 1}, vec3(0)}}, right = {{{1, 0}, vec3(0)}};
  for (SimdPath path : kPaths) {
    CHECK(!rowSearch.search(down, path).found);
    CHECK(rowSearch.search(right, path).texel == vec2(0.5f, 2.5f));
  }
}
