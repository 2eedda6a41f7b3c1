#include "synthesis/neighborhood_matching.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "same_maps.h"
#include "synthesis/matching_level.h"

using namespace dapple;
using dapple::testing::sameMaps;

namespace {

constexpr float kUnit = 1.0f / 64;  // a power of two: offsets on the grid are exact

struct Scan {
  PointSet points;
  std::vector<TangentFrame> frames;
  Neighborhoods neighborhoods;
};

// A plane z = 0 of side x side points, one per pixel, shifted by up to `jitter` pixels.
Scan plane(int side, float jitter, std::size_t k, Monitor& monitor) {
  std::vector<vec3> raw;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const std::size_t id = raw.size();
      const float dx = jitter * (2 * hashUniform(9, id, 1) - 1);
      const float dy = jitter * (2 * hashUniform(9, id, 2) - 1);
      raw.push_back(
          {(static_cast<float>(x) + dx) * kUnit, (static_cast<float>(y) + dy) * kUnit, 0});
    }
  }
  Scan scan;
  for (Index i : mortonOrder(raw)) scan.points.positions.push_back(raw[i]);
  scan.points.normals.assign(raw.size(), vec3(0, 0, 1));
  scan.frames.assign(raw.size(), TangentFrame{});
  scan.neighborhoods = buildNeighborhoods(scan.points.positions, k, monitor);
  return scan;
}

// Smooth blobs, periodic over w x h; alpha 0 in a disc when `hole`.
Swatch blobs(int w, int h, Tileable tileable, bool hole, int levels) {
  Image image{w, h, 4, std::vector<float>(static_cast<std::size_t>(w) * h * 4, 1.0f)};
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const float u = 6.2831853f * static_cast<float>(x) / static_cast<float>(w);
      const float v = 6.2831853f * static_cast<float>(y) / static_cast<float>(h);
      for (int c = 0; c < 3; ++c) {
        const auto f = static_cast<float>(c + 1);
        image.at(x, y, c) = 0.5f + 0.2f * std::sin(f * u + v) + 0.2f * std::cos(f * v - 2 * u) +
                            0.1f * (hashUniform(4, x, y, c) - 0.5f);
      }
      const int dx = x - w / 2, dy = y - h / 2;
      if (hole && dx * dx + dy * dy < w * w / 25) image.at(x, y, 3) = 0;
    }
  }
  return makeSwatch(image, tileable, levels, "blobs");
}

// The texel that a plane point shows when the swatch is laid on it with its origin at the origin.
vec2 laidTexel(const Scan& scan, const Swatch& swatch, std::size_t i) {
  const vec3 p = scan.points.positions[i] / kUnit;
  return wrapTexel(swatch, vec2(p.x, -p.y) + 0.5f);
}

SourceMap emptyMap(const Scan& scan) {
  SourceMap map = emptySourceMap(scan.points.size(), kUnit);
  map.frame = scan.frames;
  return map;
}

// A map in which the points left of `edge` pixels are a patch of the swatch laid on the plane.
SourceMap patchMap(const Scan& scan, const Swatch& swatch, float edge) {
  SourceMap map = emptyMap(scan);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.points.positions[i].x >= edge * kUnit) continue;
    map.texel[i] = laidTexel(scan, swatch, i);
    map.colour[i] = sampleSwatch(swatch, map.texel[i]);
    map.state[i] = PointState::Patch;
    map.patch[i] = 0;
  }
  return map;
}

SynthesisInput inputOf(const Scan& scan, const Swatch& swatch) {
  return {scan.points, scan.neighborhoods, swatch, scan.frames, kUnit};
}

constexpr struct {
  bool coherent;
  int levels;
  bool asPrinted;
} kModes[] = {{true, 1, false},  {true, 3, false}, {false, 1, false},
              {false, 3, false}, {false, 1, true}, {false, 2, true}};

}  // namespace

TEST_CASE("coherent matching from a patch's border copies the swatch on without any error") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = plane(48, 0, 24, monitor);
  const Swatch swatch = blobs(20, 16, Tileable::Yes, false, 4);
  REQUIRE(swatch.tileable);
  for (bool coherent : {true, false}) {
    SourceMap map = patchMap(scan, swatch, 8);
    const auto statistics =
        matchNeighborhoods(inputOf(scan, swatch), {.coherent = coherent}, map, monitor);
    CHECK(statistics.matched == 48 * 40);
    CHECK(statistics.meanError == 0);
    CHECK(statistics.searches == (coherent ? 0 : 48 * 40));
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      REQUIRE(map.texel[i] == laidTexel(scan, swatch, i));
      REQUIRE(map.error[i] == 0);
    }
  }
}

TEST_CASE("on uneven points a verbatim copy stays verbatim far from where it began") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = plane(48, 0.35f, 24, monitor);
  const Swatch swatch = blobs(20, 16, Tileable::Yes, false, 4);
  SourceMap map = patchMap(scan, swatch, 8);
  matchNeighborhoods(inputOf(scan, swatch), {}, map, monitor);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    vec2 d = map.texel[i] - laidTexel(scan, swatch, i);
    d -= glm::round(d / vec2(20, 16)) * vec2(20, 16);
    REQUIRE(glm::length(d) < 1e-3f);  // rounding only: offsets there and back are equal
  }
}

TEST_CASE("a coherent choice is never worse than any prediction of its neighbours") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = plane(24, 0.3f, 16, monitor);
  const Swatch swatch = blobs(20, 16, Tileable::Yes, false, 1);
  MatchingLevel level({.positions = scan.points.positions,
                       .frames = scan.frames,
                       .neighborhoods = scan.neighborhoods,
                       .parent = {},
                       .coarse = nullptr,
                       .swatch = swatch,
                       .stackLevel = 0,
                       .unit = kUnit,
                       .merge = 0,
                       .seed = 1},
                      false);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const auto id = static_cast<Index>(i);
    if (hashBelow(3, 1, i) > 0) level.set(id, level.randomPlace(id, 2));
  }
  MatchScratch scratch;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const MatchSite& site = level.sites()[i];
    std::vector<vec2> offsets, predictions;
    std::vector<vec3> colours;
    for (Index j : scan.neighborhoods.of(i)) {
      const MatchSite& other = level.sites()[j];
      vec2 offset;
      if (!other.known || !level.offsetBetween(site, other, offset)) continue;
      offsets.push_back(offset);
      predictions.push_back(other.place - offset);
      colours.push_back(other.colour);
    }
    if (offsets.empty()) continue;
    const auto errorAt = [&](vec2 place) {
      double sum = 0;
      for (std::size_t t = 0; t < offsets.size(); ++t) {
        const vec3 d = sampleSwatch(swatch, place + offsets[t] + 0.5f) - colours[t];
        sum += static_cast<double>(glm::dot(d, d));
      }
      return sum / static_cast<double>(3 * offsets.size());
    };
    const MatchChoice choice = level.match(static_cast<Index>(i), {}, scratch);
    const double chosen = errorAt(choice.place);
    REQUIRE(choice.error == doctest::Approx(chosen).epsilon(1e-3));
    for (const vec2& prediction : predictions) {
      REQUIRE(chosen <= errorAt(prediction) * (1 + 1e-4) + 1e-9);
      ++compared;
    }
  }
  CHECK(compared > 2000);
}

TEST_CASE("all modes give the same bytes at 1 and 3 threads, and others for another seed") {
  Workers one(1);
  Monitor setup(one);
  const Scan scan = plane(32, 0.3f, 16, setup);
  for (Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = blobs(32, 27, tileable, false, 4);
    for (const auto& mode : kModes) {
      MatchingOptions options{mode.coherent, mode.levels, 1, mode.asPrinted};
      std::vector<SourceMap> maps;
      for (unsigned threads : {1u, 3u}) {
        Workers workers(threads);
        Monitor monitor(workers);
        maps.push_back(emptyMap(scan));
        matchNeighborhoods(inputOf(scan, swatch), options, maps.back(), monitor);
      }
      CHECK(sameMaps(maps[0], maps[1]));
      options.seed = 2;
      SourceMap other = emptyMap(scan);
      matchNeighborhoods(inputOf(scan, swatch), options, other, setup);
      CHECK(!sameMaps(maps[0], other));
    }
  }
}

TEST_CASE("patch points keep all they have, and every other point is matched in some order") {
  Workers workers(2);
  Monitor monitor(workers);
  const Scan scan = plane(32, 0.3f, 16, monitor);
  const Swatch swatch = blobs(32, 27, Tileable::Yes, false, 4);
  for (const auto& mode : kModes) {
    const SourceMap before = patchMap(scan, swatch, 12);
    SourceMap map = before;
    map.state[scan.points.size() - 1] = PointState::Gap;
    const auto statistics = matchNeighborhoods(
        inputOf(scan, swatch), {mode.coherent, mode.levels, 5, mode.asPrinted}, map, monitor);
    std::vector<Index> ranks;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (before.state[i] == PointState::Patch) {
        REQUIRE(map.state[i] == PointState::Patch);
        REQUIRE(map.texel[i] == before.texel[i]);
        REQUIRE(map.colour[i] == before.colour[i]);
        REQUIRE(map.order[i] == before.order[i]);
        continue;
      }
      REQUIRE(map.state[i] == PointState::Matched);
      REQUIRE(map.patch[i] == kNone);
      ranks.push_back(map.order[i]);
    }
    std::sort(ranks.begin(), ranks.end());
    REQUIRE(statistics.matched == ranks.size());
    for (std::size_t r = 0; r < ranks.size(); ++r) REQUIRE(ranks[r] == r);
  }
}

TEST_CASE("texels stay inside the image and off its transparent part") {
  Workers workers(2);
  Monitor monitor(workers);
  const Scan scan = plane(32, 0.3f, 16, monitor);
  for (bool hole : {false, true}) {
    const Swatch swatch = blobs(36, 40, Tileable::No, hole, 4);
    for (const auto& mode : kModes) {
      SourceMap map = emptyMap(scan);
      matchNeighborhoods(inputOf(scan, swatch), {mode.coherent, mode.levels, 3, mode.asPrinted},
                         map, monitor);
      for (const vec2& texel : map.texel) REQUIRE(usableTexel(swatch, texel));
    }
  }
}

TEST_CASE("the smallest swatches are matched too") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = plane(12, 0.3f, 16, monitor);
  for (Tileable tileable : {Tileable::Yes, Tileable::No}) {
    const Swatch swatch = blobs(2, 3, tileable, false, 4);
    for (const auto& mode : kModes) {
      SourceMap map = emptyMap(scan);
      const auto statistics = matchNeighborhoods(
          inputOf(scan, swatch), {mode.coherent, mode.levels, 3, mode.asPrinted}, map, monitor);
      CHECK(statistics.matched == scan.points.size());
      for (const vec2& texel : map.texel) REQUIRE(usableTexel(swatch, texel));
    }
  }
}

TEST_CASE("stopping throws Cancelled, at any moment, and leaves the map as it was") {
  Workers workers(2);
  Monitor setup(workers);
  const Scan scan = plane(40, 0.3f, 16, setup);
  const Swatch swatch = blobs(32, 27, Tileable::Yes, false, 4);
  for (const auto& mode : kModes) {
    const SourceMap before = patchMap(scan, swatch, 4);
    for (bool early : {true, false}) {
      std::stop_source stop;
      if (early) stop.request_stop();
      // The first preview is asked for in the middle of the work.
      Monitor monitor(workers, stop.get_token(),
                      {.preview = [&](const Preview&) { stop.request_stop(); }});
      SourceMap map = before;
      CHECK_THROWS_AS(
          matchNeighborhoods(inputOf(scan, swatch), {mode.coherent, mode.levels, 1, mode.asPrinted},
                             map, monitor),
          Cancelled);
      CHECK(sameMaps(map, before));
    }
  }
}

TEST_CASE("a preview shows every point with its ancestor once the coarsest level is done") {
  Workers workers(1);
  Monitor setup(workers);
  const Scan scan = plane(40, 0.3f, 16, setup);
  const Swatch swatch = blobs(32, 27, Tileable::Yes, false, 4);
  std::size_t shown = 0, coloured = 0;
  Monitor monitor(workers, {}, {.preview = [&](const Preview& preview) {
                    shown = preview.colours.size();
                    for (const vec3& c : preview.colours) coloured += c != vec3(0);
                    REQUIRE(preview.states.size() == shown);
                  }});
  SourceMap map = emptyMap(scan);
  // As printed the coarsest level is coloured at once, before the first preview.
  matchNeighborhoods(inputOf(scan, swatch), {.levels = 3, .asPrinted = true}, map, monitor);
  CHECK(shown == scan.points.size());
  CHECK(coloured >= scan.points.size());
}

TEST_CASE("an impossible number of levels is refused by name") {
  Workers workers(1);
  Monitor monitor(workers);
  const Scan scan = plane(8, 0, 8, monitor);
  const Swatch swatch = blobs(8, 8, Tileable::Yes, false, 1);
  SourceMap map = emptyMap(scan);
  for (int levels : {0, -1, 9}) {
    CHECK_THROWS_AS(matchNeighborhoods(inputOf(scan, swatch), {.levels = levels}, map, monitor),
                    InvalidInput);
  }
}
