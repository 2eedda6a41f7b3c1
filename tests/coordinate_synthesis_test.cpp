#include "synthesis/coordinate_synthesis.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "fixtures.h"
#include "same_maps.h"
#include "synthesis/coordinate_grid.h"
#include "synthesis/coordinate_relaxation.h"
#include "synthesis/surface_sites.h"
#include "synthesis/synthesis.h"
#include "synthesis/texture_score.h"

using namespace dapple;
using dapple::testing::sameBytes;
using namespace dapple::fixtures;

namespace {

constexpr float kSpacing = 1.0f / 64;

struct Scan {
  PointSet points;
  Neighborhoods neighborhoods;
  std::vector<TangentFrame> frames;

  explicit Scan(PointSet set)
      : points(inMortonOrder(set)),
        neighborhoods(neighbourhoods(points, 20)),
        frames(uprightFrames(points)) {}
  SynthesisInput input(const Swatch& swatch, float unit = kSpacing) const {
    return {points, neighborhoods, swatch, frames, unit};
  }
};

Scan plane(int side) {
  const float width = static_cast<float>(side) * kSpacing;
  return Scan(makePlane(width, width, kSpacing));
}

SourceMap synthesized(const SynthesisInput& input, Monitor& monitor, std::uint64_t seed = 1) {
  SourceMap map = emptySourceMap(input.points.size(), input.unit);
  synthesizeCoordinates(input, {.seed = seed}, map, monitor);
  return map;
}

Image withHole(Image image) {
  Image out{image.width, image.height, 4, {}};
  out.pixels.assign(static_cast<std::size_t>(image.width) * image.height * 4, 1.0f);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = image.at(x, y, c);
      const int dx = x - image.width / 2, dy = y - image.height / 2;
      if (dx * dx + dy * dy < image.width * image.width / 20) out.at(x, y, 3) = 0;
    }
  return out;
}

std::vector<Place> identity(int size) {
  std::vector<Place> places;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      places.push_back({(x << kPlaceBits) + 512, (y << kPlaceBits) + 512});
  return places;
}

// A torus whose sites hold random places, on one level.
enum class Beyond { Itself, Nothing, Continuation };
struct RandomTorus {
  static constexpr int kSize = 48;
  Swatch swatch;
  PlaceDomain domain;
  GridSites grid;
  AppearanceLevel appearance;
  std::vector<Place> places;
  std::vector<Appearance> looks;

  RandomTorus(Beyond beyond, int level, Monitor& monitor)
      : swatch(swatchOf(noise(40), beyond == Beyond::Itself ? Tileable::Yes : Tileable::No)),
        domain(beyond == Beyond::Continuation ? PlaceDomain::continuing(swatch)
                                              : PlaceDomain(swatch)),
        grid(gridSites({kSize << level, kSize << level, true}, level,
                       appearanceReach(swatch, level))),
        appearance(makeAppearance(swatch, level, true, monitor)) {
    for (std::size_t i = 0; i < grid.size(); ++i) {
      places.push_back(domain.random(7, i / 3, 1));  // some agree
      looks.push_back(appearance.at(places.back()));
    }
  }
};

}  // namespace

TEST_CASE("coordinates: others for another seed") {
  const Scan scan = plane(48);
  Workers workers(2);
  Monitor monitor(workers);
  for (const Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = swatchOf(noise(40), tileable);
    std::vector<SourceMap> bySeed;
    for (const std::uint64_t seed : {1, 2, 3})
      bySeed.push_back(synthesized(scan.input(swatch), monitor, seed));
    CHECK(!sameBytes(bySeed[0].texel, bySeed[1].texel));
    CHECK(!sameBytes(bySeed[0].texel, bySeed[2].texel));
  }
}

TEST_CASE("coordinates stay inside a swatch that does not tile, and off its transparent part") {
  Workers workers(2);
  Monitor monitor(workers);
  const Scan scan = plane(64);
  for (const bool hole : {false, true}) {
    const Swatch swatch = swatchOf(hole ? withHole(noise(40)) : noise(40), Tileable::No);
    const SourceMap map = synthesized(scan.input(swatch), monitor);
    for (const vec2& texel : map.texel) REQUIRE(usableTexel(swatch, texel));
  }
}

TEST_CASE("the smallest swatches and scans are coloured too") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = plane(6);
  Image image{2, 3, 3, std::vector<float>(18)};
  for (std::size_t i = 0; i < 18; ++i) image.pixels[i] = hashUniform(1, i);
  for (const Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = swatchOf(image, tileable);
    const SourceMap map = synthesized(scan.input(swatch), monitor);
    for (const vec2& texel : map.texel) REQUIRE(usableTexel(swatch, texel));
    for (const PointState state : map.state) REQUIRE(state == PointState::Matched);
  }
}

TEST_CASE("coordinates: stopping throws Cancelled and leaves the map as it was") {
  Workers workers(2);
  const Scan scan = plane(48);
  const Swatch swatch = swatchOf(noise(40));
  for (const bool early : {true, false}) {
    std::stop_source stop;
    if (early) stop.request_stop();
    Monitor monitor(workers, stop.get_token(),
                    {.preview = [&](const Preview&) { stop.request_stop(); }});
    SourceMap map = emptySourceMap(scan.points.size(), kSpacing);
    const SourceMap before = map;
    CHECK_THROWS_AS(synthesizeCoordinates(scan.input(swatch), {}, map, monitor), Cancelled);
    CHECK(sameBytes(map.texel, before.texel));
    CHECK(sameBytes(map.state, before.state));
  }
}

TEST_CASE("ways there and back are the same, and quarters are counted") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan(makeSphere(3000, 1));
  const Swatch swatch = swatchOf(noise(40));
  Scan turned = scan;
  for (std::size_t i = 0; i < turned.frames.size(); ++i) {
    const TangentFrame f = scan.frames[i];
    if (hashBelow(2, 1, i) == 0) turned.frames[i] = {f.t, -f.s, f.n};  // a quarter to the left
  }
  const SiteWays plain(scan.input(swatch, 0.03f)), mixed(turned.input(swatch, 0.03f));
  for (Index i = 0; i < 3000; ++i) {
    if (std::abs(scan.points.positions[i].y) > 0.8f) continue;  // frames spin at the poles
    for (const Index j : scan.neighborhoods.of(i)) {
      const auto there = plain.between(i, j), back = plain.between(j, i);
      REQUIRE(there.seen);
      REQUIRE(there.pixels == -back.pixels);
      REQUIRE(there.quarters == 0);
      const int first = hashBelow(2, 1, i) == 0, second = hashBelow(2, 1, j) == 0;
      const auto across = mixed.between(i, j);
      REQUIRE(across.quarters == ((second - first) & 3));
      const vec2 expected = first ? vec2(-there.pixels.y, there.pixels.x) : there.pixels;
      REQUIRE(glm::length(across.pixels - expected) < 1e-4f);
    }
  }
}

TEST_CASE("on a torus a tileable swatch that is laid on it stays as it is") {
  Workers workers(2);
  Monitor monitor(workers);
  const Swatch swatch = swatchOf(bricks(48));
  const PlaceDomain domain(swatch);
  const GridSites grid = gridSites({48, 48, true}, 0, appearanceReach(swatch, 0));
  const AppearanceLevel appearance = makeAppearance(swatch, 0, false, monitor);
  std::vector<Place> places = identity(48);
  const std::vector<Place> before = places;
  PlaceRelaxation relaxation(grid.sites, appearance, domain, places, monitor);
  for (std::size_t c = 0; c < PlaceRelaxation::kClasses; ++c) relaxation.updateClass(c, monitor);
  CHECK(places == before);
  for (const float error : relaxation.errors(monitor)) REQUIRE(error == 0);

  // One site that was moved goes back to where its neighbours expect it.
  places[1000] = {512, 512};
  PlaceRelaxation again(grid.sites, appearance, domain, places, monitor);
  for (std::size_t c = 0; c < PlaceRelaxation::kClasses; ++c) again.updateClass(c, monitor);
  CHECK(places == before);
}

TEST_CASE("frozen sites keep their places") {
  Workers workers(2);
  Monitor monitor(workers);
  RandomTorus torus(Beyond::Itself, 0, monitor);
  torus.grid.sites.frozen.assign(torus.grid.size(), 0);
  for (std::size_t i = 0; i < torus.grid.size(); i += 2) torus.grid.sites.frozen[i] = 1;
  const std::vector<Place> before = torus.places;
  PlaceRelaxation relaxation(torus.grid.sites, torus.appearance, torus.domain, torus.places,
                             monitor);
  CHECK(relaxation.free() == torus.grid.size() / 2);
  for (std::size_t c = 0; c < PlaceRelaxation::kClasses; ++c) relaxation.updateClass(c, monitor);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < torus.grid.size(); ++i) {
    if (i % 2 == 0) REQUIRE(torus.places[i] == before[i]);
    moved += !(torus.places[i] == before[i]);
  }
  CHECK(moved > torus.grid.size() / 4);
}

TEST_CASE("kernels choose what plain code chooses") {
  Workers workers(1);
  Monitor monitor(workers);
  for (const Beyond beyond : {Beyond::Itself, Beyond::Nothing, Beyond::Continuation})
    for (const int level : {0, 1, 2}) {
      RandomTorus torus(beyond, level, monitor);
      for (std::size_t w = 0; w < torus.grid.sites.ways.size(); w += 13) {
        torus.grid.sites.ways[w].x |= 1;  // some neighbours are turned
        torus.grid.sites.ways[w].y |= w % 2;
      }
      UsageMap usage{.shift = kPlaceBits + 3,
                     .columns = (torus.domain.width() >> kPlaceBits) / 8 + 1};
      for (int cell = 0; cell < usage.columns * ((torus.domain.height() >> kPlaceBits) / 8 + 1);
           ++cell)
        usage.factor.push_back(1.0f + 0.3f * static_cast<float>(cell % 2));
      const SimilarPlaces similar(torus.appearance, torus.domain, monitor);
      DisplacementUsage displacements(torus.grid.sites, torus.domain);
      displacements.count(torus.places, monitor);
      const PlaceUpdate update{.sites = torus.grid.sites,
                               .appearance = torus.appearance,
                               .domain = torus.domain,
                               .usage = usage,
                               .displacements = displacements.empty() ? nullptr : &displacements,
                               .places = torus.places.data(),
                               .looks = torus.looks.data(),
                               .similar = beyond == Beyond::Nothing ? &similar : nullptr,
                               .merge = 50,
                               .nearby = 2 << (kPlaceBits + level),
                               .probes = 2,
                               .probesAround = 3,
                               .around = 5,
                               .round = 3};
      std::vector<Index> members(torus.grid.size());
      for (std::size_t i = 0; i < members.size(); ++i) members[i] = static_cast<Index>(i);
      std::vector<Place> fast(members.size()), plain(members.size());
      choosePlaces(update, members, fast.data());
      choosePlaces(update, members, plain.data(), true);
      CHECK(fast == plain);
      CHECK(fast != torus.places);
    }
}

TEST_CASE("an isotropic swatch is used evenly") {
  Workers workers(2);
  Monitor monitor(workers);
  const Scan scan = plane(160);
  const Swatch swatch = swatchOf(noise(40));
  const SourceMap map = synthesized(scan.input(swatch), monitor);
  std::vector<double> counts(16, 0);
  for (const vec2& texel : map.texel)
    counts[static_cast<std::size_t>(texel.y / 10) * 4 + static_cast<std::size_t>(texel.x / 10)] +=
        1;
  const double mean = static_cast<double>(map.texel.size()) / 16;
  double squares = 0;
  for (const double count : counts) squares += (count - mean) * (count - mean) / (mean * mean);
  CHECK(squares / 16 < 0.1);  // relative variance; independent draws of whole pieces: about 0.06
}

TEST_CASE("the swatch keeps its scale where the density changes") {
  Workers workers(2);
  Monitor monitor(workers);
  // A plane whose right half has a sixteenth of the points of the left one.
  const PointSet ramp = makePlane(1, 1, 1.0f / 128);
  PointSet uneven;
  const PointSet sparse = makePlane(1, 1, 1.0f / 32);
  for (const auto& [from, left] : {std::pair(&ramp, true), std::pair(&sparse, false)})
    for (const vec3& p : from->positions)
      if ((p.x < 0.5f) == left) {
        uneven.positions.push_back(p);
        uneven.normals.emplace_back(0.0f, 0.0f, 1.0f);
      }
  const Scan scan(uneven);
  for (const float unit : {1.0f / 128, 1.0f / 64, 1.0f / 32}) {
    const Swatch swatch = swatchOf(noise(40));
    const SourceMap map = synthesized(scan.input(swatch, unit), monitor);
    // Links that are copied as they are: most of them, on both sides.
    double copied[2] = {}, all[2] = {};
    const SynthesisInput input = scan.input(swatch, unit);
    const SiteWays ways(input);
    for (Index i = 0; i < scan.points.size(); ++i)
      for (const Index j : scan.neighborhoods.of(i).first(4)) {
        vec2 d = map.texel[j] - map.texel[i] - ways.between(i, j).pixels;
        d -= glm::round(d / 40.0f) * 40.0f;
        const int side = scan.points.positions[i].x < 0.5f ? 0 : 1;
        copied[side] += glm::length(d) < 0.5f;
        ++all[side];
      }
    CAPTURE(unit);
    CHECK(copied[0] / all[0] > 0.75);
    CHECK(copied[1] / all[1] > 0.4);
  }
}

TEST_CASE("coordinates look like the swatch") {
  Workers workers(2);
  Monitor monitor(workers);
  const Scan scan = plane(96);
  const Swatch swatch = swatchOf(blobs(48));
  const auto score = [&](Method method) {
    TextureOptions options;
    options.method = method;
    const SourceMap map = synthesize(scan.input(swatch), options, monitor).map;
    return scoreTexture({.points = scan.points,
                         .neighborhoods = scan.neighborhoods,
                         .colours = map.colour,
                         .swatch = swatch,
                         .unit = kSpacing,
                         .map = &map},
                        {.evaluationPoints = 800}, monitor)
        .F;
  };
  const double coordinates = score(Method::Coordinates);
  CHECK(coordinates > 0.6);
  CHECK(coordinates > score(Method::Random) + 0.4);
}
