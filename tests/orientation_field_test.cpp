#include "regions/orientation_field.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "fixtures.h"
#include "points/tangent_frames.h"
#include "regions/singularities.h"
#include "regions/smooth_field.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

struct Surface {
  PointSet points;
  Neighborhoods neighborhoods;
};

Surface surfaceOf(PointSet points) {
  Surface out{.points = std::move(points)};
  out.neighborhoods = neighbourhoods(out.points);
  return out;
}

// Radius 1 around the y axis, y from 0 to 4, without lids.
PointSet cylinder(int around) {
  PointSet out;
  const float step = 2 * kPi / static_cast<float>(around);
  for (int row = 0; static_cast<float>(row) * step < 4; ++row)
    for (int c = 0; c < around; ++c) {
      const float angle = step * (static_cast<float>(c) + 0.5f * hashUniform(1, row, c));
      const vec3 n(std::cos(angle), 0, std::sin(angle));
      out.positions.push_back(
          n + vec3(0, step * (static_cast<float>(row) + 0.5f * hashUniform(2, row, c)), 0));
      out.normals.push_back(n);
    }
  return inMortonOrder(out);
}

// Around the y axis, radii 1 and 0.4.
PointSet torus(int around) {
  PointSet out;
  const int tube = around * 2 / 5;
  for (int a = 0; a < around; ++a)
    for (int b = 0; b < tube; ++b) {
      const float u = 2 * kPi * (static_cast<float>(a) + 0.5f * hashUniform(3, a, b)) /
                      static_cast<float>(around);
      const float v = 2 * kPi * (static_cast<float>(b) + 0.5f * hashUniform(4, a, b)) /
                      static_cast<float>(tube);
      const vec3 out1(std::cos(u), 0, std::sin(u));
      const vec3 n = std::cos(v) * out1 + std::sin(v) * vec3(0, 1, 0);
      out.positions.push_back(out1 + 0.4f * n);
      out.normals.push_back(n);
    }
  return inMortonOrder(out);
}

// Two squares that meet along the y axis at a right angle: z = 0 for x < 0, x = 0 for z < 0.
PointSet fold(float spacing) {
  PointSet out;
  for (const vec3& p : makePlane(1, 1, spacing).positions) {
    out.positions.push_back({-p.x, p.y, 0});
    out.normals.push_back({0, 0, 1});
    out.positions.push_back({0, p.y, -p.x});
    out.normals.push_back({1, 0, 0});
  }
  return inMortonOrder(out);
}

Index nearest(const PointSet& points, const vec3& to) {
  Index best = 0;
  for (Index i = 1; i < points.size(); ++i)
    if (distanceBetween(points.positions[i], to) < distanceBetween(points.positions[best], to))
      best = i;
  return best;
}

Stroke strokeAlong(const PointSet& points, const std::vector<vec3>& line) {
  Stroke stroke{.positions = line};
  for (const vec3& p : line) stroke.points.push_back(nearest(points, p));
  return stroke;
}

OrientationField orient(const Surface& surface, const std::vector<Stroke>& strokes,
                        const FieldOptions& options = {}, unsigned threads = 2) {
  Workers workers(threads);
  Monitor monitor(workers);
  return orientPoints(surface.points, surface.neighborhoods, strokes, options, monitor);
}

// Degrees between two directions, of N-fold ones the least.
float angleBetween(const vec3& a, const vec3& b, int folds = 1) {
  const float angle = std::acos(std::clamp(glm::dot(a, b), -1.f, 1.f)) * 180 / kPi;
  const float period = 360.f / static_cast<float>(folds);
  const float rest = std::fmod(angle, period);
  return std::min(rest, period - rest);
}

float farthestFrom(const OrientationField& field, const vec3& direction, int folds = 1) {
  float most = 0;
  for (const TangentFrame& frame : field.frames)
    most = std::max(most, angleBetween(frame.t, direction, folds));
  return most;
}

std::vector<Singularity> singular(const Surface& surface, const OrientationField& field,
                                  FieldSymmetry symmetry = FieldSymmetry::None) {
  Workers workers(2);
  Monitor monitor(workers);
  return singularities(surface.points, surface.neighborhoods, field.frames, symmetry, monitor);
}

int indexSum(const std::vector<Singularity>& all) {
  int sum = 0;
  for (const Singularity& s : all) sum += s.index;
  return sum;
}

double kinks(const Surface& surface, const OrientationField& field, FieldSymmetry symmetry) {
  const auto all = singular(surface, field, symmetry);
  const auto spacing =
      static_cast<float>(meanSpacing(surface.neighborhoods, surface.points.positions));
  return kinkedShare(surface.points, surface.neighborhoods, field.frames, symmetry,
                     {.singularities = all, .clearance = 5 * spacing});
}

void checkFrames(const Surface& surface, const OrientationField& field) {
  REQUIRE(field.frames.size() == surface.points.size());
  for (std::size_t i = 0; i < field.frames.size(); ++i) {
    const TangentFrame& f = field.frames[i];
    REQUIRE(glm::length(f.n - surface.points.normals[i]) < 1e-4f);
    REQUIRE(std::abs(glm::dot(f.t, f.n)) < 1e-4f);
    REQUIRE(glm::length(f.t) == doctest::Approx(1).epsilon(1e-4));
    REQUIRE(glm::length(glm::cross(f.s, f.t) - f.n) < 1e-4f);
  }
}

const FieldMethod kDrawn[] = {FieldMethod::Smooth, FieldMethod::Spread, FieldMethod::Diffuse};

}  // namespace

TEST_CASE("two parallel strokes on a plane give one direction everywhere") {
  const Surface plane = surfaceOf(makePlane(1, 1, 0.025f));
  const vec3 along = glm::normalize(vec3(2, 1, 0));
  const std::vector<Stroke> strokes{
      strokeAlong(plane.points, {{0.2f, 0.2f, 0}, vec3(0.2f, 0.2f, 0) + 0.4f * along}),
      strokeAlong(plane.points, {{0.4f, 0.6f, 0}, vec3(0.4f, 0.6f, 0) + 0.4f * along})};
  for (const FieldMethod method : kDrawn)
    for (const FieldSymmetry symmetry :
         {FieldSymmetry::None, FieldSymmetry::Half, FieldSymmetry::Quarter}) {
      const OrientationField field =
          orient(plane, strokes, {.method = method, .symmetry = symmetry});
      checkFrames(plane, field);
      CHECK(farthestFrom(field, along) < 0.5f);
      CHECK(field.scale.empty());
    }
}

TEST_CASE("opposite strokes are one direction for a symmetry of half a turn") {
  const Surface plane = surfaceOf(makePlane(1, 1, 0.03f));
  const std::vector<Stroke> strokes{strokeAlong(plane.points, {{0.1f, 0.2f, 0}, {0.9f, 0.2f, 0}}),
                                    strokeAlong(plane.points, {{0.9f, 0.8f, 0}, {0.1f, 0.8f, 0}})};
  const OrientationField field = orient(plane, strokes, {.symmetry = FieldSymmetry::Half});
  CHECK(farthestFrom(field, {1, 0, 0}) < 0.5f);  // as the first is drawn
  const Stroke across = strokeAlong(plane.points, {{0.5f, 0.1f, 0}, {0.5f, 0.15f, 0}});
  const OrientationField quarter =
      orient(plane, {strokes[0], across}, {.symmetry = FieldSymmetry::Quarter});
  CHECK(farthestFrom(quarter, {1, 0, 0}) < 0.5f);
}

TEST_CASE("a stroke against up turns a whole plane round") {
  const Surface plane = surfaceOf(makePlane(1, 1, 0.02f));
  const std::vector<Stroke> down{strokeAlong(plane.points, {{0.5f, 0.55f, 0}, {0.5f, 0.45f, 0}})};
  CHECK(farthestFrom(orient(plane, down), {0, -1, 0}) < 0.5f);
}

TEST_CASE("an axial stroke on a cylinder gives an axial field, a ring a field around it") {
  const Surface surface = surfaceOf(cylinder(60));
  const OrientationField axial =
      orient(surface, {strokeAlong(surface.points, {{1, 1, 0}, {1, 3, 0}})});
  CHECK(farthestFrom(axial, {0, 1, 0}) < 1);
  std::vector<vec3> ring;
  for (int a = 0; a <= 12; ++a) ring.push_back({std::cos(a * kPi / 6), 2, std::sin(a * kPi / 6)});
  const OrientationField around = orient(surface, {strokeAlong(surface.points, ring)});
  float most = 0;
  for (std::size_t i = 0; i < surface.points.size(); ++i)
    most = std::max(most, angleBetween(around.frames[i].t,
                                       glm::cross(surface.points.normals[i], vec3(0, 1, 0))));
  CHECK(most < 6);  // its chords cut corners, and points lie beside the line
}

TEST_CASE("the directions of strokes are met at their points, their sum where they cross") {
  const Surface sphere = surfaceOf(makeSphere(4000, 1));
  std::vector<Stroke> strokes{
      strokeAlong(sphere.points, {{1, 0, 0}, {0.7f, 0.7f, 0}, {0, 1, 0}}),
      strokeAlong(sphere.points, {{-1, 0, 0}, {-0.7f, 0, 0.7f}, {0, 0, 1}})};
  Workers workers(1);
  Monitor monitor(workers);
  for (const FieldMethod method : kDrawn) {
    const OrientationField field = orient(sphere, strokes, {.method = method});
    for (const StrokeMark& mark : strokeMarks(sphere.points, sphere.neighborhoods, strokes))
      CHECK(angleBetween(field.frames[mark.point].t, mark.direction) < 1);
  }
  const Surface plane = surfaceOf(makePlane(1, 1, 0.1f, 0));
  Stroke x = strokeAlong(plane.points, {{0.45f, 0.45f, 0}, {0.55f, 0.45f, 0}});
  Stroke y = strokeAlong(plane.points, {{0.45f, 0.45f, 0}, {0.45f, 0.55f, 0}});
  x.weight = 3;
  const OrientationField crossed = orient(plane, {x, y});
  CHECK(angleBetween(crossed.frames[x.points[0]].t, glm::normalize(vec3(3, 1, 0))) < 0.1f);
}

TEST_CASE("without strokes the field is upright, and smooth where it cannot be") {
  CHECK(farthestFrom(orient(surfaceOf(makePlane(1, 1, 0.05f)), {}), {0, 1, 0}) < 0.1f);
  CHECK(farthestFrom(orient(surfaceOf(cylinder(40)), {}), {0, 1, 0}) < 1);
  // A plane that faces up has no upright direction.
  CHECK(farthestFrom(orient(surfaceOf(makePlane(1, 1, 0.05f)), {}, {.up = {0, 0, 2}}), {1, 0, 0}) <
        0.1f);
  const Surface sphere = surfaceOf(makeSphere(20000, 1));
  const OrientationField field = orient(sphere, {});
  const std::vector<TangentFrame> upright = framesTowards(sphere.points, {0, 1, 0});
  float most = 0;
  for (std::size_t i = 0; i < upright.size(); ++i)
    if (std::abs(sphere.points.normals[i].y) < 0.7f)
      most = std::max(most, angleBetween(field.frames[i].t, upright[i].t));
  CHECK(most < 8);
  CHECK(kinks(sphere, field, FieldSymmetry::None) < 0.003);
}

TEST_CASE("on a sphere the indices of the singularities sum to two, on a torus there are none") {
  const FieldSymmetry symmetries[] = {FieldSymmetry::None, FieldSymmetry::Half,
                                      FieldSymmetry::Quarter};
  const Surface sphere = surfaceOf(makeSphere(20000, 1));
  const Surface ring = surfaceOf(torus(150));
  const std::vector<Stroke> drawn{
      strokeAlong(sphere.points, {{1, 0, 0}, {0.8f, 0.2f, 0.5f}, {0, 0.3f, 1}}),
      strokeAlong(sphere.points, {{-1, 0, 0}, {-0.7f, 0.6f, 0}, {0, 1, 0.2f}})};
  for (const FieldSymmetry symmetry : symmetries) {
    for (const bool strokes : {false, true}) {
      const OrientationField field =
          orient(sphere, strokes ? drawn : std::vector<Stroke>{}, {.symmetry = symmetry});
      const auto found = singular(sphere, field, symmetry);
      CHECK(indexSum(found) == 2 * foldsOf(symmetry));
      CHECK(kinks(sphere, field, symmetry) < 0.003);
      for (const Singularity& s : found)
        CHECK(distanceBetween(sphere.points.positions[s.point], s.position) < 0.05f);
    }
    const OrientationField field =
        orient(ring, {strokeAlong(ring.points, {{1.4f, 0, 0}, {1.2f, 0, 0.7f}, {0.7f, 0, 1.2f}})},
               {.symmetry = symmetry});
    // Pairs of a half or a quarter of a turn may make it smoother still.
    if (symmetry == FieldSymmetry::None) CHECK(singular(ring, field, symmetry).empty());
    CHECK(indexSum(singular(ring, field, symmetry)) == 0);
    CHECK(kinks(ring, field, symmetry) < 0.003);
  }
}

TEST_CASE("known singularities are found where they are, with their index") {
  const Surface plane = surfaceOf(makePlane(1, 1, 0.02f));
  const vec3 centre(0.51f, 0.48f, 0);
  for (const int index : {-2, -1, 1, 2}) {
    OrientationField field;
    for (const vec3& p : plane.points.positions) {
      const float angle =
          static_cast<float>(index) / 2 * std::atan2(p.y - centre.y, p.x - centre.x);
      field.frames.push_back(orthonormalFrame({0, 0, 1}, {std::cos(angle), std::sin(angle), 0}));
    }
    const auto found = singular(plane, field, FieldSymmetry::Half);
    REQUIRE(found.size() == 1);
    CHECK(found[0].index == index);
    CHECK(distanceBetween(found[0].position, centre) < 0.02f);
  }
}

TEST_CASE("rotating the input rotates the field") {
  PointSet points = torus(80);
  const Surface surface = surfaceOf(points);
  const auto turned = [](const vec3& v) {  // about two axes
    const vec3 a(0.8f * v.x - 0.6f * v.y, 0.6f * v.x + 0.8f * v.y, v.z);
    return vec3(a.x, 0.6f * a.y - 0.8f * a.z, 0.8f * a.y + 0.6f * a.z);
  };
  Surface rotated = surface;
  for (vec3& p : rotated.points.positions) p = turned(p);
  for (vec3& n : rotated.points.normals) n = turned(n);
  std::vector<Stroke> strokes{strokeAlong(points, {{1.4f, 0, 0}, {1, 0.4f, 0}, {0.6f, 0, 0}})};
  for (const bool drawn : {false, true}) {
    const std::vector<Stroke> here = drawn ? strokes : std::vector<Stroke>{};
    std::vector<Stroke> there = here;
    for (Stroke& stroke : there)
      for (vec3& p : stroke.positions) p = turned(p);
    const OrientationField a = orient(surface, here),
                           b = orient(rotated, there, {.up = turned({0, 1, 0})});
    float most = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      most = std::max(most, angleBetween(turned(a.frames[i].t), b.frames[i].t));
    CHECK(most < 0.5f);
  }
}

TEST_CASE("noise of a tenth of the spacing hardly turns directions") {
  const Surface clean = surfaceOf(torus(120));
  const auto spacing = static_cast<float>(meanSpacing(clean.neighborhoods, clean.points.positions));
  PointSet noisy = clean.points;
  for (std::size_t i = 0; i < noisy.size(); ++i)
    for (int c = 0; c < 3; ++c)
      noisy.positions[i][c] += 0.2f * spacing * (hashUniform(9, i, c) - 0.5f);
  const std::vector<Stroke> strokes{
      strokeAlong(clean.points, {{1.4f, 0, 0}, {1.2f, 0, 0.7f}, {0.7f, 0, 1.2f}})};
  const OrientationField a = orient(clean, strokes), b = orient(surfaceOf(noisy), strokes);
  std::vector<float> angles;
  for (std::size_t i = 0; i < noisy.size(); ++i)
    angles.push_back(angleBetween(a.frames[i].t, b.frames[i].t));
  std::nth_element(angles.begin(), angles.begin() + angles.size() / 2, angles.end());
  CHECK(angles[angles.size() / 2] < 5);
}

TEST_CASE("the hierarchy and plain diffusion agree") {
  const Surface plane = surfaceOf(makePlane(1, 1, 0.05f));
  const std::vector<Stroke> strokes{strokeAlong(plane.points, {{0.05f, 0.1f, 0}, {0.05f, 0.9f, 0}}),
                                    strokeAlong(plane.points, {{0.6f, 0.3f, 0}, {0.9f, 0.6f, 0}})};
  for (const FieldSymmetry symmetry : {FieldSymmetry::None, FieldSymmetry::Half})
    for (const bool drawn : {false, true}) {
      const std::vector<Stroke> here = drawn ? strokes : std::vector<Stroke>{};
      const OrientationField a = orient(plane, here, {.symmetry = symmetry});
      const OrientationField b =
          orient(plane, here, {.method = FieldMethod::Diffuse, .symmetry = symmetry});
      double sum = 0;
      for (std::size_t i = 0; i < plane.points.size(); ++i)
        sum += angleBetween(a.frames[i].t, b.frames[i].t, foldsOf(symmetry));
      CHECK(sum / static_cast<double>(plane.points.size()) < 1);
    }
}

TEST_CASE("the same bytes at one, two and three threads") {
  const Surface surface = surfaceOf(torus(200));
  std::vector<Stroke> strokes{strokeAlong(surface.points, {{1.4f, 0, 0}, {1, 0.4f, 0}})};
  strokes[0].scale = 2;
  for (const FieldSymmetry symmetry : {FieldSymmetry::None, FieldSymmetry::Quarter}) {
    const OrientationField one = orient(surface, strokes, {.symmetry = symmetry}, 1);
    for (const unsigned threads : {2u, 3u}) {
      const OrientationField more = orient(surface, strokes, {.symmetry = symmetry}, threads);
      bool same = one.scale == more.scale;
      for (std::size_t i = 0; i < one.frames.size(); ++i)
        same = same && one.frames[i].s == more.frames[i].s && one.frames[i].t == more.frames[i].t;
      CHECK(same);
    }
  }
}

TEST_CASE("directions cross a crease or end there, as asked for") {
  const Surface surface = surfaceOf(fold(0.04f));
  // Along y on one side; across it, a direction of its own: down.
  const std::vector<Stroke> strokes{
      strokeAlong(surface.points, {{-0.5f, 0.8f, 0}, {-0.5f, 0.2f, 0}})};
  for (const FieldMethod method : kDrawn) {
    const OrientationField carried = orient(surface, strokes, {.method = method});
    CHECK(farthestFrom(carried, {0, -1, 0}) < 3);
    const OrientationField broken =
        orient(surface, strokes, {.method = method, .creases = Creases::Break});
    for (std::size_t i = 0; i < surface.points.size(); ++i)
      REQUIRE(angleBetween(broken.frames[i].t,
                           {0, surface.points.normals[i].z > 0.5f ? -1.f : 1.f, 0}) < 3);
  }
}

TEST_CASE("a part that no stroke reaches keeps its upright field") {
  PointSet both = makePlane(1, 1, 0.04f);
  const std::size_t half = both.size();
  for (std::size_t i = 0; i < half; ++i) {
    both.positions.push_back(both.positions[i] + vec3(3, 0, 0));
    both.normals.push_back(both.normals[i]);
  }
  const Surface surface = surfaceOf(inMortonOrder(both));
  const std::vector<Stroke> strokes{
      strokeAlong(surface.points, {{0.2f, 0.5f, 0}, {0.8f, 0.5f, 0}})};
  for (const FieldMethod method : kDrawn) {
    const OrientationField field = orient(surface, strokes, {.method = method});
    for (std::size_t i = 0; i < surface.points.size(); ++i)
      REQUIRE(angleBetween(field.frames[i].t,
                           surface.points.positions[i].x < 2 ? vec3(1, 0, 0) : vec3(0, 1, 0)) < 1);
  }
}

TEST_CASE("scales hold along their strokes and change steadily in between") {
  const Surface plane = surfaceOf(makePlane(1, 1, 0.025f));
  std::vector<Stroke> strokes{strokeAlong(plane.points, {{0.02f, 0, 0}, {0.02f, 1, 0}}),
                              strokeAlong(plane.points, {{0.98f, 0, 0}, {0.98f, 1, 0}})};
  strokes[0].scale = 4;
  for (const FieldMethod method : kDrawn) {
    const OrientationField field = orient(plane, strokes, {.method = method});
    REQUIRE(field.scale.size() == plane.points.size());
    for (const Index i : strokes[0].points) CHECK(field.scale[i] == doctest::Approx(4));
    for (const Index i : strokes[1].points) CHECK(field.scale[i] == doctest::Approx(1));
    for (std::size_t i = 0; i < plane.points.size(); ++i) {
      const float x = std::clamp((plane.points.positions[i].x - 0.02f) / 0.96f, 0.f, 1.f);
      REQUIRE(std::log(field.scale[i]) ==
              doctest::Approx((1 - x) * std::log(4.f)).scale(1).epsilon(0.12));
    }
  }
}

TEST_CASE("a field that is solved for once has the bytes of one that is kept") {
  const Surface surface = surfaceOf(makeSphere(6000, 1));
  Workers workers(2);
  Monitor monitor(workers);
  std::vector<Stroke> strokes{strokeAlong(surface.points, {{1, 0, 0}, {0, 0, 1}})};
  for (const float scale : {1.f, 2.f}) {
    strokes[0].scale = scale;
    const auto marks = strokeMarks(surface.points, surface.neighborhoods, strokes);
    for (const FieldSymmetry symmetry : {FieldSymmetry::None, FieldSymmetry::Quarter}) {
      const FieldOptions options{.symmetry = symmetry};
      SmoothField kept(surface.points, surface.neighborhoods, options, monitor);
      kept.solve(marks, monitor);
      const OrientationField once =
          SmoothField(surface.points, surface.neighborhoods, options, monitor)
              .solveOnce(marks, monitor);
      REQUIRE(once.frames.size() == surface.points.size());
      for (std::size_t i = 0; i < once.frames.size(); ++i)
        REQUIRE(once.frames[i].t == kept.field().frames[i].t);
      CHECK(once.scale == kept.field().scale);
    }
  }
}

TEST_CASE("levels take 95 bytes a point until the finest is connected") {
  const Surface surface = surfaceOf(makeSphere(20000, 1));
  Workers workers(1);
  Monitor monitor(workers);
  const FieldLevels field = clusterField(surface.points, surface.neighborhoods, {}, 16, monitor);
  const auto bytes = [](const auto& column) { return column.capacity() * sizeof(column[0]); };
  std::size_t all = 0;
  for (const FieldLevel& level : field.levels)
    all += bytes(level.graph.offset) + bytes(level.graph.ids) + bytes(level.turn) +
           bytes(level.pull) + bytes(level.parent) + bytes(level.fromParent);
  CHECK(field.levels[0].turn.empty());
  CHECK(all / surface.points.size() <= 95);  // 40 of them are the links of the points
}

TEST_CASE("an update turns what an edit touches as a full solution would") {
  const Surface surface = surfaceOf(torus(420));  // 70,560 points: two levels are refreshed
  Workers workers(2);
  Monitor monitor(workers);
  const std::vector<Stroke> first{
      strokeAlong(surface.points, {{1.4f, 0, 0}, {0, 0, 1.4f}, {-1.4f, 0, 0}, {0, 0, -1.4f}})};
  std::vector<Stroke> second = first;
  second.push_back(strokeAlong(surface.points, {{0.98f, 0.4f, 0.1f}, {0.98f, 0.4f, 0.16f}}));
  const auto marks = [&](const std::vector<Stroke>& strokes) {
    return strokeMarks(surface.points, surface.neighborhoods, strokes);
  };
  for (const FieldSymmetry symmetry : {FieldSymmetry::None, FieldSymmetry::Half}) {
    const int folds = foldsOf(symmetry);
    SmoothField kept(surface.points, surface.neighborhoods, {.symmetry = symmetry}, monitor);
    kept.solve(marks(first), monitor);
    const std::vector<TangentFrame> before = kept.field().frames;
    CHECK(kept.update(marks(first), 0.5f, monitor).empty());
    const std::vector<Index> turned = kept.update(marks(second), 0.5f, monitor);
    CHECK(turned.size() > 100);
    CHECK(turned.size() < surface.points.size());
    std::vector<bool> isTurned(surface.points.size(), false);
    for (const Index i : turned) isTurned[i] = true;
    const OrientationField full = orient(surface, second, {.symmetry = symmetry});
    double sum = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const vec3& now = kept.field().frames[i].t;
      REQUIRE((now != before[i].t) == isTurned[i]);
      sum += angleBetween(now, full.frames[i].t, folds);
    }
    CHECK(sum / static_cast<double>(before.size()) < 0.5);
    for (const StrokeMark& mark : marks(second))
      CHECK(angleBetween(kept.field().frames[mark.point].t, mark.direction, folds) < 1);
  }
}

TEST_CASE("up and random directions ignore the strokes") {
  const Surface plane = surfaceOf(makePlane(1, 1, 0.1f));
  const std::vector<Stroke> strokes{strokeAlong(plane.points, {{0.2f, 0.5f, 0}, {0.8f, 0.5f, 0}})};
  CHECK(farthestFrom(orient(plane, strokes, {.method = FieldMethod::Up}), {0, 1, 0}) < 0.1f);
  const OrientationField random = orient(plane, strokes, {.method = FieldMethod::Random});
  CHECK(random.frames[0].t == orient(plane, {}, {.method = FieldMethod::Random}).frames[0].t);
  CHECK(random.frames[0].t !=
        orient(plane, {}, {.method = FieldMethod::Random, .seed = 2}).frames[0].t);
}

TEST_CASE("a handful of points, lonely ones and a stop are no problem") {
  PointSet few = makePlane(0.3f, 0.3f, 0.1f);
  const Surface nine{few, neighbourhoods(few, 8)};
  checkFrames(nine, orient(nine, {}));
  const Surface one{{.positions = {{0, 0, 0}}, .normals = {{0, 0, 1}}}, {}};
  checkFrames(one, orient(one, {}));
  const Surface sphere = surfaceOf(makeSphere(3000, 1));
  std::stop_source stop;
  stop.request_stop();
  Workers workers(1);
  Monitor monitor(workers, stop.get_token());
  CHECK_THROWS_AS(orientPoints(sphere.points, sphere.neighborhoods, {}, {}, monitor), Cancelled);
  CHECK_THROWS_AS(orient(sphere, {Stroke{}}), InvalidInput);
}
