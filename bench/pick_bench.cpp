// Milliseconds that picking takes in a picture of 1280 x 720, for three sizes of scan, on one
// thread and on two. Medians of several runs; nothing is asserted.
//
// dapple_pick_bench [--quick]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>
#include <vector>

#include "app/render/picking.h"
#include "tests/fixtures.h"

namespace {

using namespace dapple;

constexpr int kWidth = 1280, kHeight = 720;

double medianMilliseconds(int runs, const std::function<void()>& work) {
  std::vector<double> times;
  for (int r = 0; r <= runs; ++r) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    if (r > 0) times.push_back(took.count());
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

// A wavy hand-drawn outline around most of the ball.
std::vector<vec2> lasso() {
  constexpr int kCorners = 400;
  std::vector<vec2> corners;
  for (int i = 0; i < kCorners; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / kCorners;
    const float radius = 260 + 50 * std::sin(9 * angle) + 4 * std::sin(61 * angle);
    corners.emplace_back(640 + radius * std::cos(angle), 360 + radius * std::sin(angle));
  }
  return corners;
}

void benchmark(std::size_t n, unsigned threads, int runs) {
  PointSet points = fixtures::makeSphere(n, 1);
  const std::vector<Index> order = mortonOrder(points.positions);
  std::vector<vec3> positions(n), colours(n, vec3(0.5f));
  for (std::size_t i = 0; i < n; ++i) positions[i] = points.positions[order[i]];
  const std::vector<float> radii(
      n, splatRadius(std::sqrt(4 * std::numbers::pi_v<float> / static_cast<float>(n))));
  const Camera camera =
      standardView("front", positions, static_cast<float>(kWidth) / static_cast<float>(kHeight));
  Workers workers(threads);
  CpuSplatter splatter(workers);
  splatter.update({positions, positions, colours, radii});
  Raster traced;
  traced.trace = true;
  splatter.draw(camera, kWidth, kHeight, {}, traced);
  Picker picker(workers);
  picker.update(positions, positions, radii);
  const PickView seen{camera, kWidth, kHeight, &traced}, through{camera, kWidth, kHeight};
  const std::vector<vec2> outline = lasso();
  const Ball ball{.centre = vec3(0, 0, 1), .radius = 0.2f};
  std::size_t found = 0;
  const auto row = [&](const std::function<std::size_t()>& pick) {
    fmt::print(" {:>8.2f}", medianMilliseconds(runs, [&] { found = pick(); }));
  };
  fmt::print("{:>9} {:>2}", n, threads);
  row([&] { return picker.pointAt(seen, {600, 330}, 8).has_value(); });
  row([&] { return picker.pointAt(through, {600, 330}, 8).has_value(); });
  row([&] { return picker.inDisc(seen, {640, 360}, 50).size(); });
  row([&] { return picker.inDisc(seen, {640, 360}, 400).size(); });
  row([&] { return picker.inDisc(through, {640, 360}, 400).size(); });
  row([&] { return picker.inPolygon(seen, outline).size(); });
  row([&] { return picker.inPolygon(through, outline).size(); });
  fmt::print(" {:>9}", found);
  row([&] { return picker.inBall(ball, &seen).size(); });
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
  fmt::print(
      "   points th    point   (thr.)  disc 50 disc 400   (thr.)    lasso   (thr.)   (found)     "
      "ball\n");
  for (const std::size_t n : {100'000, 1'000'000, 4'000'000})
    for (const unsigned threads : {1u, 2u})
      if (!quick || n == 100'000) benchmark(n, threads, quick ? 1 : 11);
}
