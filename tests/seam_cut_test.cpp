#include "synthesis/seam_cut.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "base/errors.h"
#include "fixtures.h"
#include "swatch/swatch_relief.h"
#include "synthesis/patch_parameterization.h"
#include "synthesis/patch_placement.h"

using namespace dapple;

namespace {

constexpr float kUnit = 1;
const vec2 kShift(7, -11);  // of the right patch's domain

// A plane flattened as one patch, then split by force: a gap, and to its right another patch with
// a domain of its own, placed so that the texture goes on as if there were no split.
struct SplitPlane {
  PointSet points = fixtures::makePlane(80, 60, 1);
  Neighborhoods near = fixtures::neighbourhoods(points);
  std::vector<TangentFrame> frames = fixtures::uprightFrames(points);
  Swatch swatch;
  SynthesisInput input{points, near, swatch, frames, kUnit};
  SourceMap map = emptySourceMap(points.size(), kUnit);
  std::vector<vec3> whole;  // colours before the split

  explicit SplitPlane(const Image& image, Workers& workers)
      : swatch(fixtures::swatchOf(image, Tileable::Yes)) {
    Monitor monitor(workers);
    growPatches(input, {.distortion = std::numeric_limits<float>::infinity(), .smooth = false}, map,
                monitor);
    map.placement[0] = {3.5f, 8.5f};
    map.placement.push_back(map.placement[0] - kShift);
    for (std::size_t i = 0; i < points.size(); ++i) {
      whole.push_back(sampleSwatch(swatch, map.domain[i] + map.placement[0]));
      const float x = points.positions[i].x;
      if (x > 41.5f) map.patch[i] = 1, map.domain[i] += kShift;
      if (x > 38.5f && x <= 41.5f) map.patch[i] = kNone, map.state[i] = PointState::Gap;
      map.texel[i] = map.patch[i] == kNone
                         ? vec2(0)
                         : wrapTexel(swatch, map.domain[i] + map.placement[map.patch[i]]);
      map.colour[i] = sampleSwatch(swatch, map.texel[i]);
    }
  }

  float worstColour() const {
    float worst = 0;
    for (std::size_t i = 0; i < whole.size(); ++i)
      worst = std::max(worst, glm::length(whole[i] - map.colour[i]));
    return worst;
  }
};

}  // namespace

TEST_CASE("two patches that show the same pattern are joined without a visible seam") {
  Workers workers(1);
  Monitor monitor(workers);
  SplitPlane plane(fixtures::blobs(64), workers);
  const PatchOverlap overlap = growOverlap(plane.input, plane.map, 8, monitor);
  const SeamStatistics seams = cutSeams(plane.input, overlap, plane.map, monitor);
  // Distortion is 0 in a plane, and rounding costs less than half a unit of a cut's integers.
  CHECK(seams.energyBefore < 0.02);
  CHECK(seams.energyAfter <= seams.energyBefore);
  CHECK(plane.worstColour() < 0.01f);
}

TEST_CASE("a seam between places that differ in height alone costs as much as in colour") {
  Workers workers(1);
  Monitor monitor(workers);
  SplitPlane plane(fixtures::blobs(64), workers);
  for (std::size_t i = 0; i < plane.points.size(); ++i) plane.map.colour[i] = vec3(0.5f);
  plane.map.placement[1] += vec2(9, 5);
  std::vector<float> relief;
  for (const vec3& c : plane.swatch.colours()) relief.push_back(c.x);
  plane.swatch.stack.front().assign(plane.swatch.pixels(), vec3(0.5f));
  const PatchOverlap overlap = growOverlap(plane.input, plane.map, 8, monitor);
  SourceMap flat = plane.map;
  CHECK(cutSeams(plane.input, overlap, flat, monitor).energyBefore < 0.2);
  setRelief(plane.swatch, relief);
  const SeamStatistics seams = cutSeams(plane.input, overlap, plane.map, monitor);
  CHECK(seams.energyBefore > 5);
  CHECK(seams.energyAfter < 0.8 * seams.energyBefore);
}

TEST_CASE("patches reach over each other by the overlap and no further") {
  Workers workers(1);
  Monitor monitor(workers);
  SplitPlane plane(fixtures::blobs(64), workers);
  const PatchOverlap overlap = growOverlap(plane.input, plane.map, 8, monitor);
  std::size_t choices = 0;
  for (std::size_t i = 0; i < plane.points.size(); ++i) {
    const float x = plane.points.positions[i].x;
    const std::size_t count = overlap.offset[i + 1] - overlap.offset[i];
    REQUIRE(count >= 1);
    REQUIRE(count <= 2);
    choices += count == 2 ? 1 : 0;
    if (x < 32.5f || x > 47.5f) CHECK(count == 1);
    if (x > 36 && x < 44) CHECK(count == 2);
    for (Index c = overlap.offset[i]; c < overlap.offset[i + 1]; ++c) {
      CHECK(overlap.reach[c] <= 8);
      const vec2 expected =
          vec2(plane.map.domain[0]) +
          vec2(1, -1) * vec2(plane.points.positions[i] - plane.points.positions[0]) +
          (overlap.site[c].patch == 1 ? kShift : vec2(0)) -
          (plane.map.patch[0] == 1 ? kShift : vec2(0));
      CHECK(glm::length(overlap.site[c].q - expected) < 0.01f);
    }
  }
  CHECK(choices > plane.points.size() / 10);
}

TEST_CASE("a patch put down askew is moved to where the pattern goes on") {
  Workers workers(1);
  Monitor monitor(workers);
  SplitPlane plane(fixtures::blobs(64), workers);
  const vec2 right = plane.map.placement[1];
  plane.map.placement[1] += vec2(13.3f, 21.9f);
  const PatchOverlap overlap = growOverlap(plane.input, plane.map, 8, monitor);
  CHECK(placePatches(plane.input, overlap, plane.map, monitor) == 1);
  const vec2 off = plane.map.placement[1] - plane.map.placement[0] - (right - vec2(3.5f, 8.5f));
  CHECK(glm::length(off / 64.f - glm::round(off / 64.f)) < 1e-3f);
  const SeamStatistics seams = cutSeams(plane.input, overlap, plane.map, monitor);
  CHECK(seams.energyAfter < 0.02);
}

TEST_CASE("a cut is never worse than the nearest patch, and better where patches disagree") {
  Workers workers(1);
  Monitor monitor(workers);
  for (int step = 1; step <= 6; ++step) {
    SplitPlane plane(fixtures::noise(64), workers);
    plane.map.placement[1] += vec2(9 * step, 5 * step);
    const PatchOverlap overlap = growOverlap(plane.input, plane.map, 8, monitor);
    const SeamStatistics seams = cutSeams(plane.input, overlap, plane.map, monitor);
    CHECK(seams.energyAfter < 0.75 * seams.energyBefore);
    CHECK(seams.changed > 0);
    CHECK(seams.stranded == 0);
  }
}

TEST_CASE("a stopped cut leaves the map as it was") {
  Workers workers(1);
  Monitor monitor(workers);
  SplitPlane plane(fixtures::noise(64), workers);
  const PatchOverlap overlap = growOverlap(plane.input, plane.map, 8, monitor);
  std::stop_source stop;
  stop.request_stop();
  Monitor stopped(workers, stop.get_token());
  const SourceMap before = plane.map;
  CHECK_THROWS_AS(growOverlap(plane.input, plane.map, 8, stopped), Cancelled);
  CHECK_THROWS_AS(cutSeams(plane.input, overlap, plane.map, stopped), Cancelled);
  CHECK(plane.map.texel == before.texel);
  CHECK(plane.map.patch == before.patch);
}
