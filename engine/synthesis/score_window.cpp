#include "synthesis/score_window.h"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

// A point reaches the two nodes on either side of it along each axis; the third is at least two
// steps, four sigmas, away. So the grid needs a rim of three nodes that nobody reads.
constexpr int kRim = 3;
constexpr int kPaddedSide = kWindowSide + 2 * kRim;
// A node is covered when its weights add up to at least that of one point 1.6 steps away, and,
// where points are many, to no less than chance leaves: for points at random the sum has a variance
// of half its mean.
const float kLeastWeight = std::exp(-2 * 1.6f * 1.6f);
constexpr float kChance = 3;  // standard deviations

// Gaussian of half a step at the four nodes from `first` on, seen from x (both in steps): with
// x - first = d, exp(-2 (d - i)^2) = exp(-2 d^2) exp(4 d)^i exp(-2 i^2).
Float4 fourWeights(float x, float first) {
  constexpr float k1 = 0.1353352832f, k2 = 3.354626279e-4f, k3 = 1.522997974e-8f;
  const float d = x - first;
  const float power = std::exp(4 * d), square = power * power;
  return std::exp(-2 * d * d) * Float4{1, k1 * power, k2 * square, k3 * (square * power)};
}

int paddedIndex(int row, int column) {
  return (row + kRim) * kPaddedSide + column + kRim;
}

}  // namespace

float windowDistance(const Window& a, const Window& b) {
  Float4 sum{};
  for (int i = 0; i < kWindowNodes; ++i) {
    const Float4 d = a.node[i] - b.node[i];
    sum += d * d;
  }
  return std::sqrt((sum[0] + sum[1] + sum[2]) / kWindowNumbers);
}

float windowDetail(const Window& window) {
  Float4 sum{};
  for (int i = 0; i < kWindowNodes; ++i) {
    const bool last = i % kWindowSide == kWindowSide - 1;
    const Float4 across = last ? Float4{} : window.node[i + 1] - window.node[i];
    const Float4 along =
        i + kWindowSide < kWindowNodes ? window.node[i + kWindowSide] - window.node[i] : Float4{};
    sum += across * across + along * along;
  }
  return sumOf(sum);
}

void WindowSampler::place(std::span<const FlatPoint> points, float step, float turn) {
  const float cosine = std::cos(turn), sine = std::sin(turn), perStep = 1 / step;
  samples_.clear();
  weights_.clear();
  std::array<Float4, kPaddedSide * kPaddedSide> total{};
  // Beyond this no node is reached; the square root of two allows for the turn.
  const float far = step * (kWindowReach + 2) * std::sqrt(2.0f);
  for (const FlatPoint& point : points) {
    if (std::abs(point.position.x) > far || std::abs(point.position.y) > far) continue;
    const vec2 p(cosine * point.position.x + sine * point.position.y,
                 cosine * point.position.y - sine * point.position.x);
    const vec2 grid = p * perStep + kWindowReach;
    const vec2 first = glm::floor(grid) - 1.0f;
    if (!(first.x >= -kRim && first.x < kWindowSide && first.y >= -kRim && first.y < kWindowSide))
      continue;
    const Float4 row = fourWeights(grid.y, first.y);
    const Weights weights{paddedIndex(static_cast<int>(first.y), static_cast<int>(first.x)),
                          fourWeights(grid.x, first.x),
                          {row[0], row[1], row[2], row[3]}};
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c)
        total[weights.corner + r * kPaddedSide + c][0] += weights.row[r] * weights.column[c];
    samples_.push_back({point.id, p});
    weights_.push_back(weights);
  }
  float sum = 0;
  for (int node = 0; node < kWindowNodes; ++node) {
    total_[node] = total[paddedIndex(node / kWindowSide, node % kWindowSide)][0];
    sum += total_[node];
  }
  const float mean = sum / kWindowNodes;
  const float least = std::max(kLeastWeight, mean - kChance * std::sqrt(0.5f * mean));
  complete_ = *std::min_element(total_.begin(), total_.end()) >= least;
}

Window WindowSampler::window(std::span<const Float4> colours) const {
  std::array<Float4, kPaddedSide * kPaddedSide> sum{};
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const Weights& weights = weights_[i];
    Float4* corner = sum.data() + weights.corner;
    for (int r = 0; r < 4; ++r) {
      const Float4 colour = colours[i] * weights.row[r];
      for (int c = 0; c < 4; ++c) corner[r * kPaddedSide + c] += colour * weights.column[c];
    }
  }
  Window window;
  for (int row = 0; row < kWindowSide; ++row)
    for (int column = 0; column < kWindowSide; ++column) {
      const int node = row * kWindowSide + column;
      window.node[node] = sum[paddedIndex(row, column)] / total_[node];
    }
  return window;
}

}  // namespace dapple
