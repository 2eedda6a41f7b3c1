// Prints how long orientation fields take on a bumpy sphere of 1 M points with five strokes, how
// smooth they are and how well they meet the strokes, beside the targets (methods: section 1.3).
// Nothing is asserted.
//
// dapple_field_bench [POINTS] [THREADS]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>

#include "regions/singularities.h"
#include "regions/smooth_field.h"
#include "tests/fixtures.h"

namespace {

using namespace dapple;
using Clock = std::chrono::steady_clock;

constexpr int kRuns = 3;

double medianSeconds(const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int r = 0; r <= kRuns; ++r) {  // the first is not counted
    const auto start = Clock::now();
    work();
    if (r > 0) seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

void print(const std::string& what, const std::string& figure, const std::string& target = "") {
  fmt::print("{:<58} {:>12}   {}\n", what, figure, target);
  std::fflush(stdout);
}

std::string milliseconds(double seconds) {
  return fmt::format("{:.1f} ms", seconds * 1e3);
}

float heightOf(const vec3& p) {
  const vec3 d = glm::normalize(p);
  return glm::length(p) - 1 - 0.06f * std::sin(7 * d.x) * std::sin(7 * d.y) * std::sin(7 * d.z);
}

PointSet bumpySphere(std::size_t count) {
  PointSet points = fixtures::makeSphere(count, 1);
  for (std::size_t i = 0; i < count; ++i) {
    vec3& p = points.positions[i];
    p *= 1 - heightOf(p);
    vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      vec3 step(0);
      step[axis] = 1e-3f;
      gradient[axis] = heightOf(p + step) - heightOf(p - step);
    }
    points.normals[i] = glm::normalize(gradient);
  }
  return points;
}

// A line over the surface between two directions, through the nearest points.
Stroke strokeBetween(const PointSet& points, const vec3& from, const vec3& to) {
  constexpr int kSteps = 20;
  Stroke stroke;
  for (int s = 0; s <= kSteps; ++s) {
    const vec3 at = glm::normalize(glm::mix(from, to, static_cast<float>(s) / kSteps));
    Index best = 0;
    for (Index i = 1; i < points.size(); ++i)
      if (glm::dot(points.positions[i], at) / glm::length(points.positions[i]) >
          glm::dot(points.positions[best], at) / glm::length(points.positions[best]))
        best = i;
    stroke.points.push_back(best);
    stroke.positions.push_back(points.positions[best]);
  }
  return stroke;
}

std::vector<Stroke> fiveStrokes(const PointSet& points) {
  return {strokeBetween(points, {1, 0, 0}, {0.6f, 0.8f, 0.1f}),
          strokeBetween(points, {-1, 0.2f, 0}, {-0.7f, 0.1f, 0.7f}),
          strokeBetween(points, {0, 0.2f, 1}, {0.5f, -0.4f, 0.8f}),
          strokeBetween(points, {0, 1, -0.3f}, {-0.4f, 0.6f, -0.7f}),
          strokeBetween(points, {0.1f, -1, 0}, {0.2f, -0.6f, -0.8f})};
}

struct Bench {
  PointSet points;
  Neighborhoods neighborhoods;
  Monitor& monitor;
  float spacing = 0;

  std::vector<StrokeMark> marks(const std::vector<Stroke>& strokes) const {
    return strokeMarks(points, neighborhoods, strokes);
  }
};

void printQuality(const Bench& bench, const OrientationField& field,
                  const std::vector<StrokeMark>& marks, FieldSymmetry symmetry) {
  std::vector<Singularity> found;
  const double seconds = medianSeconds([&] {
    found = singularities(bench.points, bench.neighborhoods, field.frames, symmetry, bench.monitor);
  });
  int sum = 0;
  for (const Singularity& s : found) sum += s.index;
  const double kinked = kinkedShare(bench.points, bench.neighborhoods, field.frames, symmetry,
                                    {.singularities = found, .clearance = 5 * bench.spacing});
  float worst = 1;
  for (const StrokeMark& mark : marks) {
    const float cosine = glm::dot(field.frames[mark.point].t, mark.direction);
    worst = std::min(worst, symmetry == FieldSymmetry::None ? cosine : std::abs(cosine));
  }
  print("  singularities: to find them", milliseconds(seconds));
  print("  singularities: number, sum of indices",
        fmt::format("{}, {:g}", found.size(), static_cast<double>(sum) / foldsOf(symmetry)),
        "sum 2");
  print("  links that turn by more than 20 degrees", fmt::format("{:.4f} %", kinked * 100),
        "<= 0.3 %");
  if (symmetry != FieldSymmetry::Quarter)
    print("  largest error on a stroke",
          fmt::format("{:.2f} deg", std::acos(std::min(worst, 1.f)) * 180 / std::numbers::pi),
          "<= 1 deg");
}

void printSmooth(const Bench& bench, const std::vector<Stroke>& strokes, FieldSymmetry symmetry) {
  const FieldOptions options{.symmetry = symmetry};
  const auto marks = bench.marks(strokes);
  fmt::print("smooth, {} fold\n", foldsOf(symmetry));
  print("  hierarchy", milliseconds(medianSeconds([&] {
          SmoothField(bench.points, bench.neighborhoods, options, bench.monitor);
        })));
  SmoothField field(bench.points, bench.neighborhoods, options, bench.monitor);
  print("  field, after the hierarchy",
        milliseconds(medianSeconds([&] { field.solve(marks, bench.monitor); })),
        "<= 500 ms for 1 M points");
  printQuality(bench, field.field(), marks, symmetry);
  print("  without strokes", milliseconds(medianSeconds([&] { field.solve({}, bench.monitor); })));
}

void printUpdates(const Bench& bench, const std::vector<Stroke>& strokes) {
  fmt::print("an edit\n");
  const auto marks = bench.marks(strokes);
  SmoothField field(bench.points, bench.neighborhoods, {}, bench.monitor);
  field.solve(marks, bench.monitor);
  for (const float reach : {0.02f, 0.05f, 0.1f, 0.2f}) {
    // Beside a stroke that it turns from, so that it does not reach far.
    std::vector<Stroke> edited = strokes;
    edited.push_back(strokeBetween(bench.points, glm::normalize(vec3(0.9f, 0.4f, 0.1f)),
                                   glm::normalize(vec3(0.9f, 0.4f, 0.1f + reach))));
    const auto other = bench.marks(edited);
    std::size_t turned = 0;
    bool on = false;
    const double seconds = medianSeconds([&] {
      on = !on;
      turned = field.update(on ? other : marks, 1, bench.monitor).size();
    });
    print(fmt::format("  stroke of length {}: turns {} points", reach, turned),
          milliseconds(seconds), "<= 50 ms for 50,000 points");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000000;
  const unsigned threads = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1;
  Workers workers(threads);
  Monitor monitor(workers);
  Bench bench{.points = bumpySphere(count), .neighborhoods = {}, .monitor = monitor};
  bench.neighborhoods = buildNeighborhoods(bench.points.positions, 25, monitor);
  bench.spacing = static_cast<float>(meanSpacing(bench.neighborhoods, bench.points.positions));
  fmt::print("{} points, {} threads\n", count, workers.threads());
  const std::vector<Stroke> strokes = fiveStrokes(bench.points);
  for (const FieldSymmetry symmetry :
       {FieldSymmetry::None, FieldSymmetry::Half, FieldSymmetry::Quarter})
    printSmooth(bench, strokes, symmetry);
  printUpdates(bench, strokes);
  fmt::print("spread\n");
  OrientationField spread;
  print("  field", milliseconds(medianSeconds([&] {
          spread = orientPoints(bench.points, bench.neighborhoods, strokes,
                                {.method = FieldMethod::Spread}, monitor);
        })));
  printQuality(bench, spread, bench.marks(strokes), FieldSymmetry::None);
}
