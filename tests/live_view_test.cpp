#include "app/render/live_view.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "base/errors.h"
#include "tests/fixtures.h"

using namespace dapple;

namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = DetailPacer::Milliseconds;

constexpr int kWidth = 200, kHeight = 160;
constexpr SplatOptions kOptions{.shading = Shading::Headlight, .background = vec3(1, 0, 1)};

struct Ball {
  PointSet points;
  std::vector<vec3> colours;
  std::vector<float> radii;

  explicit Ball(std::size_t n) : points(fixtures::makeSphere(n, 1)) {
    const float spacing = std::sqrt(4 * 3.14159265f / static_cast<float>(n));
    radii.assign(n, splatRadius(spacing));
    for (const vec3& p : points.positions) colours.push_back(0.5f + 0.4f * glm::sin(5.f * p));
  }
  SplatColumns columns() const { return {points.positions, points.normals, colours, radii}; }
  Camera camera(float turn = 0) const {
    Camera camera = standardView("front", points.positions, 1.f * kWidth / kHeight);
    const float distance = camera.eye.z;
    camera.eye = distance * vec3(std::sin(turn), 0, std::cos(turn));
    camera.target = vec3(0);
    return camera;
  }
};

template <class T>
std::vector<T> firstOf(const std::vector<T>& column, const std::vector<Index>& order,
                       std::size_t count) {
  std::vector<T> out;
  for (std::size_t k = 0; k < count; ++k) out.push_back(column[order[k]]);
  return out;
}

bool same(const Raster& a, const Raster& b) {
  return a.width == b.width && a.height == b.height && a.pixels == b.pixels &&
         a.points == b.points && a.depths == b.depths;
}

bool untilComplete(LiveView& view, const Camera& camera, Milliseconds budget) {
  for (int k = 0; k < 10000; ++k)
    if (view.frame(camera, kWidth, kHeight, kOptions, budget) == LiveView::Progress::Complete)
      return true;
  return false;
}

}  // namespace

TEST_CASE("each level of detail is every second point of the next one") {
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{8192}, std::size_t{8193},
                              std::size_t{100001}}) {
    CAPTURE(n);
    const LevelOrder levels = levelOrder(n);
    REQUIRE(levels.counts.back() == n);
    std::size_t step = std::size_t{1} << (levels.counts.size() - 1);
    for (const std::size_t count : levels.counts) {
      std::vector<Index> ids(levels.order.begin(),
                             levels.order.begin() + static_cast<std::ptrdiff_t>(count));
      std::sort(ids.begin(), ids.end());
      std::vector<Index> expected;
      for (std::size_t i = 0; i < n; i += step) expected.push_back(static_cast<Index>(i));
      CHECK(ids == expected);
      step /= 2;
    }
    CHECK(levels.enlargement(levels.counts.size() - 1) == 1);
    CHECK(levels.counts.front() <= 8192);
  }
}

TEST_CASE("no level of detail leaves a hole in a ball") {
  const Ball ball(100000);
  const LevelOrder levels = levelOrder(ball.points.size());
  REQUIRE(levels.counts.size() == 5);
  Workers workers(2);
  CpuSplatter splatter(workers);
  SplatColumns columns = ball.columns();
  columns.order = &levels.order;
  splatter.update(columns);
  const Camera camera = ball.camera();
  for (std::size_t level = 0; level < levels.counts.size(); ++level) {
    CAPTURE(level);
    SplatOptions options = kOptions;
    options.count = levels.counts[level], options.enlarge = levels.enlargement(level);
    Raster raster{.trace = true};
    splatter.draw(camera, kWidth, kHeight, options, raster);
    // The ball fills the picture's height but for the margins.
    int holes = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if (std::hypot(x + 0.5f - kWidth / 2, y + 0.5f - kHeight / 2) < 0.45f * kHeight)
          holes += raster.points[static_cast<std::size_t>(y * kWidth + x)] == kNone;
    CHECK(holes == 0);
  }
}

TEST_CASE("a part of the points is drawn as if there were no others") {
  const Ball ball(5000);
  std::vector<Index> order(ball.points.size());
  std::iota(order.rbegin(), order.rend(), Index{0});
  constexpr std::size_t kCount = 1237;
  Workers workers(2);
  CpuSplatter whole(workers), part(workers);
  SplatColumns columns = ball.columns();
  columns.order = &order;
  whole.update(columns);
  const auto positions = firstOf(ball.points.positions, order, kCount);
  const auto normals = firstOf(ball.points.normals, order, kCount);
  const auto colours = firstOf(ball.colours, order, kCount);
  auto radii = firstOf(ball.radii, order, kCount);
  for (float& radius : radii) radius *= 1.5f;
  part.update({positions, normals, colours, radii});
  Raster a{.trace = true}, b{.trace = true};
  SplatOptions options = kOptions;
  part.draw(ball.camera(), kWidth, kHeight, options, b);
  options.count = kCount, options.enlarge = 1.5f;
  whole.draw(ball.camera(), kWidth, kHeight, options, a);
  for (Index& id : b.points)
    if (id != kNone) id = order[id];
  CHECK(same(a, b));
}

TEST_CASE("a picture drawn in steps has the bytes of one drawn at once") {
  const Ball ball(3000);
  Workers workers(3);
  CpuSplatter splatter(workers);
  splatter.update(ball.columns());
  Raster atOnce{.trace = true}, inSteps{.trace = true};
  splatter.draw(ball.camera(), kWidth, kHeight, kOptions, atOnce);
  splatter.begin(ball.camera(), kWidth, kHeight, kOptions, inSteps);
  int steps = 1;
  while (!splatter.advance(Clock::time_point::min(), inSteps)) ++steps;
  CHECK(steps > 5);
  CHECK(steps <= 35);  // tiles
  CHECK(same(atOnce, inSteps));
}

TEST_CASE("what is not drawn yet shows the last picture, from the middle outwards") {
  const Ball ball(3000);
  Workers workers(1);
  CpuSplatter splatter(workers);
  splatter.update(ball.columns());
  Raster raster;
  splatter.draw(ball.camera(), kWidth, kHeight, kOptions, raster);
  const Raster before = raster;
  SplatOptions options = kOptions;
  options.background = vec3(0, 1, 0);
  options.shading = Shading::Studio;
  splatter.begin(ball.camera(), kWidth, kHeight, options, raster);
  CHECK_FALSE(splatter.advance(Clock::time_point::min(), raster));
  const auto pixel = [](const Raster& r, int x, int y) {
    return r.pixels[static_cast<std::size_t>(y * kWidth + x)];
  };
  CHECK(pixel(raster, 0, 0) == pixel(before, 0, 0));
  CHECK(pixel(raster, kWidth / 2, kHeight / 2) != pixel(before, kWidth / 2, kHeight / 2));
}

TEST_CASE("a window's picture is whole at once and complete when the camera rests") {
  const Ball ball(60000);
  Workers workers(2);
  CpuSplatter splatter(workers);
  const LevelOrder levels = levelOrder(ball.points.size());
  SplatColumns columns = ball.columns();
  columns.order = &levels.order;
  splatter.update(columns);
  LiveView view(workers);
  view.update(ball.columns());
  for (const float turn : {0.f, 0.1f, 0.2f}) {
    const Camera camera = ball.camera(turn);
    // More time than it takes, and less.
    for (const double budget : {1e6, 1e-3}) {
      REQUIRE(untilComplete(view, camera, Milliseconds(budget)));
      Raster expected{.trace = true};
      splatter.draw(camera, kWidth, kHeight, kOptions, expected);
      CHECK(same(view.picture(), expected));
    }
  }
}

TEST_CASE("a window's picture that has no time is drawn of fewer points and then refined") {
  const Ball ball(60000);
  Workers workers(1);
  LiveView view(workers);
  view.update(ball.columns());
  const Milliseconds none(0);
  CHECK(view.frame(ball.camera(), kWidth, kHeight, kOptions, none) == LiveView::Progress::Coarse);
  CHECK(view.frame(ball.camera(), kWidth, kHeight, kOptions, none) == LiveView::Progress::Refining);
  REQUIRE(untilComplete(view, ball.camera(), none));
  const Raster complete = view.picture();
  CHECK(view.frame(ball.camera(), kWidth, kHeight, kOptions, none) == LiveView::Progress::Complete);
  CHECK(same(view.picture(), complete));
}

TEST_CASE("a window's picture follows new colours and knows its points") {
  const Ball ball(20000);
  Workers workers(2);
  LiveView view(workers);
  view.update(ball.columns());
  const Camera camera = ball.camera();
  REQUIRE(untilComplete(view, camera, Milliseconds(1e6)));
  const std::size_t middle = static_cast<std::size_t>(kHeight / 2 * kWidth + kWidth / 2);
  const Index point = view.picture().points[middle];
  REQUIRE(point < ball.points.size());
  CHECK(glm::distance(ball.points.positions[point], vec3(0, 0, 1)) < 0.03f);
  CHECK(view.picture().depths[middle] == doctest::Approx(camera.eye.z - 1).epsilon(0.01));

  std::vector<vec3> colours(ball.points.size(), vec3(0));
  colours[point] = vec3(0, 1, 0);
  view.recolour(colours);
  REQUIRE(untilComplete(view, camera, Milliseconds(1e6)));
  CHECK((view.picture().pixels[middle] & 0xff00ff) == 0);
  CHECK((view.picture().pixels[middle] >> 8 & 255) > 40);
}

TEST_CASE("the level of detail follows the time that pictures take") {
  const std::vector<std::size_t> counts{1000, 2000, 4000, 8000, 16000};
  const Milliseconds budget(33);
  DetailPacer pacer;
  pacer.start({1000, 2000, 2000000000}, budget);
  CHECK(pacer.level() == 1);
  pacer.start(counts, Milliseconds(0));
  CHECK(pacer.level() == 0);
  SUBCASE("finer while there is time") {
    for (std::size_t level = 1; level < counts.size(); ++level) {
      pacer.took(Milliseconds(5), true, 1000, budget);
      CHECK(pacer.level() == level);
    }
    pacer.took(Milliseconds(5), true, 1000, budget);
    CHECK(pacer.level() == counts.size() - 1);
  }
  SUBCASE("not finer when twice the splats would be late, but when pixels cost most") {
    pacer.took(Milliseconds(20), true, 400000, budget);
    CHECK(pacer.level() == 0);
    pacer.took(Milliseconds(20), true, 1000, budget);
    CHECK(pacer.level() == 1);
  }
  SUBCASE("coarser when late, and then not as fine again for a while") {
    for (int k = 0; k < 3; ++k) pacer.took(Milliseconds(5), true, 1000, budget);
    REQUIRE(pacer.level() == 3);
    pacer.took(Milliseconds(40), true, 1000, budget);
    CHECK(pacer.level() == 2);
    for (int k = 0; k < 10; ++k) pacer.took(Milliseconds(5), true, 1000, budget);
    CHECK(pacer.level() == 2);
    for (int k = 0; k < 60; ++k) pacer.took(Milliseconds(5), true, 1000, budget);
    CHECK(pacer.level() == 4);
  }
  SUBCASE("two levels coarser when it was stopped") {
    for (int k = 0; k < 3; ++k) pacer.took(Milliseconds(5), true, 1000, budget);
    pacer.took(Milliseconds(33), false, 1000, budget);
    CHECK(pacer.level() == 1);
  }
}
