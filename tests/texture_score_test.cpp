#include "synthesis/texture_score.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "fixtures.h"
#include "swatch/gaussian_blur.h"
#include "synthesis/sliced_distance.h"

using namespace dapple;

namespace {

// A plane with the swatch's axes turned by 0.6 radians, so that no image row is a row of points.
struct Scene {
  PointSet points;
  Neighborhoods neighborhoods;
  std::vector<vec2> flat;  // positions along the swatch's axes, pixels, y up
  std::vector<vec3> up;    // the swatch's up at each point
};

Scene makeScene(float side = 144, float spacing = 1) {
  Scene scene;
  scene.points = fixtures::makePlane(side, side, spacing);
  const float c = std::cos(0.6f), s = std::sin(0.6f);
  for (vec3& p : scene.points.positions) {
    scene.flat.emplace_back(p.x, p.y);
    p = vec3(c * p.x - s * p.y, s * p.x + c * p.y, 0);
    scene.up.emplace_back(-s, c, 0);
  }
  scene.neighborhoods = fixtures::neighbourhoods(scene.points);
  return scene;
}

const Scene& plane() {
  static const Scene scene = makeScene();
  return scene;
}

// Colours by the texel that `place` gives for a flat position.
template <class Place>
std::vector<vec3> paint(const Scene& scene, const Swatch& swatch, Place place) {
  std::vector<vec3> colours;
  for (const vec2& p : scene.flat) {
    const vec2 at = place(p);
    colours.push_back(sampleSwatch(swatch, {at.x, static_cast<float>(swatch.height) - at.y}));
  }
  return colours;
}

vec2 asItIs(vec2 p) {
  return p;
}

// What has to score high is evaluated at more points: the fewer, the more chance takes off.
constexpr std::size_t kFull = 800;

struct Ask {
  const std::vector<vec3>* directions = nullptr;
  std::size_t points = 200;
  unsigned threads = 2;
};

TextureScore scored(const Scene& scene, const std::vector<vec3>& colours, const Swatch& swatch,
                    const Ask& ask = {}) {
  Workers workers(ask.threads);
  Monitor monitor(workers);
  return scoreTexture(
      {scene.points, scene.neighborhoods, colours, swatch, 1, nullptr, ask.directions},
      {.evaluationPoints = ask.points}, monitor);
}

}  // namespace

TEST_CASE("a perfect plane scores high, a stretched one nearly so, and a mirrored one low") {
  for (const Image& image : {fixtures::bricks(48), fixtures::blobs(48)}) {
    const Swatch swatch = fixtures::swatchOf(image);
    const Swatch mirror = fixtures::swatchOf(fixtures::mirrored(image));
    const TextureScore perfect =
        scored(plane(), paint(plane(), swatch, asItIs), swatch, {.points = kFull});
    const TextureScore wrong = scored(plane(), paint(plane(), mirror, asItIs), swatch);
    CHECK(perfect.F >= 0.95);
    CHECK(wrong.F <= 0.4);
    CHECK(wrong.free[1].residual > 3 * perfect.free[1].residual);
    const auto stretched = paint(plane(), swatch, [](vec2 p) { return vec2(p.x / 1.15f, p.y); });
    CHECK(scored(plane(), stretched, swatch, {.points = kFull}).F >= 0.9);
    for (int s = 0; s < 3; ++s) {
      CHECK(perfect.free[s].step == doctest::Approx(std::exp2(s)).epsilon(0.1));
      CHECK(perfect.free[s].windows > 100);
      CHECK(perfect.free[s].defects <= 0.05);
      CHECK(perfect.free[s].residual < 1.3 * perfect.free[s].residualFloor);
    }
  }
}

TEST_CASE("random pixels and the mean colour score nothing, and blur is not taken for texture") {
  const Swatch swatch = fixtures::swatchOf(fixtures::noise(48));
  const std::vector<vec3> good = paint(plane(), swatch, asItIs);
  CHECK(scored(plane(), good, swatch, {.points = kFull}).F >= 0.95);

  std::vector<vec3> random;
  for (std::size_t i = 0; i < good.size(); ++i)
    random.push_back(swatch.colours()[hashBelow(swatch.pixels(), 3, i)]);
  CHECK(scored(plane(), random, swatch).F <= 0.05);

  vec3 mean(0);
  for (const vec3& c : swatch.colours()) mean += c / static_cast<float>(swatch.pixels());
  const TextureScore flat = scored(plane(), std::vector<vec3>(good.size(), mean), swatch);
  CHECK(flat.F <= 0.01);
  CHECK(flat.free[1].sliced > 0.7);

  Swatch soft = swatch;
  soft.stack = {blurSwatch(swatch, 1.2)};
  CHECK(scored(plane(), paint(plane(), soft, asItIs), swatch).F <= 0.7);
}

TEST_CASE("the oriented figures see a turn that the free ones allow") {
  const Swatch swatch = fixtures::swatchOf(fixtures::bricks(48));
  const std::vector<vec3> colours = paint(plane(), swatch, asItIs);
  const TextureScore along = scored(plane(), colours, swatch, {&plane().up, kFull});
  CHECK(along.orientedF.value() >= 0.95);
  std::vector<vec3> across;
  for (const vec3& t : plane().up) across.push_back({t.y, -t.x, 0});
  const TextureScore turned = scored(plane(), colours, swatch, {&across, kFull});
  CHECK(turned.F >= 0.95);
  CHECK(turned.orientedF.value() <= 0.2);
  CHECK_FALSE(scored(plane(), colours, swatch).orientedF.has_value());
}

TEST_CASE("the direction of a pattern is measured, where it has one") {
  const Swatch swatch = fixtures::swatchOf(fixtures::stripes(48, 8));
  const std::vector<vec3> colours = paint(plane(), swatch, asItIs);
  const auto turnedBy = [&](float degrees) {
    const float angle = degrees * std::numbers::pi_v<float> / 180;
    std::vector<vec3> directions;
    for (const vec3& t : plane().up)
      directions.push_back({t.x * std::cos(angle) - t.y * std::sin(angle),
                            t.x * std::sin(angle) + t.y * std::cos(angle), 0});
    return scored(plane(), colours, swatch, {&directions}).direction;
  };
  for (const float degrees : {0.f, 10.f, -25.f, 90.f}) {
    CAPTURE(degrees);
    const auto error = turnedBy(degrees);
    REQUIRE(error);
    CHECK(std::abs(error->median - std::abs(degrees)) < 1.5);
    CHECK(error->perfectMedian < 1);
    CHECK(error->perfect95 < 3);
  }
  const Swatch round = fixtures::swatchOf(fixtures::noise(48));
  CHECK_FALSE(scored(plane(), paint(plane(), round, asItIs), round, {&plane().up}).direction);
}

TEST_CASE("denser and sparser points give a perfect mapping its due") {
  const Swatch swatch = fixtures::swatchOf(fixtures::blobs(48));
  const Scene dense = makeScene(144, 0.4f);
  CHECK(scored(dense, paint(dense, swatch, asItIs), swatch, {.points = kFull}).F >= 0.95);
  const Scene sparse = makeScene(288, 2);
  Swatch prefiltered = swatch;
  prefiltered.stack = {swatch.stack[1]};
  const TextureScore score =
      scored(sparse, paint(sparse, prefiltered, asItIs), swatch, {.points = kFull});
  CHECK(score.free[0].step == doctest::Approx(2).epsilon(0.1));
  CHECK(score.F >= 0.95);
}

TEST_CASE("swatches smaller than a window, with holes, or of one colour are scored too") {
  const Scene small = makeScene(80);
  const Swatch tiny = fixtures::swatchOf(fixtures::stripes(16, 8), Tileable::No);
  const auto wrapped =
      paint(small, fixtures::swatchOf(fixtures::stripes(16, 8), Tileable::Yes), asItIs);
  CHECK(scored(small, wrapped, tiny).F >= 0.85);

  Image holed = fixtures::noise(96);
  holed.channels = 4;
  holed.pixels.clear();
  const Image full = fixtures::noise(96);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      for (int c = 0; c < 3; ++c) holed.pixels.push_back(full.at(x, y, c));
      holed.pixels.push_back(x < 50 || y < 50 ? 1.0f : 0.0f);
    }
  const Swatch cut = makeSwatch(holed, Tileable::Auto, 1, "cut");
  const auto inside = paint(small, cut, [](vec2 p) { return vec2(p.x * 0.55f, p.y); });
  CHECK(std::isfinite(scored(small, inside, cut).F));

  const Swatch grey = fixtures::swatchOf(fixtures::flat(32, vec3(0.5f)));
  CHECK(scored(small, paint(small, grey, asItIs), grey).F >= 0.99);
  CHECK(scored(small, std::vector<vec3>(small.flat.size(), vec3(0.9f)), grey).F <= 0.01);
}

TEST_CASE("the score is the same bytes at any number of threads") {
  const Swatch swatch = fixtures::swatchOf(fixtures::blobs(48));
  const auto colours = paint(plane(), swatch, asItIs);
  const TextureScore one = scored(plane(), colours, swatch, {&plane().up, 64, 1});
  for (unsigned threads : {2u, 3u}) {
    const TextureScore other = scored(plane(), colours, swatch, {&plane().up, 64, threads});
    CHECK(std::memcmp(&one.free, &other.free, sizeof(one.free)) == 0);
    CHECK(std::memcmp(&*one.oriented, &*other.oriented, sizeof(*one.oriented)) == 0);
    CHECK(one.F == other.F);
  }
}

TEST_CASE("the unit of the model makes no difference") {
  const Swatch swatch = fixtures::swatchOf(fixtures::blobs(48));
  const auto colours = paint(plane(), swatch, asItIs);
  const double F = scored(plane(), colours, swatch, {.points = 100}).F;
  PointSet metres = plane().points;
  for (vec3& p : metres.positions) p *= 1.0f / 1024;
  Workers workers(1);
  Monitor monitor(workers);
  const TextureScore score = scoreTexture(
      {metres, plane().neighborhoods, colours, swatch, 1.0f / 1024}, {100, 1}, monitor);
  CHECK(score.F == doctest::Approx(F).epsilon(1e-6));
}

TEST_CASE("a source map tells seams, breaks, pieces and lost contrast") {
  const Scene scene = makeScene(96);
  const Swatch swatch = fixtures::swatchOf(fixtures::noise(48));
  const float c = std::cos(0.6f), s = std::sin(0.6f);
  SourceMap map = emptySourceMap(scene.points.size(), 1);
  const auto fill = [&](auto texelOf) {
    for (std::size_t i = 0; i < scene.flat.size(); ++i) {
      map.texel[i] = wrapTexel(swatch, texelOf(i, vec2(scene.flat[i].x, 96 - scene.flat[i].y)));
      map.frame[i] = {{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
      map.state[i] = PointState::Patch;
      map.colour[i] = mappedColour(map, swatch, i);
    }
    Workers workers(2);
    Monitor monitor(workers);
    return scoreTexture({scene.points, scene.neighborhoods, map.colour, swatch, 1, &map}, {100, 1},
                        monitor);
  };
  const double n = static_cast<double>(scene.points.size());
  const TextureScore whole = fill([](std::size_t, vec2 p) { return p; });
  CHECK(whole.seamError.value() < 1e-3);
  CHECK(whole.breaks.value() == 0);
  CHECK(whole.verbatim.value() == n);
  CHECK_FALSE(whole.gapContrast.has_value());

  const TextureScore halves =
      fill([](std::size_t, vec2 p) { return p.x < 48 ? p : p + vec2(31, 17); });
  CHECK(halves.breaks.value() > 0.005);
  CHECK(halves.breaks.value() < 0.03);
  CHECK(halves.seamError.value() > 10 * whole.seamError.value());
  CHECK(halves.verbatim.value() == doctest::Approx(n / 2).epsilon(0.02));

  // Turned against its frame, but in one piece: no seams.
  const TextureScore turned = fill([](std::size_t, vec2 p) { return vec2(p.y, -p.x); });
  CHECK(turned.breaks.value() < 0.001);

  const TextureScore random = fill(
      [](std::size_t i, vec2) { return 48.0f * vec2(hashUniform(8, i, 0), hashUniform(8, i, 1)); });
  CHECK(random.breaks.value() > 0.8);
  CHECK(random.verbatim.value() < 3);
  CHECK(random.seamError.value() > 0.8);
}

TEST_CASE("contrast lost in the gaps is reported against the swatch's") {
  const Scene scene = makeScene(96);
  const Swatch swatch = fixtures::swatchOf(fixtures::noise(48));
  std::vector<vec3> colours = paint(scene, swatch, asItIs);
  SourceMap map = emptySourceMap(scene.points.size(), 1);
  vec3 mean(0);
  for (const vec3& colour : colours) mean += colour / static_cast<float>(colours.size());
  Workers workers(1);
  Monitor monitor(workers);
  for (const float kept : {1.0f, 0.5f}) {
    for (std::size_t i = 0; i < colours.size(); i += 3) {
      map.state[i] = PointState::Gap;
      colours[i] = glm::mix(mean, colours[i], kept);
    }
    const TextureScore score = scoreTexture(
        {scene.points, scene.neighborhoods, colours, swatch, 1, &map}, {100, 1}, monitor);
    CHECK(score.gapContrast.value() == doctest::Approx(kept).epsilon(0.12));
  }
}

TEST_CASE("what cannot be scored is refused by cause, and scoring can be stopped") {
  const Swatch swatch = fixtures::swatchOf(fixtures::noise(48));
  const auto colours = paint(plane(), swatch, asItIs);
  Workers workers(2);
  Monitor monitor(workers);
  CHECK_THROWS_WITH_AS(
      scoreTexture({plane().points, plane().neighborhoods, colours, swatch, 0}, {}, monitor),
      doctest::Contains("longer than 0"), InvalidInput);
  CHECK_THROWS_WITH_AS(scoreTexture({plane().points, plane().neighborhoods, colours, swatch, 1},
                                    {.evaluationPoints = 10}, monitor),
                       doctest::Contains("50 to 100000"), InvalidInput);
  const Scene few = makeScene(10);
  CHECK_THROWS_WITH_AS(scored(few, paint(few, swatch, asItIs), swatch),
                       doctest::Contains("100 points"), InvalidInput);
  const Scene narrow = makeScene(16);
  CHECK_THROWS_WITH_AS(scored(narrow, paint(narrow, swatch, asItIs), swatch),
                       doctest::Contains("larger surface"), InvalidInput);
  std::stop_source stop;
  stop.request_stop();
  Monitor stopped(workers, stop.get_token());
  CHECK_THROWS_AS(
      scoreTexture({plane().points, plane().neighborhoods, colours, swatch, 1}, {}, stopped),
      Cancelled);
}
