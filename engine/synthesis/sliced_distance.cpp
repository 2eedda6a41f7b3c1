#include "synthesis/sliced_distance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/hash_rng.h"

namespace dapple {
namespace {

constexpr int kDirections = 48;

PatchCode randomDirection(std::uint64_t seed, std::uint64_t number) {
  PatchCode direction;
  double squares = 0;
  for (int d = 0; d < kPatchNumbers; ++d) {  // Box-Muller
    const double radius = std::sqrt(-2 * std::log(1 - hashUniform(seed, number, d, 0)));
    const double value = radius * std::cos(2 * std::numbers::pi * hashUniform(seed, number, d, 1));
    direction[d] = static_cast<float>(value);
    squares += value * value;
  }
  for (float& value : direction) value /= static_cast<float>(std::sqrt(squares));
  return direction;
}

std::vector<float> sortedProjections(std::span<const PatchCode> codes, const PatchCode& direction) {
  std::vector<float> projected;
  projected.reserve(codes.size());
  for (const PatchCode& code : codes) {
    float sum = 0;
    for (int d = 0; d < kPatchNumbers; ++d) sum += code[d] * direction[d];
    projected.push_back(sum);
  }
  std::sort(projected.begin(), projected.end());
  return projected;
}

// Integral over q in [0, 1] of the difference of the two quantile functions.
double earthMover(const std::vector<float>& a, const std::vector<float>& b) {
  const double n = static_cast<double>(a.size()), m = static_cast<double>(b.size());
  double sum = 0, reached = 0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const double endA = static_cast<double>(i + 1) / n, endB = static_cast<double>(j + 1) / m;
    const double end = std::min(endA, endB);
    sum += (end - reached) * std::abs(static_cast<double>(a[i]) - b[j]);
    reached = end;
    if (endA <= end) ++i;
    if (endB <= end) ++j;
  }
  return sum;
}

double deviation(const std::vector<float>& values) {
  double sum = 0, squares = 0;
  for (float value : values) sum += value;
  const double mean = sum / static_cast<double>(values.size());
  for (float value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

double slicedDistance(std::span<const PatchCode> codes, std::span<const PatchCode> reference,
                      std::uint64_t seed) {
  if (codes.empty() || reference.empty()) return 0;
  double moved = 0, spread = 0;
  for (int i = 0; i < kDirections; ++i) {
    const PatchCode direction = randomDirection(seed, i);
    const std::vector<float> a = sortedProjections(codes, direction);
    const std::vector<float> b = sortedProjections(reference, direction);
    moved += earthMover(a, b);
    spread += deviation(b);
  }
  return moved > 0 ? moved / std::max(spread, 1e-12) : 0;
}

}  // namespace dapple
