#include "app/render/overlay.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace dapple;

namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr float kPi = std::numbers::pi_v<float>;

// A sphere of radius 1 at z = 0 before a wall at z = -2, traced from z = 5.
struct Scene {
  std::vector<vec3> positions, normals;
  std::vector<float> radii;
  Camera camera{.eye = {0, 0, 5}, .target = {0, 0, 0}, .nearPlane = 1, .farPlane = 20};
  Raster traced;

  explicit Scene(bool orthographic = false) {
    if (orthographic) camera.orthographicHeight = 3;
    constexpr int kPoints = 20000;
    const float spacing = std::sqrt(4 * kPi / kPoints);
    for (int i = 0; i < kPoints; ++i) {
      const double y = 1 - (2.0 * i + 1) / kPoints, r = std::sqrt(1 - y * y);
      const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
      add(vec3(r * std::cos(angle), y, r * std::sin(angle)), spacing);
      normals.push_back(positions.back());
    }
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x) {
        add({0.03f * (x - 99.5f), 0.03f * (y - 99.5f), -2}, 0.03f);
        normals.emplace_back(0, 0, 1);
      }
    Workers workers(2);
    CpuSplatter splatter(workers);
    const std::vector<vec3> colours(positions.size(), vec3(0.5f));
    splatter.update({positions, normals, colours, radii});
    traced.trace = true;
    splatter.draw(camera, kWidth, kHeight, {}, traced);
  }
  void add(const vec3& p, float spacing) {
    positions.push_back(p);
    radii.push_back(splatRadius(spacing));
  }
  OverlayView view(float scale = 1) const { return {camera, traced, radii[0], scale}; }
  vec2 pixel(const vec3& p) const { return projectPoint(camera, kWidth, kHeight, p); }
};

// The light lines, without their casing: the second half.
OverlayLines cores(const OverlayLines& lines) {
  return {lines.begin() + static_cast<std::ptrdiff_t>(lines.size() / 2), lines.end()};
}

float distanceTo(vec2 p, const OverlayLine& line) {
  float least = 1e9f;
  const std::size_t n = line.points.size();
  for (std::size_t i = 0; i + (line.closed ? 0 : 1) < n; ++i) {
    const vec2 a = line.points[i], b = line.points[(i + 1) % n], d = b - a;
    const float t =
        glm::dot(d, d) > 0 ? std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.f, 1.f) : 0.f;
    least = std::min(least, glm::distance(p, a + t * d));
  }
  return least;
}
float distanceTo(vec2 p, std::span<const OverlayLine> lines) {
  float least = 1e9f;
  for (const OverlayLine& line : lines) least = std::min(least, distanceTo(p, line));
  return least;
}

// Half a meridian of the sphere, from the front over the side to the back.
std::vector<vec3> meridian(float from, float to) {
  std::vector<vec3> line;
  for (int k = 0; k <= 40; ++k) {
    const float angle = from + (to - from) * static_cast<float>(k) / 40;
    line.emplace_back(std::sin(angle), 0, std::cos(angle));
  }
  return line;
}

}  // namespace

TEST_CASE("a stroke is drawn as far as it is seen, with a head where it ends") {
  for (const bool orthographic : {false, true}) {
    const Scene scene(orthographic);
    const std::vector<vec3> front = meridian(-0.8f, 0.8f), around = meridian(0, kPi);
    const SurfaceStroke one[] = {{front}}, other[] = {{around}};
    const OverlayLines whole = strokeLines(scene.view(), one);
    REQUIRE(whole.size() == 4);  // casing and line, of shaft and head
    const OverlayLine line = cores(whole)[0];
    CHECK(glm::distance(line.points.front(), scene.pixel(front.front())) < 0.1f);
    CHECK(glm::distance(line.points.back(), scene.pixel(front.back())) < 0.1f);
    const OverlayLine head = cores(whole)[1];
    REQUIRE(head.points.size() == 3);
    CHECK(glm::distance(head.points[1], scene.pixel(front.back())) < 0.5f);
    CHECK(head.points[0].x < head.points[1].x - 4);
    // Wider and darker below.
    CHECK(whole[0].width > line.width + 1);
    CHECK(whole[0].colour.r < 0.2f);

    const OverlayLines half = strokeLines(scene.view(), other);
    REQUIRE(half.size() == 2);  // its end is hidden: no head
    const float horizon = orthographic ? kPi / 2 : std::acos(1 / 5.f);
    const vec2 last = scene.pixel({std::sin(horizon), 0, std::cos(horizon)});
    CHECK(glm::distance(cores(half)[0].points.back(), last) < 3);
  }
}

TEST_CASE("a stroke behind the surface, outside the picture or behind the eye is not drawn") {
  const Scene scene;
  const std::vector<vec3> hidden{{-0.2f, 0, -1}, {0.2f, 0, -1}}, outside{{9, 9, 0}, {9, 8, 0}},
      behind{{0, 0, 6}, {0.1f, 0, 7}}, single{{0, 0, 1}}, none;
  for (const auto& points : {hidden, outside, behind, single, none}) {
    const SurfaceStroke stroke[] = {{points}};
    CHECK(strokeLines(scene.view(), stroke).empty());
  }
  // From before the eye to behind it: what lies before it, up to the near plane.
  const std::vector<vec3> through{{0.1f, 0, 2}, {0.1f, 0, 30}};
  const SurfaceStroke stroke[] = {{through}};
  for (const OverlayLine& line : strokeLines(scene.view(), stroke))
    for (const vec2& p : line.points) CHECK((std::isfinite(p.x) && std::abs(p.x) < 1e4f));
}

TEST_CASE("directions are short arrows along them, one a cell, the same each time") {
  const Scene scene;
  std::vector<vec3> up(scene.positions.size());
  for (std::size_t i = 0; i < up.size(); ++i) {
    const vec3 n = scene.normals[i];
    up[i] = 5.f * (vec3(0, 1, 0) - n.y * n);  // any length
  }
  for (const float scale : {1.f, 2.f}) {
    const OverlayLines lines = directionLines(scene.view(scale), scene.positions, up, 14);
    const auto arrows = cores(lines);
    const float cell = 14 * scale, cells = std::ceil(kWidth / cell) * std::ceil(kHeight / cell);
    REQUIRE(arrows.size() % 2 == 0);
    CHECK(arrows.size() / 2 > 0.8f * cells);
    CHECK(arrows.size() / 2 <= cells);
    std::vector<bool> taken(2000);
    for (std::size_t k = 0; k < arrows.size(); k += 2) {
      const vec2 from = arrows[k].points[0], to = arrows[k].points[1], middle = 0.5f * (from + to);
      CHECK(glm::distance(from, to) < 0.85f * cell);
      CHECK(to.y < from.y + 0.01f);  // up
      CHECK(arrows[k + 1].points[1] == to);
      const auto at = static_cast<std::size_t>(std::floor(middle.y / cell + 1e-3f) * 40 +
                                               std::floor(middle.x / cell + 1e-3f));
      taken[at] = true;
    }
    CHECK(std::count(taken.begin(), taken.end(), true) > 0.95 * arrows.size() / 2);
    const OverlayLines again = directionLines(scene.view(scale), scene.positions, up, 14);
    REQUIRE(again.size() == lines.size());
    for (std::size_t k = 0; k < lines.size(); ++k) CHECK(again[k].points == lines[k].points);
  }
  // Without a direction, or with one towards the eye, there is none.
  CHECK(directionLines(scene.view(), scene.positions,
                       std::vector<vec3>(scene.positions.size(), vec3(0)), 14)
            .empty());
  std::vector<vec3> eyewards = scene.positions;
  for (vec3& v : eyewards) v = scene.camera.eye - v;
  CHECK(directionLines(scene.view(), scene.positions, eyewards, 14).empty());
}

TEST_CASE("the border of two halves of a sphere is its equator, smooth, and nothing else") {
  const Scene scene;
  std::vector<Index> region(scene.positions.size());
  for (std::size_t i = 0; i < region.size(); ++i)
    region[i] = scene.positions[i].z < -1.5f ? 7 : scene.positions[i].y > 0 ? 0 : kNone;
  const OverlayLines lines = outlineLines(scene.view(), region);
  // Between the halves, and where each lies before the wall.
  const auto borders = cores(lines);
  REQUIRE(borders.size() == 3);
  for (float x = -0.9f; x < 0.95f; x += 0.05f)
    CHECK(distanceTo(scene.pixel({x, 0, std::sqrt(1 - x * x)}), borders) < 2);
  const float horizon = std::acos(1 / 5.f);
  for (int k = 0; k < 64; ++k) {
    const float angle = 2 * kPi * static_cast<float>(k) / 64;
    CHECK(distanceTo(scene.pixel({std::sin(horizon) * std::cos(angle),
                                  std::sin(horizon) * std::sin(angle), std::cos(horizon)}),
                     borders) < 2.5f);
  }
  // No stair of a pixel's corners is left: neighbouring pieces turn little.
  for (const OverlayLine& line : borders)
    for (std::size_t i = 2; i < line.points.size(); ++i) {
      const vec2 a = line.points[i - 1] - line.points[i - 2],
                 b = line.points[i] - line.points[i - 1];
      if (glm::length(a) > 0.5f && glm::length(b) > 0.5f)
        CHECK(glm::dot(glm::normalize(a), glm::normalize(b)) > 0.6f);
    }
  CHECK(outlineLines(scene.view(), std::vector<Index>(region.size(), 3)).empty());
}

TEST_CASE("a region in the middle of another has one closed border, and single points none") {
  const Scene scene;
  std::vector<Index> region(scene.positions.size(), 0);
  for (std::size_t i = 0; i < region.size(); ++i)
    if (glm::distance(scene.positions[i], {0, 0, 1}) < 0.4f) region[i] = 1;
  const OverlayLines lines = outlineLines(scene.view(), region);
  REQUIRE(lines.size() == 2);
  CHECK(lines[1].closed);
  // A chord of 0.4: sin of its angle is 0.4 cos(asin(0.2)).
  const float z = 1 - 0.08f, radius = std::sqrt(1 - z * z);
  const float pixels = glm::distance(scene.pixel({radius, 0, z}), vec2(160, 120));
  for (const vec2& p : lines[1].points)
    CHECK(glm::distance(p, vec2(160, 120)) == doctest::Approx(pixels).epsilon(0.06));

  std::vector<Index> specks(scene.positions.size(), 0);
  for (std::size_t i = 0; i < specks.size(); i += 997) specks[i] = 1;
  CHECK(outlineLines(scene.view(), specks).empty());
}

TEST_CASE("where three regions meet three borders meet") {
  const Scene scene;
  std::vector<Index> region(scene.positions.size());
  for (std::size_t i = 0; i < region.size(); ++i) {
    const vec3 p = scene.positions[i];
    const float turn = std::atan2(p.y, p.x) / (2 * kPi) + 0.5f;
    region[i] = p.z < -1.5f ? 9 : static_cast<Index>(std::min(2.f, std::floor(3 * turn)));
  }
  const OverlayLines lines = outlineLines(scene.view(), region);
  int meeting = 0;
  for (const OverlayLine& line : cores(lines))
    for (const vec2& end : {line.points.front(), line.points.back()})
      meeting += glm::distance(end, vec2(160, 120)) < 4;
  CHECK(meeting >= 3);
}

TEST_CASE("the brush is a circle on the surface, foreshortened, hidden parts dashed and faint") {
  const Scene scene;
  const OverlayLines facing = brushLines(scene.view(), {{0, 0, 1}, {0, 0, 1}, 0.3f});
  const float radius = glm::distance(scene.pixel({0.3f, 0, 1}), vec2(160, 120));
  for (const OverlayLine& line : facing)
    for (const vec2& p : line.points)
      CHECK(glm::distance(p, vec2(160, 120)) == doctest::Approx(radius).epsilon(1e-3));
  for (int k = 0; k < 64; ++k) {
    const float angle = 2 * kPi * static_cast<float>(k) / 64;
    CHECK(distanceTo(vec2(160, 120) + radius * vec2(std::cos(angle), std::sin(angle)),
                     cores(facing)) < 0.5f);
  }
  // Half of a circle that stands across the surface lies inside the sphere.
  const BrushCursor across{.centre = {0, 1, 0}, .normal = {0, 0, 1}, .radius = 0.5f};
  float bright = 0, faint = 0;
  for (const OverlayLine& line : cores(brushLines(scene.view(), across)))
    for (std::size_t i = 1; i < line.points.size(); ++i)
      (line.colour.a > 0.9f ? bright : faint) += glm::distance(line.points[i - 1], line.points[i]);
  CHECK(bright > 50);
  CHECK(faint > 15);
  CHECK(faint < 0.7f * bright);

  BrushCursor through = across;
  through.through = true;
  const OverlayLines whole = brushLines(scene.view(), through);
  REQUIRE(whole.size() == 2);
  CHECK(whole[1].closed);
  through.core = 0.5f;
  CHECK(brushLines(scene.view(), through).size() == 4);
  CHECK(brushLines(scene.view(), {{0, 0, 9}, {0, 0, 1}, 0.3f}).empty());
  CHECK(brushLines(scene.view(), {{0, 0, 1}, {0, 0, 1}, 0}).empty());
}

TEST_CASE("a drawn line covers its width, softly, and blends once where it turns") {
  Image picture{40, 30, 4, std::vector<float>(std::size_t{40} * 30 * 4, 0.f)};
  const OverlayLine line{{{5, 10}, {20, 10}, {20, 25}}, {1, 0.5f, 0.25f, 0.5f}, 3};
  drawLines(std::span(&line, 1), picture);
  // The line's own colour, half opaque, at its middle and where its pieces meet.
  for (const ivec2& p : {ivec2(10, 9), ivec2(19, 10), ivec2(20, 15)}) {
    CHECK(picture.at(p.x, p.y, 0) == doctest::Approx(0.5));
    CHECK(picture.at(p.x, p.y, 1) == doctest::Approx(0.25));
    CHECK(picture.at(p.x, p.y, 3) == 0);
  }
  // Across it the covered parts add up to its width.
  float sum = 0;
  for (int y = 0; y < 30; ++y) sum += picture.at(10, y, 0) / 0.5f;
  CHECK(sum == doctest::Approx(3).epsilon(0.01));
  CHECK(picture.at(10, 13, 0) == 0);
  CHECK(picture.at(30, 10, 0) == 0);

  Image closed{40, 30, 3, std::vector<float>(std::size_t{40} * 30 * 3, 0.f)};
  const OverlayLine triangle{{{5, 5}, {30, 5}, {5, 25}}, glm::vec4(1), 2, true};
  drawLines(std::span(&triangle, 1), closed);
  CHECK(closed.at(5, 15, 0) > 0.4f);  // the side that closes it
  CHECK(closed.at(11, 10, 0) == 0);
  const OverlayLine outside{{{-1e6f, -50}, {1e6f, -50}}, glm::vec4(1), 2},
      across{{{-1e5f, 2}, {1e5f, 2}}, glm::vec4(1), 2};
  drawLines(std::span(&outside, 1), closed);
  drawLines(std::span(&across, 1), closed);
  CHECK(closed.at(39, 2, 0) > 0.4f);
}

TEST_CASE("a singularity is marked where it is seen, by its sign and by how often it turns") {
  const Scene scene;
  const vec3 front{0, 0, 1}, side{0.6f, 0, 0.8f};
  const SingularMark marks[] = {{front, 1}, {side, -2}, {{0, 0, -1}, 1}, {{9, 9, 0}, 1}};
  const OverlayLines lines = singularityLines(scene.view(), marks);
  // Two grounds; then a ring and a plus, two diamonds and a minus, each with its casing.
  REQUIRE(lines.size() == 2 + 2 * (3 + 3));
  const OverlayLines cores(lines.end() - 6, lines.end());
  CHECK(cores[0].closed);
  CHECK(cores[0].points.size() > 12);
  for (const vec2& p : cores[0].points)
    CHECK(glm::distance(p, scene.pixel(front)) == doctest::Approx(kMarkRadius).epsilon(0.01));
  CHECK(cores[1].points[0].y == cores[1].points[1].y);
  CHECK(cores[2].points[0].x == cores[2].points[1].x);
  for (const std::size_t k : {3u, 4u}) {
    CHECK(cores[k].closed);
    REQUIRE(cores[k].points.size() == 4);
    CHECK(glm::distance(0.5f * (cores[k].points[0] + cores[k].points[2]), scene.pixel(side)) <
          0.1f);
  }
  CHECK(glm::distance(cores[4].points[0], cores[4].points[2]) >
        glm::distance(cores[3].points[0], cores[3].points[2]) + 4);
  CHECK(cores[5].points.size() == 2);
  CHECK(cores[0].colour != cores[3].colour);

  // Of twice the size at twice the scale.
  const OverlayLines large = singularityLines(scene.view(2), {marks, 1});
  CHECK(glm::distance(large.back().points[0], large.back().points[1]) ==
        doctest::Approx(2 * glm::distance(cores[1].points[0], cores[1].points[1])));
  CHECK(singularityLines(scene.view(), {}).empty());

  REQUIRE(placeOf(scene.view(), side));
  CHECK(glm::distance(*placeOf(scene.view(), side), scene.pixel(side)) < 0.01f);
  CHECK_FALSE(placeOf(scene.view(), {0, 0, -1}));
  CHECK_FALSE(placeOf(scene.view(), {0, 0, 6}));
}
