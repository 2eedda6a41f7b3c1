#include "app/render/level_order.h"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

constexpr std::size_t kCoarsest = 8192;  // points
constexpr float kUneven = 1.15f;         // every k-th point along the curve is not a regular grid

}  // namespace

float LevelOrder::enlargement(std::size_t level) const {
  if (level + 1 >= counts.size()) return 1;
  return kUneven * std::sqrt(static_cast<float>(order.size()) / static_cast<float>(counts[level]));
}

LevelOrder levelOrder(std::size_t n) {
  std::size_t step = 1;
  while (n / step > kCoarsest) step *= 2;
  LevelOrder levels;
  levels.order.reserve(n);
  const auto append = [&](std::size_t first, std::size_t every) {
    for (std::size_t i = first; i < n; i += every) levels.order.push_back(static_cast<Index>(i));
    levels.counts.push_back(levels.order.size());
  };
  append(0, step);
  for (; step > 1; step /= 2) append(step / 2, step);
  return levels;
}

}  // namespace dapple
