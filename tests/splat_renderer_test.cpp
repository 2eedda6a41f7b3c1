#include "app/render/splat_renderer.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <utility>

#include "app/render/cpu_splatter.h"
#include "app/render/gl_objects.h"
#include "app/render/image_compare.h"
#include "app/render/offscreen.h"
#include "base/errors.h"
#include "base/hash_rng.h"

using namespace dapple;

namespace {

constexpr vec3 kBackground{1, 0, 1};

struct Scene {
  std::vector<vec3> positions, normals, colours;
  std::vector<float> radii;
  std::vector<Index> order;  // empty: as they are

  SplatColumns columns(const SplatTexture* texture) const {
    return {positions, normals, colours, radii, texture, order.empty() ? nullptr : &order};
  }
  void add(const vec3& position, const vec3& normal, const vec3& colour, float spacing) {
    positions.push_back(position);
    normals.push_back(normal);
    colours.push_back(colour);
    radii.push_back(splatRadius(spacing));
  }
};

// n points evenly over the unit sphere (Fibonacci lattice), coloured by colour(position).
template <typename Colour>
Scene sphere(int n, const Colour& colour) {
  Scene scene;
  const float spacing = std::sqrt(4 * std::numbers::pi_v<float> / static_cast<float>(n));
  for (int i = 0; i < n; ++i) {
    const double y = 1 - (2.0 * i + 1) / n, r = std::sqrt(1 - y * y);
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const vec3 p(r * std::cos(angle), y, r * std::sin(angle));
    scene.add(p, p, colour(p), spacing);
  }
  return scene;
}

// A square grid over the side of the cube [-1, 1]^3 where `normal` points, with axes s and t.
template <typename Colour>
void addSide(Scene& scene, const std::array<vec3, 3>& stn, int n, const Colour& colour) {
  const float spacing = 2.0f / static_cast<float>(n);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const vec2 uv((x + 0.5f) * spacing - 1, (y + 0.5f) * spacing - 1);
      scene.add(uv.x * stn[0] + uv.y * stn[1] + stn[2], stn[2], colour(uv), spacing);
    }
}
constexpr std::array<vec3, 3> kFront{vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)};

struct Studio {
  OffscreenContext context;
  SplatRenderer renderer;
};

// One for all tests: shaders take long to compile.
Studio& studioOfAll() {
  static Studio studio;
  return studio;
}

// Every picture must leave OpenGL without a word.
Image picture(const Scene& scene, const Camera& camera, int width, int height,
              SplatOptions options = {.background = kBackground},
              const SplatTexture* texture = nullptr) {
  Studio& studio = studioOfAll();
  studio.renderer.update(scene.columns(texture));
  Image image = studio.renderer.draw(camera, width, height, options);
  for (const std::string& message : takeGlMessages()) FAIL_CHECK(message);
  return image;
}

// Half a step in three channels.
constexpr float kHalfStep = 0.51f / 255 * 1.75f;

struct ByGl {
  static constexpr float kTolerance = kHalfStep;
  static Image picture(const Scene& scene, const Camera& camera, int width, int height,
                       const SplatOptions& options = {.background = kBackground},
                       const SplatTexture* texture = nullptr) {
    return ::picture(scene, camera, width, height, options, texture);
  }
};

struct ByCpu {
  static constexpr float kTolerance = kHalfStep;
  static Image picture(const Scene& scene, const Camera& camera, int width, int height,
                       const SplatOptions& options = {.background = kBackground},
                       const SplatTexture* texture = nullptr) {
    static Workers workers(2);
    static CpuSplatter splatter(workers);
    splatter.update(scene.columns(texture));
    Raster raster;
    splatter.draw(camera, width, height, options, raster);
    return toImage(raster);
  }
};

vec3 at(const Image& image, int x, int y) {
  return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

bool covered(const Image& image, int x, int y) {
  return glm::distance(at(image, x, y), kBackground) > 1e-3f;
}

// Of the unit sphere's outline, pixels.
float outlineRadius(const Camera& camera, int height) {
  const float d = glm::length(camera.eye);
  const float focal = 0.5f * static_cast<float>(height) / std::tan(0.5f * camera.verticalFov);
  return focal / std::sqrt(d * d - 1);
}

Camera sphereCamera() {
  return standardView("front", Bounds{{-1, -1, -1}, {1, 1, 1}}, 1);
}

vec3 noisy(const vec3& p) {
  const auto bits = [](float v) {
    return static_cast<std::uint64_t>(std::lround(v * 1e4f) + 20000);
  };
  const std::uint64_t id = bits(p.x) * 40000 + bits(p.y);
  return {hashUniform(1, id), hashUniform(2, id), hashUniform(3, id)};
}

std::uint64_t hashOf(const Image& image) {
  std::uint64_t h = 0;
  for (float v : image.pixels) h = hashBits(h, std::bit_cast<std::uint32_t>(v));
  return h;
}

Image threadsPicture() {
  return picture(sphere(20000, noisy), sphereCamera(), 320, 240);
}

}  // namespace

TEST_CASE_TEMPLATE("a uniform colour comes out as it went in", Drawn, ByGl, ByCpu) {
  for (vec3 c : {vec3(1), vec3(0.2f, 0.5f, 0.7f), vec3(0), vec3(1 / 255.f, 254 / 255.f, 0.999f)}) {
    const Image image = Drawn::picture(sphere(5000, [&](vec3) { return c; }), sphereCamera(), 200,
                                       200, {.background = c});
    float worst = 0;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x) {
        const vec3 d = glm::abs(at(image, x, y) - c);
        worst = std::max({worst, d.r, d.g, d.b});
        REQUIRE(image.at(x, y, 3) == 1.0f);
      }
    CHECK(worst < Drawn::kTolerance);
  }
}

TEST_CASE_TEMPLATE("a sphere has no hole from a fifth of a pixel to 20 pixels a splat", Drawn, ByGl,
                   ByCpu) {
  constexpr int kPoints = 5000;
  const float spacing = std::sqrt(4 * std::numbers::pi_v<float> / kPoints);
  // Behind its horizon the sphere is red: a hole shows it.
  const Scene scene = sphere(kPoints, [](vec3 p) { return p.z > -0.1f ? vec3(1) : vec3(1, 0, 0); });
  const Camera camera = sphereCamera();
  for (float perSplat : {0.2f, 0.3f, 0.5f, 0.8f, 1.3f, 2.0f, 3.7f, 7.0f, 12.0f, 20.0f}) {
    CAPTURE(perSplat);
    const int side = static_cast<int>(perSplat / spacing * 200 / outlineRadius(camera, 200));
    const float radius = outlineRadius(camera, side);
    const Image image = Drawn::picture(scene, camera, side, side);
    int background = 0, back = 0;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const float r = std::hypot(x + 0.5f - 0.5f * side, y + 0.5f - 0.5f * side);
        background += r < 0.99f * radius - 1 && !covered(image, x, y);
        back += r < 0.97f * radius - 1 && at(image, x, y).g < 0.999f;
      }
    CHECK(background == 0);
    CHECK(back == 0);
  }
}

TEST_CASE_TEMPLATE("the outline of a sphere has the area that geometry gives it", Drawn, ByGl,
                   ByCpu) {
  constexpr int kSide = 600;
  const Camera camera = sphereCamera();
  const float r = outlineRadius(camera, kSide);
  for (int n : {3000, 40000}) {
    const Image image =
        Drawn::picture(sphere(n, [](vec3) { return vec3(1); }), camera, kSide, kSide);
    double area = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) area += covered(image, x, y);
    CHECK(area / (std::numbers::pi * r * r) == doctest::Approx(1).epsilon(0.02));
  }
}

TEST_CASE_TEMPLATE("the front view of a cube shows its +z face, x to the right and y up", Drawn,
                   ByGl, ByCpu) {
  Scene cube;
  const auto side = [&](vec3 s, vec3 t, vec3 n, vec3 colour) {
    addSide(cube, {s, t, n}, 40, [&](vec2) { return colour; });
  };
  addSide(cube, kFront, 40, [](vec2 uv) { return vec3(uv.x > 0, uv.y > 0, 0.25f); });
  side({-1, 0, 0}, {0, 1, 0}, {0, 0, -1}, vec3(0.9f));
  side({0, 0, -1}, {0, 1, 0}, {1, 0, 0}, vec3(0.6f));
  side({0, 0, 1}, {0, 1, 0}, {-1, 0, 0}, vec3(0.5f));
  side({1, 0, 0}, {0, 0, -1}, {0, 1, 0}, vec3(0.4f));
  side({1, 0, 0}, {0, 0, 1}, {0, -1, 0}, vec3(0.3f));
  const Image front = Drawn::picture(cube, standardView("front", cube.positions, 1), 200, 200);
  CHECK(glm::distance(at(front, 50, 50), vec3(0, 1, 0.25f)) < 1e-3f);  // left, above
  CHECK(glm::distance(at(front, 150, 50), vec3(1, 1, 0.25f)) < 1e-3f);
  CHECK(glm::distance(at(front, 50, 150), vec3(0, 0, 0.25f)) < 1e-3f);
  CHECK(glm::distance(at(front, 150, 150), vec3(1, 0, 0.25f)) < 1e-3f);

  const auto middle = [&](const char* view) {
    return at(Drawn::picture(cube, standardView(view, cube.positions, 1), 100, 100), 50, 50).r;
  };
  CHECK(middle("back") == doctest::Approx(0.9).epsilon(Drawn::kTolerance));
  CHECK(middle("right") == doctest::Approx(0.6).epsilon(Drawn::kTolerance));
  CHECK(middle("left") == doctest::Approx(0.5).epsilon(Drawn::kTolerance));
  CHECK(middle("top") == doctest::Approx(0.4).epsilon(Drawn::kTolerance));
}

TEST_CASE_TEMPLATE("stripes four spacings wide keep 80 % of their contrast and a sharp edge", Drawn,
                   ByGl, ByCpu) {
  constexpr int kPoints = 96;
  Scene plane;
  addSide(plane, kFront, kPoints, [](vec2 uv) {
    return vec3(static_cast<int>(std::floor((uv.x + 1) / 2 * kPoints / 4)) % 2);
  });
  for (int perSpacing : {1, 2, 8}) {
    CAPTURE(perSpacing);
    // Head-on, with exactly perSpacing pixels between points.
    const int side = kPoints * perSpacing;
    Camera camera{.eye = {0, 0, 1 + 1 / std::tan(0.3f)}, .target = {0, 0, 0}};
    camera.nearPlane = 1;
    const Image image = Drawn::picture(plane, camera, side, side);
    const int stripe = 4 * perSpacing;
    double white = 0, black = 0, edges = 0;
    for (int k = 0; k < kPoints / 4; ++k) {
      const int x = k * stripe + stripe / 2;
      const double middle = 0.5 * (at(image, x, side / 2).r + at(image, x - 1, side / 2).r);
      (k % 2 != 0 ? white : black) += middle / (kPoints / 8);
    }
    for (int x = 1; x + 1 < side; ++x) {
      const float v = at(image, x, side / 2).r;
      edges += v > 0.1f && v < 0.9f;
    }
    CHECK(white - black > 0.95);
    // From 10 % to 90 % in less than 1.5 spacings, or 2 pixels.
    CHECK(edges / (kPoints / 4 - 1) < std::max(1.5 * perSpacing, 2.01));
  }
}

TEST_CASE_TEMPLATE("the side of a disc that its normal points to makes no difference", Drawn, ByGl,
                   ByCpu) {
  Scene scene = sphere(5000, noisy);
  const Image outward = Drawn::picture(scene, sphereCamera(), 200, 200);
  for (vec3& n : scene.normals) n = -n;
  CHECK(Drawn::picture(scene, sphereCamera(), 200, 200).pixels == outward.pixels);
}

TEST_CASE_TEMPLATE("a splat that is not seen changes nothing", Drawn, ByGl, ByCpu) {
  Scene scene = sphere(5000, noisy);
  const Image alone = Drawn::picture(scene, sphereCamera(), 200, 200);
  scene.add({0, 0, 50}, {0, 0, 1}, vec3(0), 10);  // behind the eye
  CHECK(Drawn::picture(scene, sphereCamera(), 200, 200).pixels == alone.pixels);
}

TEST_CASE("squares, sprites and flat sprites make the same picture") {
  // The same ball larger and larger in the picture: the processor knows one kind of splat only.
  const Scene scene = sphere(600, noisy);
  for (const int side : {20, 60, 150, 300, 500, 900}) {
    CAPTURE(side);
    CHECK(structuralSimilarity(picture(scene, sphereCamera(), side, side),
                               ByCpu::picture(scene, sphereCamera(), side, side)) > 0.98);
  }
}

TEST_CASE_TEMPLATE("a splat larger than the picture with its centre outside covers the picture",
                   Drawn, ByGl, ByCpu) {
  Scene scene;
  scene.add({3, 0, 0}, {0, 0, 1}, {0.25f, 0.5f, 0.75f}, 5);
  const Camera camera{.eye = {0, 0, 1}, .target = {0, 0, 0}};
  const Image image = Drawn::picture(scene, camera, 640, 480);
  for (int y = 0; y < 480; y += 7)
    for (int x = 0; x < 640; x += 7)
      REQUIRE(glm::distance(at(image, x, y), scene.colours[0]) < Drawn::kTolerance);
}

TEST_CASE_TEMPLATE("nothing behind the eye is drawn", Drawn, ByGl, ByCpu) {
  Scene scene;
  scene.add({0, 0, 3}, {0, 0, 1}, vec3(0), 1);
  const Image image = Drawn::picture(scene, {.eye = {0, 0, 1}, .target = {0, 0, 0}}, 64, 64);
  for (int i = 0; i < 64 * 64; ++i) REQUIRE(!covered(image, i % 64, i / 64));
}

TEST_CASE("a disc is an ellipse of the right size and perspective") {
  Scene scene;
  const float radius = 0.5f;
  const vec3 normal = glm::normalize(vec3(0, std::sqrt(3.f), 1));  // 60 degrees back
  scene.add({0, 0, 0}, normal, vec3(0), radius / splatRadius(1));
  const Camera camera{.eye = {0, 0, 2}, .target = {0, 0, 0}};
  constexpr int kSide = 400;
  const Image image =
      picture(scene, camera, kSide, kSide, {.background = kBackground, .lowPass = 0.5f});
  int left = kSide, right = 0, top = kSide, bottom = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      if (covered(image, x, y)) {
        left = std::min(left, x), right = std::max(right, x + 1);
        top = std::min(top, y), bottom = std::max(bottom, y + 1);
      }
  const float focal = 0.5f * kSide / std::tan(0.3f);
  // The far rim is (0, 1/2, -sqrt(3)/2) r from the centre, the near one opposite.
  const float along = radius / 2, deep = radius * std::sqrt(0.75f);
  CHECK(200 - top == doctest::Approx(focal * along / (2 + deep)).epsilon(0.02));
  CHECK(bottom - 200 == doctest::Approx(focal * along / (2 - deep)).epsilon(0.02));
  CHECK(right - left == doctest::Approx(focal * radius).epsilon(0.04));
}

TEST_CASE("without OpenGL a disc is the ellipse that its centre's perspective gives") {
  Scene scene;
  const float radius = 0.5f;
  const vec3 normal = glm::normalize(vec3(0, std::sqrt(3.f), 1));  // 60 degrees back
  scene.add({0, 0, 0}, normal, vec3(0), radius / splatRadius(1));
  constexpr int kSide = 400;
  const Image image = ByCpu::picture(scene, {.eye = {0, 0, 2}, .target = {0, 0, 0}}, kSide, kSide,
                                     {.background = kBackground, .lowPass = 0.5f});
  double area = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) area += covered(image, x, y);
  const double focal = 0.5 * kSide / std::tan(0.3), along = focal * radius / 2;
  CHECK(area == doctest::Approx(std::numbers::pi * along * along / 2).epsilon(0.01));
}

TEST_CASE_TEMPLATE("without perspective a sphere is a circle of the right size, near or far", Drawn,
                   ByGl, ByCpu) {
  Scene scene = sphere(20000, [](vec3 p) { return vec3(p.x > 0, p.y > 0, 0.5f); });
  const Camera camera = orthographicView(sphereCamera(), scene.positions, 1);
  CHECK(camera.orthographicHeight == doctest::Approx(2 / 0.92).epsilon(0.01));
  const Image image = Drawn::picture(scene, camera, 600, 600);
  int area = 0;
  for (int y = 0; y < 600; ++y)
    for (int x = 0; x < 600; ++x) area += covered(image, x, y);
  const double radius = 300 * 0.92;
  CHECK(area == doctest::Approx(std::numbers::pi * radius * radius).epsilon(0.02));
  CHECK(glm::distance(at(image, 450, 150), vec3(1, 1, 0.5f)) < 0.01f);
  CHECK(glm::distance(at(image, 150, 450), vec3(0, 0, 0.5f)) < 0.01f);
  Camera farther = camera;
  farther.eye = camera.target + 1.4f * (camera.eye - camera.target);
  CHECK(structuralSimilarity(Drawn::picture(scene, farther, 600, 600), image) > 0.999);
}

TEST_CASE("OpenGL and the processor draw the same picture") {
  for (const int points : {2000, 20000, 200000}) {
    CAPTURE(points);
    const Scene scene =
        sphere(points, [](vec3 p) { return vec3(0.5f) + 0.5f * glm::sin(vec3(20, 25, 30) * p); });
    for (const Shading shading : {Shading::Off, Shading::Headlight}) {
      const SplatOptions options{.shading = shading, .background = vec3(1)};
      for (const Camera& camera :
           {sphereCamera(), orthographicView(sphereCamera(), scene.positions, 4.f / 3)})
        CHECK(structuralSimilarity(picture(scene, camera, 400, 300, options),
                                   ByCpu::picture(scene, camera, 400, 300, options)) > 0.98);
    }
  }
}

TEST_CASE("the processor draws the same bytes with 1, 2 and 3 threads, and knows what it drew") {
  const Scene scene = sphere(20000, noisy);
  const Camera camera = sphereCamera();
  std::array<Raster, 3> rasters;
  for (unsigned t = 0; t < 3; ++t) {
    Workers workers(t + 1);
    CpuSplatter splatter(workers);
    rasters[t].trace = true;
    splatter.update({scene.positions, scene.normals, scene.colours, scene.radii});
    splatter.draw(camera, 320, 240, {.background = kBackground}, rasters[t]);
    CHECK(rasters[t].pixels == rasters[0].pixels);
    CHECK(rasters[t].points == rasters[0].points);
    CHECK(rasters[t].depths == rasters[0].depths);
  }
  const glm::mat4 view = viewMatrix(camera);
  const float focal = 120 / std::tan(0.5f * camera.verticalFov);
  int seen = 0;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * 320 + x;
      const Index point = rasters[0].points[pixel];
      CHECK((point == kNone) == std::isinf(rasters[0].depths[pixel]));
      if (point == kNone) continue;
      ++seen;
      const vec3 p = view * glm::vec4(scene.positions[point], 1);
      const vec2 drawn(160 + focal * p.x / -p.z, 120 - focal * p.y / -p.z);
      // Not farther than a splat reaches, and on the front of the sphere.
      REQUIRE(glm::distance(drawn, vec2(x + 0.5f, y + 0.5f)) <
              std::max(1.1f, 1.1f * focal * scene.radii[point] / -p.z));
      REQUIRE(rasters[0].depths[pixel] < glm::length(camera.eye));
    }
  CHECK(seen > 20000);
}

TEST_CASE_TEMPLATE("a surface hides the one behind it", Drawn, ByGl, ByCpu) {
  Scene scene;
  addSide(scene, kFront, 60, [](vec2) { return vec3(0, 1, 0); });
  for (vec3& p : scene.positions) p.z = 0.2f;  // 6 spacings before the next one
  addSide(scene, kFront, 60, [](vec2) { return vec3(1, 0, 0); });
  for (std::size_t i = 3600; i < 7200; ++i) scene.positions[i].z = 0;
  for (vec3 eye : {vec3(0, 0, 4), vec3(2.5f, 0, 3)}) {
    const Image image =
        Drawn::picture(scene, lookAt(eye, {0, 0, 0.2f}, boundsOf(scene.positions)), 200, 200);
    for (int y = 85; y < 115; ++y)
      for (int x = 85; x < 115; ++x) REQUIRE(at(image, x, y).g > 0.999f);
  }
}

TEST_CASE_TEMPLATE("splats of one rough surface blend, whichever lies a little higher", Drawn, ByGl,
                   ByCpu) {
  for (float higher : {-0.2f, 0.0f, 0.2f}) {  // radii
    Scene scene;
    const float spacing = 0.4f, radius = splatRadius(spacing);
    scene.add({-0.2f, 0, 0}, {0, 0, 1}, vec3(0), spacing);
    scene.add({0.2f, 0, higher * radius}, {0, 0, 1}, vec3(1), spacing);
    const Image image = Drawn::picture(scene, {.eye = {0, 0, 10}, .target = {0, 0, 0}}, 201, 201);
    CHECK(at(image, 100, 100).r == doctest::Approx(0.5).epsilon(0.1));
  }
}

TEST_CASE_TEMPLATE("hidden edge-on splats do not come through the surface before them", Drawn, ByGl,
                   ByCpu) {
  Scene scene;
  addSide(scene, kFront, 60, [](vec2) { return vec3(1); });
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const float angle = 6.28f * hashUniform(1, i), tilt = 0.1f * hashUniform(2, i) - 0.05f;
    const vec3 p(1.6f * hashUniform(3, i) - 0.8f, 1.6f * hashUniform(4, i) - 0.8f, 0.6f);
    scene.add(p, glm::normalize(vec3(std::cos(angle), std::sin(angle), tilt)), vec3(0), 1e-3f);
  }
  const Image image =
      Drawn::picture(scene, {.eye = {0, 0, 6}, .target = {0, 0, 0}}, 200, 200, {.lowPass = 1.4f});
  int dark = 0;
  for (int y = 60; y < 140; ++y)
    for (int x = 60; x < 140; ++x) dark += at(image, x, y).r < 0.999f;
  CHECK(dark == 0);
}

TEST_CASE_TEMPLATE("a splat far smaller than a pixel is seen wherever it falls, edge-on too", Drawn,
                   ByGl, ByCpu) {
  for (std::uint64_t i = 0; i < 20; ++i) {
    Scene scene;
    scene.add({0.5f * hashUniform(1, i), 0.5f * hashUniform(2, i), 0}, {1, 0, 0}, vec3(0), 1e-4f);
    const Image image = Drawn::picture(scene, sphereCamera(), 64, 64);
    int pixels = 0;
    for (int k = 0; k < 64 * 64; ++k) pixels += covered(image, k % 64, k / 64);
    CHECK(pixels >= 1);
    CHECK(pixels <= 5);
  }
}

TEST_CASE_TEMPLATE("many points in a pixel are averaged", Drawn, ByGl, ByCpu) {
  Scene plane;
  addSide(plane, kFront, 400, [](vec2 uv) { return vec3(noisy({uv, 0}).r > 0.5f); });
  // A third of a pixel between points.
  const Camera camera{.eye = {0, 0, 1 + 1 / std::tan(0.3f)}, .target = {0, 0, 0}};
  const Image image = Drawn::picture(plane, camera, 133, 133);
  double sum = 0, squares = 0;
  for (int y = 20; y < 113; ++y)
    for (int x = 20; x < 113; ++x) {
      const double v = at(image, x, y).r;
      sum += v / (93 * 93);
      squares += v * v / (93 * 93);
    }
  CHECK(sum == doctest::Approx(0.5).epsilon(0.02));
  // 0.5 for one point; a third of it for the nine that a pixel owns.
  CHECK(std::sqrt(squares - sum * sum) < 0.2);
}

TEST_CASE_TEMPLATE("a plane seen at a grazing angle keeps its mean colour and has no crack", Drawn,
                   ByGl, ByCpu) {
  Scene plane;
  addSide(plane, {vec3(1, 0, 0), vec3(0, 0, -1), vec3(0, 1, 0)}, 200, [](vec2 uv) {
    return vec3(static_cast<int>(std::floor((uv.x + 1) * 100)) % 2);  // single columns of points
  });
  for (float height : {0.1f, 0.3f, 1.0f}) {
    const Camera camera = lookAt({0, 1 + height, 3}, {0, 1, 0}, boundsOf(plane.positions));
    const Image image = Drawn::picture(plane, camera, 300, 300, {.background = vec3(0.5f)});
    double sum = 0;
    for (int y = 145; y < 155; ++y)
      for (int x = 100; x < 200; ++x) sum += at(image, x, y).r / 1000;
    CHECK(sum == doctest::Approx(0.5).epsilon(0.1));
  }
}

TEST_CASE_TEMPLATE("a picture of several tiles has no seam", Drawn, ByGl, ByCpu) {
  const Scene scene = sphere(3000, noisy);
  Camera camera = sphereCamera();
  camera.verticalFov = 0.06f;  // the sphere fills all of a low, wide picture
  const Image one = Drawn::picture(scene, camera, 2048, 40),
              two = Drawn::picture(scene, camera, 2448, 40);
  int different = 0;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 2048; ++x) different += at(one, x, y) != at(two, x + 200, y);
  CHECK(different == 0);
}

TEST_CASE("tiles of a large picture are parts of it") {
  Scene scene = sphere(3000, noisy);
  Scene few = sphere(100, noisy);  // squares in object space
  for (const Scene* drawn : {&scene, &few}) {
    const Image whole = picture(*drawn, sphereCamera(), 2100, 2100);
    Camera part = sphereCamera();  // what lies in the middle 1050 x 1050
    part.verticalFov = 2 * std::atan(0.5f * std::tan(0.5f * part.verticalFov));
    const Image middle = picture(*drawn, part, 1050, 1050);
    double most = 0;
    int different = 0;
    for (int y = 0; y < 1050; ++y)
      for (int x = 0; x < 1050; ++x) {
        const float d = glm::distance(at(middle, x, y), at(whole, x + 525, y + 525));
        most = std::max<double>(most, d);
        different += d > kHalfStep * 2;
      }
    CAPTURE(most);
    CHECK(different == 0);
  }
}

TEST_CASE_TEMPLATE("a picture of 4096 x 4096 is drawn whole", Drawn, ByGl, ByCpu) {
  Scene scene;
  for (int i = 0; i < 4; ++i)
    scene.add({i % 2 - 0.5f, i / 2 - 0.5f, 0}, {0, 0, 1}, vec3(0.2f * i, 0, 0), 0.1f);
  Camera camera{.eye = {0, 0, 1 / std::tan(0.3f)}, .target = {0, 0, 0}};
  const Image image = Drawn::picture(scene, camera, 4096, 4096);
  for (int i = 0; i < 4; ++i)
    CHECK(at(image, 1024 + i % 2 * 2048, 3072 - i / 2 * 2048).r == doctest::Approx(0.2 * i));
  CHECK(!covered(image, 2048, 2048));
}

TEST_CASE_TEMPLATE("more samples a pixel give the same picture with a softer outline", Drawn, ByGl,
                   ByCpu) {
  const Scene scene = sphere(5000, [](vec3 p) { return vec3(p.y > 0, 0.5f, 0); });
  const SplatOptions once{.background = vec3(1)}, twice{.background = vec3(1), .samples = 2};
  const Image hard = Drawn::picture(scene, sphereCamera(), 200, 200, once);
  const Image soft = Drawn::picture(scene, sphereCamera(), 200, 200, twice);
  CHECK(structuralSimilarityError(hard, soft) < 0.1);
  const auto between = [](const Image& image) {  // blue is 1 outside and 0 inside
    int count = 0;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x) count += at(image, x, y).b > 0.1f && at(image, x, y).b < 0.9f;
    return count;
  };
  CHECK(between(hard) == 0);
  CHECK(between(soft) > 200);
}

// A plane of one point every `spacing` swatch pixels with its source map, head-on.
struct TexturedPlane {
  Swatch swatch;
  Scene scene;
  std::vector<vec2> texels;
  std::vector<TangentFrame> frames;

  TexturedPlane(int side, float spacing) {
    Image image{side, side, 3, {}};
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        for (const float k : {0.0f, 1.0f, 2.0f})
          image.pixels.push_back(0.5f + 0.4f * std::sin(1.1f * x + k) * std::sin(0.9f * y - k));
    swatch = makeSwatch(image, Tileable::No, 1, "test");
    const float middle = 0.5f * static_cast<float>(side);
    for (float y = 0.5f * spacing; y < side; y += spacing)
      for (float x = 0.5f * spacing; x < side; x += spacing) {
        scene.add({x - middle, middle - y, 0}, {0, 0, 1}, sampleSwatch(swatch, {x, y}), spacing);
        texels.emplace_back(x, y);
        frames.push_back({.s = {1, 0, 0}, .t = {0, 1, 0}, .n = {0, 0, 1}});
      }
  }

  template <class Drawn>
  Image draw(int pixels, bool withTexels, const std::vector<vec2>& from) const {
    const float away = 0.5f * static_cast<float>(swatch.height) / std::tan(0.3f);
    const Camera camera{.eye = {0, 0, away}, .target = {0, 0, 0}, .nearPlane = 1, .farPlane = 1e4f};
    const SplatTexture texture{swatch, from, frames, 1};
    return Drawn::picture(scene, camera, pixels, pixels, {.background = kBackground},
                          withTexels ? &texture : nullptr);
  }
  template <class Drawn>
  Image draw(int pixels, bool withTexels) const {
    return draw<Drawn>(pixels, withTexels, texels);
  }

  Image enlarged(int pixels) const {
    Image image{pixels, pixels, 3, {}};
    const float step = static_cast<float>(swatch.width) / static_cast<float>(pixels);
    for (int y = 0; y < pixels; ++y)
      for (int x = 0; x < pixels; ++x) {
        const vec3 c = sampleSwatch(swatch, step * vec2(x + 0.5f, y + 0.5f));
        image.pixels.insert(image.pixels.end(), {c.r, c.g, c.b});
      }
    return image;
  }
};

TEST_CASE_TEMPLATE("a textured plane gives back the swatch at any magnification", Drawn, ByGl,
                   ByCpu) {
  for (const auto& [pixels, spacing] : {std::pair{96, 1.0f}, {384, 1.0f}, {384, 3.0f}}) {
    CAPTURE(pixels);
    CAPTURE(spacing);
    const TexturedPlane plane(96, spacing);
    const Image wanted = plane.enlarged(pixels);
    const double with = structuralSimilarity(plane.draw<Drawn>(pixels, true), wanted);
    CHECK(with > 0.99);
    // Without, points further apart than the swatch's pixels lose what lies between them.
    if (spacing > 1) CHECK(structuralSimilarity(plane.draw<Drawn>(pixels, false), wanted) < 0.7);
  }
}

TEST_CASE_TEMPLATE("a splat without a texel, and one seen from afar, shows its colour", Drawn, ByGl,
                   ByCpu) {
  const TexturedPlane plane(96, 3);
  const std::vector<vec2> none(plane.texels.size(), vec2(std::nanf("")));
  CHECK(plane.draw<Drawn>(300, true, none).pixels == plane.draw<Drawn>(300, false).pixels);
  CHECK(plane.draw<Drawn>(60, true).pixels == plane.draw<Drawn>(60, false).pixels);
}

// Drawers of one kind after update(), recolour() and retexture().
struct Redrawn {
  const TexturedPlane& plane;
  Camera camera{.eye = {0, 0, 150}, .target = {0, 0, 0}, .nearPlane = 1, .farPlane = 1e4f};
  SplatOptions options{.background = kBackground};

  template <class Drawer>
  std::vector<float> pixels(Drawer& drawer) const {
    if constexpr (std::is_same_v<Drawer, CpuSplatter>) {
      Raster raster;
      drawer.draw(camera, 300, 300, options, raster);
      return toImage(raster).pixels;
    } else {
      return drawer.draw(camera, 300, 300, options).pixels;
    }
  }

  template <class Drawer>
  void check(Drawer& drawer) const {
    const SplatTexture texture{plane.swatch, plane.texels, plane.frames, 1};
    Scene scene = plane.scene;
    for (std::size_t i = scene.positions.size(); i-- > 0;)
      scene.order.push_back(static_cast<Index>(i));
    drawer.update(scene.columns(nullptr));
    const auto without = pixels(drawer);
    drawer.update(scene.columns(&texture));
    const auto with = pixels(drawer);
    CHECK(with != without);
    drawer.retexture(nullptr);
    CHECK(pixels(drawer) == without);
    drawer.retexture(&texture);
    CHECK(pixels(drawer) == with);
    PlainPoints plain(scene.positions.size(), 1);
    drawer.recolour(scene.colours, plain);
    CHECK(pixels(drawer) == without);
    for (std::size_t i = 0; i < plain.size() / 2; ++i) plain[i] = 0;  // the upper half
    drawer.recolour(scene.colours, plain);
    const auto half = pixels(drawer);
    const auto upper = static_cast<std::ptrdiff_t>(4 * 300 * 140);
    CHECK(std::equal(half.begin(), half.begin() + upper, with.begin()));
    CHECK(std::equal(half.end() - upper, half.end(), without.end() - upper));
    drawer.recolour(scene.colours);
    CHECK(pixels(drawer) == with);
  }
};

TEST_CASE("the swatch inside the splats comes and goes, for all points or for some") {
  const TexturedPlane plane(96, 3);
  Workers workers(2);
  CpuSplatter splatter(workers);
  Redrawn{plane}.check(splatter);
  Redrawn{plane}.check(studioOfAll().renderer);
}

TEST_CASE("a stray point is drawn like those around it, a sparse region without holes") {
  std::vector<vec3> points;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) points.emplace_back(x, y, 0);  // one apart
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) points.emplace_back(100 + 4 * x, 4 * y, 0);  // four apart
  points.emplace_back(20, 20, 30);
  for (int i = 0; i < 9; ++i) points.emplace_back(-60 + i % 3, i / 3, 0);  // one apart, far away
  Workers workers(1);
  Monitor monitor(workers);
  const std::vector<float> radii = splatRadii(buildNeighborhoods(points, 16, monitor), points);
  CHECK(radii[20 * 40 + 20] == doctest::Approx(splatRadius(1)).epsilon(0.15));
  CHECK(radii[1600 + 10 * 20 + 10] == doctest::Approx(splatRadius(4)).epsilon(0.15));
  CHECK(radii[2000] < splatRadius(2.5f));
  for (std::size_t i = 2001; i < 2010; ++i) CHECK(radii[i] < splatRadius(4));
}

TEST_CASE("a few points that are strewn far apart do not become blobs") {
  std::vector<vec3> points;
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 50; ++x) points.emplace_back(x, y, 0);  // one apart
  for (int i = 0; i < 25; ++i) points.emplace_back(300 + 60 * (i % 5), 60 * (i / 5), 0);
  Workers workers(1);
  Monitor monitor(workers);
  const std::vector<float> radii = splatRadii(buildNeighborhoods(points, 16, monitor), points);
  for (std::size_t i = 2500; i < radii.size(); ++i) CHECK(radii[i] < splatRadius(4));
  CHECK(radii[20 * 50 + 20] == doctest::Approx(splatRadius(1)).epsilon(0.15));
}

TEST_CASE_TEMPLATE("the headlight darkens what turns away and nothing else", Drawn, ByGl, ByCpu) {
  const Scene scene = sphere(5000, [](vec3) { return vec3(0.8f); });
  const Image image = Drawn::picture(scene, sphereCamera(), 200, 200,
                                     {.shading = Shading::Headlight, .background = kBackground});
  CHECK(at(image, 100, 100).r > 0.79f);
  const int rim = 100 + static_cast<int>(0.95f * outlineRadius(sphereCamera(), 200));
  CHECK(at(image, rim, 100).r < 0.6f);
  CHECK(at(image, rim, 100).r > 0.2f);
}

TEST_CASE_TEMPLATE(
    "without points a picture is the background, and a point without radius is not drawn", Drawn,
    ByGl, ByCpu) {
  Scene scene;
  CHECK(!covered(Drawn::picture(scene, sphereCamera(), 32, 32), 16, 16));
  scene.add({0, 0, 0}, {0, 0, 1}, vec3(0), 0);
  CHECK(!covered(Drawn::picture(scene, sphereCamera(), 32, 32), 16, 16));
}

TEST_CASE_TEMPLATE("a point without a normal faces the eye", Drawn, ByGl, ByCpu) {
  Scene scene;
  scene.add({0, 0, 0}, {0, 0, 0}, vec3(0), 0.3f);
  for (const char* view : {"front", "right", "top"}) {
    const Camera camera = standardView(view, Bounds{{-1, -1, -1}, {1, 1, 1}}, 1);
    const Image image = Drawn::picture(scene, camera, 100, 100);
    CHECK(covered(image, 58, 50));
    CHECK(covered(image, 50, 58));
  }
}

TEST_CASE("columns of different lengths and options out of range are refused") {
  Scene scene = sphere(10, noisy);
  CHECK_THROWS_AS(picture(scene, sphereCamera(), 0, 10), InvalidInput);
  CHECK_THROWS_AS(picture(scene, sphereCamera(), 10, 20000), InvalidInput);
  CHECK_THROWS_AS(picture(scene, sphereCamera(), 10, 10, {.lowPass = 0}), InvalidInput);
  CHECK_THROWS_AS(picture(scene, sphereCamera(), 10, 10, {.samples = 5}), InvalidInput);
  scene.normals.pop_back();
  CHECK_THROWS_AS(picture(scene, sphereCamera(), 10, 10), Bug);
}

TEST_CASE("print the hash of a picture" * doctest::skip()) {
  fmt::print("hash {:016x}\n", hashOf(threadsPicture()));
}

TEST_CASE("the picture has the same bytes at any number of OpenGL's threads") {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string here = fmt::format("hash {:016x}\n", hashOf(threadsPicture()));
  for (int threads : {0, 1, 2}) {
    const std::string command =
        fmt::format("LP_NUM_THREADS={} '{}' --no-skip --test-case='print the hash of a picture'",
                    threads, self);
    std::FILE* pipe = popen(command.c_str(), "r");
    REQUIRE(pipe != nullptr);
    std::string text;
    std::array<char, 4096> buffer;
    while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) text += buffer.data();
    CHECK(pclose(pipe) == 0);
    CAPTURE(text);
    CHECK(text.find(here) != std::string::npos);
  }
}

TEST_CASE_TEMPLATE("the studio's three lamps stay with the camera", Drawn, ByGl, ByCpu) {
  // Facing the eye, straight up and to the right, as the formula has them.
  const auto lit = [](vec3 n) {
    Scene scene;
    scene.add({0, 0, 0}, n, vec3(0.5f), 0.2f);
    const Camera camera{.eye = {0, 0, 50}, .target = {0, 0, 0}, .verticalFov = 0.02f};
    return at(Drawn::picture(scene, camera, 64, 64,
                             {.shading = Shading::Studio, .background = kBackground}),
              32, 32);
  };
  const vec3 sky(0.50f, 0.53f, 0.58f), key(0.74f, 0.70f, 0.64f), rim(0.16f, 0.19f, 0.26f);
  const vec3 lamp = glm::normalize(vec3(-0.45f, 0.60f, 0.66f));
  for (const vec3& direction : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(0, 1, 0.4f), vec3(-1, 0.5f, 1),
                                vec3(1, -0.4f, 0.3f), vec3(-1, 1, -1)}) {
    CAPTURE(direction.x);
    const vec3 given = glm::normalize(direction), n = given.z < 0 ? -given : given;
    const vec3 light = sky * (0.675f + 0.325f * n.y) + key * std::max(0.f, glm::dot(n, lamp)) +
                       rim * std::pow(1 - n.z, 3.f);
    CHECK(glm::distance(lit(given), glm::min(0.5f * light, vec3(1))) < 0.01f);
  }
}

TEST_CASE_TEMPLATE("points drawn in another order are the points given in that order", Drawn, ByGl,
                   ByCpu) {
  Scene scene = sphere(3000, noisy), other;
  for (Index i = 0; i < 3000; ++i) scene.order.push_back((i * 1009) % 3000);
  for (const Index i : scene.order) {
    other.add(scene.positions[i], scene.normals[i], scene.colours[i], 1);
    other.radii.back() = scene.radii[i];
  }
  const SplatOptions part{.background = kBackground, .count = 700};
  const Image expected = Drawn::picture(other, sphereCamera(), 150, 150, part);
  CHECK(Drawn::picture(scene, sphereCamera(), 150, 150, part).pixels == expected.pixels);
}

TEST_CASE("the first points alone, enlarged, are the picture of a scene with no others") {
  for (const int side : {100, 700}) {
    Scene scene = sphere(5000, noisy);
    const SplatOptions part{.background = kBackground, .count = 1237, .enlarge = 1.7f};
    const Image some = picture(scene, sphereCamera(), side, side, part);
    for (auto* column : {&scene.positions, &scene.normals, &scene.colours}) column->resize(1237);
    scene.radii.resize(1237);
    for (float& r : scene.radii) r *= 1.7f;
    const Image all = picture(scene, sphereCamera(), side, side);
    CHECK(structuralSimilarity(some, all) > 0.9999);
    CHECK(structuralSimilarity(some, picture(scene, sphereCamera(), side, side,
                                             {.background = kBackground, .count = 600})) < 0.9);
  }
}

TEST_CASE("only the columns that changed are uploaded, new colours as 4 bytes a point") {
  Scene scene = sphere(1000, noisy);
  SplatRenderer& renderer = studioOfAll().renderer;
  const SplatColumns columns{scene.positions, scene.normals, scene.colours, scene.radii};
  const auto drawn = [&] { return renderer.draw(sphereCamera(), 200, 200, {}).pixels; };
  std::size_t before = renderer.uploadedBytes();
  const auto uploaded = [&] {
    const std::size_t now = renderer.uploadedBytes();
    return now - std::exchange(before, now);
  };
  renderer.update(columns);
  CHECK(uploaded() == 1000 * (12 + 4 + 4 + 4));
  const auto first = drawn();
  CHECK(uploaded() == 0);

  for (vec3& c : scene.colours) c = vec3(1) - c;
  renderer.recolour(scene.colours);
  CHECK(uploaded() == 4000);
  const auto recoloured = drawn();
  renderer.update(columns);
  CHECK(drawn() == recoloured);
  CHECK(recoloured != first);
  uploaded();

  for (float& r : scene.radii) r *= 1.5f;
  renderer.update(columns,
                  {.positions = false, .normals = false, .colours = false, .texture = false});
  CHECK(uploaded() == 4000);
  const auto larger = drawn();
  renderer.update(columns);
  CHECK(drawn() == larger);
  CHECK_THROWS_AS(renderer.recolour({vec3(0)}), Bug);
  CHECK(takeGlMessages().empty());
}

TEST_CASE("a picture drawn into a framebuffer is the one that is read back, and touches no more") {
  const Scene scene = sphere(2000, noisy);
  const SplatOptions options{.shading = Shading::Studio, .background = vec3(0.2f), .samples = 2};
  const Image wanted = picture(scene, sphereCamera(), 150, 120, options);
  constexpr int kWide = 200, kHigh = 160, kLeft = 30, kLow = 25;
  const GlTexture colour = makeTexture(GL_RGBA8, kWide, kHigh);
  const GlFramebuffer framebuffer = makeFramebuffer(colour, nullptr);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  glClearColor(1, 0, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  // As a window's toolkit may have left it.
  for (const GLenum of : {GL_BLEND, GL_SCISSOR_TEST, GL_CULL_FACE}) glEnable(of);
  glScissor(0, 0, 3, 3);
  glCullFace(GL_FRONT_AND_BACK);
  glActiveTexture(GL_TEXTURE3);
  studioOfAll().renderer.drawInto({framebuffer.id(), kLeft, kLow}, sphereCamera(), 150, 120,
                                  options);
  std::vector<std::uint8_t> bytes(4 * kWide * kHigh);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  glReadPixels(0, 0, kWide, kHigh, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  int wrong = 0;
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) {
      const int px = x - kLeft, py = 119 - (y - kLow);
      const bool inside = px >= 0 && px < 150 && py >= 0 && py < 120;
      const vec3 expected = inside ? at(wanted, px, py) : vec3(1, 0, 1);
      for (int c = 0; c < 3; ++c)
        wrong += bytes[static_cast<std::size_t>(4 * (y * kWide + x) + c)] !=
                 static_cast<int>(std::lround(255 * expected[c]));
    }
  CHECK(wrong == 0);
  CHECK(takeGlMessages().empty());
}

TEST_CASE("tiles find their places in a framebuffer") {
  const Scene scene = sphere(500, noisy);
  Camera camera = sphereCamera();
  camera.verticalFov = 0.06f;
  constexpr int kWide = 2300, kHigh = 40;
  const Image wanted = picture(scene, camera, kWide, kHigh);
  const GlTexture colour = makeTexture(GL_RGBA8, kWide + 5, kHigh);
  const GlFramebuffer framebuffer = makeFramebuffer(colour, nullptr);
  studioOfAll().renderer.drawInto({framebuffer.id(), 5, 0}, camera, kWide, kHigh,
                                  {.background = kBackground});
  std::vector<std::uint8_t> bytes(std::size_t{4} * kWide * kHigh);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  glReadPixels(5, 0, kWide, kHigh, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  int wrong = 0;
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x)
      wrong += bytes[static_cast<std::size_t>(4 * (y * kWide + x))] !=
               static_cast<int>(std::lround(255 * wanted.at(x, kHigh - 1 - y, 0)));
  CHECK(wrong == 0);
}

TEST_CASE_TEMPLATE("a splat leaves the picture without a jump", Drawn, ByGl, ByCpu) {
  // Moved out by a tenth of a pixel at a time, of any size: it covers fewer and fewer pixels.
  for (const float pixels : {2.f, 6.f, 20.f, 60.f, 400.f}) {
    CAPTURE(pixels);
    const float perPixel = 2.f / 64;
    Scene scene;
    scene.add({0, 0, 0}, {0, 0, 1}, vec3(0), 1);
    scene.radii[0] = pixels * perPixel;
    Camera camera{.eye = {0, 0, 50}, .target = {0, 0, 0}, .orthographicHeight = 2};
    int last = 64 * 64;
    const float step = std::max(0.1f, pixels / 100);
    for (float out = 0; out < pixels + 3; out += step) {
      scene.positions[0].x = 1 + out * perPixel;
      const Image image = Drawn::picture(scene, camera, 64, 64);
      int area = 0;
      for (int k = 0; k < 64 * 64; ++k) area += covered(image, k % 64, k / 64);
      REQUIRE(area <= last);
      if (out > 0) REQUIRE(last - area <= (step + 1) * std::min(64.f, 2 * pixels));
      if (out < pixels - 1.3f) REQUIRE(area > 0);
      last = area;
    }
    CHECK(last == 0);
  }
}

TEST_CASE("a disc reaching from before the eye to behind it is cut off where it should be") {
  // The ground under the eye: all of the picture below the horizon and within the disc.
  Scene scene;
  scene.add({0, -1, 0}, {0, 1, 0}, vec3(0), 1);
  scene.radii[0] = 20;
  const Camera camera{.eye = {0, 0, 1}, .target = {0, 0, 0}, .verticalFov = 1};
  const Image image = picture(scene, camera, 200, 200);
  const float focal = 100 / std::tan(0.5f);
  const float rim = 100 + focal / 21;  // the far rim lies 21 away, 1 below
  int wrong = 0;
  for (int x = 80; x < 120; ++x)
    for (int y = 0; y < 200; ++y)
      if (std::abs(y + 0.5f - rim) > 2) wrong += covered(image, x, y) != (y + 0.5f > rim);
  CHECK(wrong == 0);
}

TEST_CASE("a large disc turned to its edge shrinks to the low-pass as the processor's does") {
  for (const float turned : {0.f, 1e-5f, 1e-3f, 0.01f, 0.03f, 0.1f})
    for (const float angle : {0.f, 0.3f, 0.8f, 1.57f}) {
      CAPTURE(turned);
      CAPTURE(angle);
      Scene scene;
      scene.add({0.01f, 0, 0},
                {std::cos(angle) * std::cos(turned), std::sin(angle) * std::cos(turned),
                 std::sin(turned)},
                vec3(0), 1);
      scene.radii[0] = 0.6f;
      const Camera camera{.eye = {0, 0, 50}, .target = {0, 0, 0}, .orthographicHeight = 2};
      const auto areaOf = [](const Image& image) {
        int area = 0;
        for (int k = 0; k < 200 * 200; ++k) area += covered(image, k % 200, k / 200);
        return area;
      };
      const int area = areaOf(picture(scene, camera, 200, 200));
      const int wanted = areaOf(ByCpu::picture(scene, camera, 200, 200));
      CHECK(area >= 3);
      CHECK(std::abs(area - wanted) <= 12 + wanted / 50);
    }
}

TEST_CASE("what lies behind a surface is left out without a trace") {
  // A ball inside a ball, and the same ball alone: from outside they look the same.
  Scene scene = sphere(20000, noisy);
  const Image alone = picture(scene, sphereCamera(), 300, 300);
  const Scene inner = sphere(20000, [](vec3) { return vec3(1, 0, 0); });
  for (std::size_t i = 0; i < inner.positions.size(); ++i) {
    scene.add(0.8f * inner.positions[i], i % 2 == 0 ? inner.normals[i] : -inner.normals[i],
              vec3(1, 0, 0), 0.02f);
  }
  CHECK(picture(scene, sphereCamera(), 300, 300).pixels == alone.pixels);
}
