#include "swatch/swatch_analysis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "swatch/autocorrelation.h"
#include "swatch/gaussian_blur.h"
#include "swatch/swatch_relief.h"

namespace dapple {
namespace {

constexpr double kSide = 256;      // of a swatch that is looked at as it is, pixels
constexpr double kTensorBlur = 1;  // sigma, pixels
// Steps of the pieces that are matched: parts of a feature, where it has much detail, and features
// with what is around them.
constexpr double kFineStep = 0.25, kCoarseStep = 0.5;   // features
constexpr double kLargestFine = 2, kLargestCoarse = 6;  // pixels
// Between all swatches that were looked at: unturned matches differ by up to 1.12 in those where no
// turn shows; reptile skin upside down is at 1.21.
constexpr double kTurnShows = 1.19;
// A quarter turn may not show at all: letters lying on their sides are at 1.18.
constexpr double kQuarterShows = 1.1;
constexpr double kLattice = 0.22;  // wood has up to 0.15, reptile skin 0.26
// Where no turn shows: roof tiles under much dust, which outweighs what a turn changes, have 0.25,
// the leopards, olives and pebbles that come nearest to a lattice 0.14.
constexpr double kLatticeGoesOn = 0.18;
constexpr std::size_t kMostRepeats = 40;  // that lattices are made of
constexpr int kLatticeSteps = 6;          // each way
constexpr int kFewestSteps = 8;           // within reach, of a lattice that counts
constexpr double kReach = 0.9;            // of the autocorrelation's, for a lattice
constexpr double kStepsAcross = 12;       // the swatch, at least
constexpr double kUncorrelated = 0.1, kFlatCorrelation = 0.01;  // a pixel
constexpr double kSecondAngle = 30;  // degrees between two repeats that make a lattice

// Squares of `factor` x `factor` texels as one each, the mean of their opaque ones.
Swatch reduced(const Swatch& swatch, int factor, Monitor& monitor) {
  const auto cells = [factor](int size) { return std::max(2, size / factor); };
  Swatch out{
      .width = cells(swatch.width), .height = cells(swatch.height), .tileable = swatch.tileable};
  std::vector<vec3> colours(out.pixels(), vec3(0));
  const float* heights = swatch.relief.empty() ? nullptr : swatch.relief.front().data();
  std::vector<float> relief(heights ? out.pixels() : 0);
  out.opaque.assign(out.pixels(), 0);
  for (int y = 0; y < out.height; ++y) {
    monitor.checkpoint();
    for (int x = 0; x < out.width; ++x) {
      vec3 sum(0);
      float count = 0, height = 0;
      for (int v = y * swatch.height / out.height; v < (y + 1) * swatch.height / out.height; ++v)
        for (int u = x * swatch.width / out.width; u < (x + 1) * swatch.width / out.width; ++u) {
          const std::size_t i = static_cast<std::size_t>(v) * swatch.width + u;
          if (!swatch.opaque[i]) continue;
          sum += swatch.colours()[i], ++count;
          if (heights) height += heights[i];
        }
      const std::size_t i = static_cast<std::size_t>(y) * out.width + x;
      out.opaque[i] = count > 0;
      if (count > 0) colours[i] = sum / count;
      if (count > 0 && heights) relief[i] = height / count;
      out.hasHoles |= count == 0;
    }
  }
  if (out.hasHoles) fillHoles(out, colours);
  out.stack.push_back(std::move(colours));
  if (heights) setRelief(out, std::move(relief));
  return out;
}

struct Tensor {
  double xx = 0, xy = 0, yy = 0;
};

void addGradients(const Swatch& swatch, Tensor& sum) {
  const std::vector<vec3> colours = blurSwatch(swatch, kTensorBlur);
  const std::size_t w = swatch.width;
  for (std::size_t y = 1; y + 1 < static_cast<std::size_t>(swatch.height); ++y)
    for (std::size_t x = 1; x + 1 < w; ++x) {
      const std::size_t i = y * w + x;
      const vec3 right = colours[i + 1] - colours[i - 1], up = colours[i - w] - colours[i + w];
      sum.xx += glm::dot(right, right), sum.xy += glm::dot(right, up), sum.yy += glm::dot(up, up);
    }
}

// Coherence and direction of the structure tensor, summed over the swatch.
void measureAnisotropy(const Swatch& swatch, SwatchAnalysis& out) {
  Tensor sum;
  addGradients(swatch, sum);
  if (!swatch.relief.empty()) {
    // As one colour more, not three.
    Swatch heights = reliefAsColours(swatch);
    for (vec3& h : heights.stack.front()) h *= std::numbers::inv_sqrt3_v<float>;
    addGradients(heights, sum);
  }
  const auto [xx, xy, yy] = sum;
  if (xx + yy < 1e-9) return;
  out.anisotropy = std::hypot(xx - yy, 2 * xy) / (xx + yy);
  const double steepest = 0.5 * std::atan2(2 * xy, xx - yy) * 180 / std::numbers::pi;
  out.grain = std::fmod(steepest + 270, 180);
}

// First minimum of the radial mean, pixels; where it only falls, where nothing is left of it.
double featureSize(const std::vector<double>& radial) {
  const auto smooth = [&](std::size_t r) {
    return 0.25 * (radial[r > 0 ? r - 1 : 1] + 2 * radial[r] + radial[r + 1]);
  };
  for (std::size_t r = 1; r + 2 < radial.size(); ++r)
    if (smooth(r) <= smooth(r + 1) ||
        (smooth(r) < kUncorrelated && smooth(r) - smooth(r + 1) < kFlatCorrelation))
      return static_cast<double>(r);
  return std::max(1.0, static_cast<double>(radial.size()) - 1);
}

struct Repeat {
  vec2 lag{0};
  float value = 0;
};

// Peaks of the upper half plane that are beyond a feature and stand out from the way to them.
std::vector<Repeat> repeatsOf(const Autocorrelation& c, double feature) {
  std::vector<Repeat> out;
  for (int y = 0; y < c.reachY; ++y)
    for (int x = y == 0 ? 1 : -c.reachX + 1; x < c.reachX; ++x) {
      if (std::hypot(x, y) < std::max(2.0, feature)) continue;
      const float value = c.at(x, y);
      bool peak = value > 0;
      for (int v = -1; v <= 1; ++v)
        for (int u = -1; u <= 1; ++u) peak &= value >= c.at(x + u, y + v);
      if (!peak) continue;
      float lowest = 1;
      const int steps = std::max(std::abs(x), y);
      for (int s = 1; s < steps; ++s)
        lowest = std::min(lowest, c.at(static_cast<int>(std::lround(double(x) * s / steps)),
                                       static_cast<int>(std::lround(double(y) * s / steps))));
      out.push_back({vec2(x, y), std::min(value, value - lowest)});
    }
  return out;
}

bool crosses(vec2 a, vec2 b) {
  static const float sine = static_cast<float>(std::sin(kSecondAngle * std::numbers::pi / 180));
  return std::abs(a.x * b.y - a.y * b.x) > sine * glm::length(a) * glm::length(b);
}

struct Lattice {
  vec2 a{0}, b{0};
};

// The largest about each of the lattice's places beside lag 0, on average; no number with few.
double meanAt(const Autocorrelation& c, const Lattice& lattice, vec2 shift, int fewest) {
  const vec2 reach = static_cast<float>(kReach) * vec2(c.reachX, c.reachY);
  double sum = 0;
  int count = 0;
  for (int v = -kLatticeSteps; v <= kLatticeSteps; ++v)
    for (int u = -kLatticeSteps; u <= kLatticeSteps; ++u) {
      const vec2 step = vec2(u, v) + shift;
      const vec2 at = step.x * lattice.a + step.y * lattice.b;
      if (step == vec2(0) || glm::any(glm::greaterThan(glm::abs(at), reach - 1.5f))) continue;
      const ivec2 lag(glm::round(at));
      float most = -1;
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) most = std::max(most, c.at(lag.x + x, lag.y + y));
      sum += most, ++count;
    }
  return count < fewest ? std::numeric_limits<double>::quiet_NaN() : sum / count;
}

double latticeFit(const Autocorrelation& c, std::vector<Repeat> repeats, Monitor& monitor) {
  const auto stronger = [](const Repeat& a, const Repeat& b) { return a.value > b.value; };
  std::stable_sort(repeats.begin(), repeats.end(), stronger);
  repeats.resize(std::min(repeats.size(), kMostRepeats));
  double best = 0;
  for (std::size_t i = 0; i < repeats.size(); ++i) {
    monitor.checkpoint();
    for (std::size_t j = i + 1; j < repeats.size(); ++j) {
      const Lattice lattice{repeats[i].lag, repeats[j].lag};
      if (!crosses(lattice.a, lattice.b)) continue;
      double fit = meanAt(c, lattice, vec2(0), kFewestSteps);
      for (const vec2 half : {vec2(0.5f, 0), vec2(0, 0.5f), vec2(0.5f)})
        fit -= meanAt(c, lattice, half, 1) / 3;
      if (fit > best) best = fit;  // false for no number
    }
  }
  return best;
}

void measureRepeats(const Autocorrelation& c, SwatchAnalysis& out, Monitor& monitor) {
  const std::vector<Repeat> repeats = repeatsOf(c, out.feature);
  Repeat first, second;
  for (const Repeat& r : repeats)
    if (r.value > first.value) first = r;
  for (const Repeat& r : repeats)
    if (r.value > second.value && crosses(first.lag, r.lag)) second = r;
  out.regularity = first.value;
  out.period = first.lag;
  out.lattice = second.value;
  out.latticeFit = latticeFit(c, repeats, monitor);
}

// A turn shows where it shows at either size.
void measureTurns(const Swatch& swatch, SwatchAnalysis& out, Monitor& monitor) {
  const double most = std::max(1.0, std::min(swatch.width, swatch.height) / kStepsAcross);
  const auto step = [&](double features, double largest) {
    return std::clamp(features * out.feature, 1.0, std::min(largest, most));
  };
  const double fineStep = step(kFineStep, kLargestFine);
  const double coarseStep = step(kCoarseStep, kLargestCoarse);
  const SelfMatch fine = selfMatch(swatch, fineStep, monitor);
  const SelfMatch coarse = coarseStep > fineStep ? selfMatch(swatch, coarseStep, monitor) : fine;
  out.turned = {.half = std::max(fine.half, coarse.half),
                .quarter = std::max(fine.quarter, coarse.quarter),
                .eighth = std::max(fine.eighth, coarse.eighth)};
}

}  // namespace

std::string_view patternName(PatternKind kind) {
  switch (kind) {
    case PatternKind::Isotropic:
      return "isotropic";
    case PatternKind::Directional:
      return "directional";
    case PatternKind::Regular:
      return "regular";
  }
  return {};
}

bool SwatchAnalysis::turnShows() const {
  return std::max({turned.half, turned.quarter, turned.eighth}) >= kTurnShows;
}

PatternKind SwatchAnalysis::kind() const {
  if (!turnShows())
    return latticeFit >= kLatticeGoesOn ? PatternKind::Regular : PatternKind::Isotropic;
  return lattice >= kLattice ? PatternKind::Regular : PatternKind::Directional;
}

int SwatchAnalysis::folds() const {
  if (kind() == PatternKind::Isotropic) return 0;
  if (turned.half >= kTurnShows) return 1;
  // Rows that no piece shows: they have a direction for all that.
  if (!turnShows()) return 2;
  return turned.quarter >= kQuarterShows ? 2 : 4;
}

SwatchAnalysis analyse(const Swatch& swatch, Monitor& monitor) {
  const int factor = std::max(
      1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(swatch.pixels())) / kSide)));
  const Swatch small = reduced(swatch, factor, monitor);
  SwatchAnalysis out{.tileable = swatch.tileable,
                     .area = static_cast<double>(swatch.pixels()),
                     .contrast = swatchContrast(swatch)};
  measureAnisotropy(small, out);
  const Autocorrelation correlation = autocorrelation(small, monitor);
  out.feature = featureSize(radialMean(correlation));
  measureRepeats(correlation, out, monitor);
  measureTurns(small, out, monitor);
  out.feature *= factor;
  out.period *= factor;
  return out;
}

}  // namespace dapple
