#include "swatch/swatch_relief.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "document/channels.h"
#include "document/live_regions.h"
#include "document_fixtures.h"
#include "fixtures.h"
#include "swatch/appearance.h"
#include "swatch/swatch_search.h"
#include "swatch/texel_reader.h"
#include "synthesis/synthesis.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

constexpr int kSize = 48;
constexpr float kHardly = 0.004f;  // is the colour changed
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::vector<float> redOf(const Image& image) {
  std::vector<float> out;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) out.push_back(image.at(x, y, 0));
  return out;
}

// The left half hardly changed at the right; heights tell them apart.
Swatch twoHalves(double weight) {
  Image image = noise(kSize);
  for (int y = 0; y < kSize; ++y)
    for (int x = kSize / 2; x < kSize; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = image.at(x - kSize / 2, y, c) + ((x ^ y) & 1 ? kHardly : -kHardly);
  std::vector<float> height;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) height.push_back(x < kSize / 2 ? 100.f : 300.f);
  return withRelief(makeSwatch(image, Tileable::No, 2, "halves"), height, weight);
}

// Of the edges between neighbours on a sphere, those that lead from one half to the other.
double jumps(double weight, Method method) {
  const Swatch swatch = twoHalves(weight);
  const PointSet points = inMortonOrder(makeSphere(2000, 1));
  const Neighborhoods near = neighbourhoods(points, 16);
  const std::vector<TangentFrame> frames = uprightFrames(points);
  TextureOptions options;
  options.method = method;
  options.coherent = false;
  Workers workers;
  Monitor monitor(workers);
  const SynthesisInput input{points, near, swatch, frames, 0.08f};
  const SourceMap map = synthesize(input, options, monitor).map;
  const auto isLeft = [&](std::size_t i) { return map.texel[i].x < kSize / 2; };
  std::size_t sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const Index j : near.of(i).first(6)) sum += isLeft(i) != isLeft(j);
  return static_cast<double>(sum) / static_cast<double>(6 * points.size());
}

}  // namespace

TEST_CASE("heights count beside the colours by their weight, whatever their range") {
  const Swatch swatch = makeSwatch(noise(kSize), Tileable::Yes, 3, "noise");
  std::vector<float> height = redOf(blobs(kSize));
  const Swatch with = withRelief(swatch, height, 0.25);
  REQUIRE(with.relief.size() == with.stack.size());
  double mean = 0, squares = 0;
  for (const float r : with.relief[0]) mean += static_cast<double>(r) / with.pixels();
  for (const float r : with.relief[0])
    squares += std::pow(static_cast<double>(r) - mean, 2) / with.pixels();
  CHECK(mean == doctest::Approx(0.5).epsilon(0.02));
  const double contrast = swatchContrast(swatch);
  CHECK(squares == doctest::Approx(0.25 * 3 * contrast * contrast).epsilon(0.05));
  CHECK(with.stack == swatch.stack);
  for (float& h : height) h = 1000 * h - 300;
  const Swatch scaled = withRelief(swatch, height, 0.25);
  for (std::size_t i = 0; i < with.pixels(); ++i)
    CHECK(std::abs(scaled.relief[2][i] - with.relief[2][i]) < 1e-4f);
  height[7] = kNaN;
  CHECK(withRelief(swatch, height, 0.25).relief[0][7] == 0.5f);
  CHECK(withRelief(swatch, height, 0).relief.empty());
  CHECK(withRelief(swatch, std::vector<float>(swatch.pixels(), 0.3f), 1).relief.empty());
  CHECK(sampleRelief(swatch, {4, 5}) == 0);
}

TEST_CASE("a search tells places apart that differ in height alone, on every path alike") {
  const Swatch swatch = twoHalves(1);
  const SwatchSearch search(swatch, 0, 2, 2);
  for (const int wanted : {9, 9 + kSize / 2}) {
    std::vector<SearchTerm> terms;
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        const vec2 at(wanted + x + 0.5f, 20 + y + 0.5f);
        terms.push_back({{x, y}, sampleSwatch(swatch, at), 0, sampleRelief(swatch, at)});
      }
    for (const SimdPath path : {SimdPath::Scalar, SimdPath::Avx2, SimdPath::Avx512Vnni}) {
      const SearchResult found = search.search(terms, path);
      CHECK(found.texel == vec2(wanted + 0.5f, 20.5f));
      CHECK(found.error == 0);
    }
    terms[3].relief = 1 - terms[3].relief;
    const std::uint32_t error = search.search(terms, SimdPath::Scalar).error;
    CHECK(error > 0);
    CHECK(search.search(terms, SimdPath::Avx2).error == error);
    CHECK(search.search(terms, SimdPath::Avx512Vnni).error == error);
    const TexelReader reader(swatch, 0);
    CHECK(reader.relief({wanted, 20}) == swatch.relief[0][20 * kSize + wanted]);
  }
}

TEST_CASE("appearances differ where only heights do") {
  Workers workers;
  Monitor monitor(workers);
  const Place left{12 << kPlaceBits, 24 << kPlaceBits}, right{36 << kPlaceBits, 24 << kPlaceBits};
  const auto distance = [&](double weight) {
    const AppearanceLevel level = makeAppearance(twoHalves(weight), 0, false, monitor);
    return appearanceDistance(level.at(left), level.at(right));
  };
  CHECK(distance(0.5) > 20 * distance(0));
}

TEST_CASE("heights go on from point to point where colours do not tell places apart") {
  for (const Method method : {Method::Coordinates, Method::Match}) {
    CAPTURE(static_cast<int>(method));
    const double blind = jumps(0, method), seeing = jumps(1, method);
    CHECK(seeing < 0.7 * blind);
  }
}

TEST_CASE("a height map asks for a new synthesis, unless it has no weight; other maps never do") {
  const TestFolder folder;
  CommandContext context = testContext();
  context.readImage = [](const std::filesystem::path& path) {
    return path.stem() == "map" ? blobs(kSize) : imageNamed(path);
  };
  const auto with = [&](const Document& d, const Command& c) { return applied(d, c, context); };
  Document d = sphereDocument(folder, 1500);
  TextureOptions options;
  options.method = Method::Match;
  d = with(d, SetRegion{.region = 0, .options = options});
  d = with(d, SetSwatch{.region = 0, .reference = {.path = "/s/noise.png"}});
  d = with(d, Synthesize{});
  SwatchReference reference{.path = "/s/noise.png"};
  reference.channels[Channel::Roughness] = "/s/map.png";
  const Document rough = with(d, SetSwatch{.region = 0, .reference = reference});
  CHECK(touchedRegions(d, rough).empty());
  CHECK(*with(rough, Synthesize{}).results.texel == *d.results.texel);
  reference.channels[Channel::Height] = "/s/map.png";
  const Document high = with(d, SetSwatch{.region = 0, .reference = reference});
  CHECK(touchedRegions(d, high) == std::vector<RegionId>{0});
  CHECK(high.results.sources == d.results.sources);
  const Document made = with(high, Synthesize{.onlyChanged = true});
  CHECK(*made.results.texel != *d.results.texel);
  CHECK(*with(made, Synthesize{.onlyChanged = true}).results.texel == *made.results.texel);
  options.heightWeight = 0;
  const Document weightless =
      with(with(high, SetRegion{.region = 0, .options = options}), Synthesize{});
  CHECK(*weightless.results.texel == *d.results.texel);
}
