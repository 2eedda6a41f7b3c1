#include "synthesis/score_direction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace dapple {
namespace {

constexpr float kLeastCoherence = 0.4f;   // of a window that has a direction: (a - b) / (a + b) of
                                          // the tensor's eigenvalues
constexpr double kLeastAnisotropy = 0.3;  // of a swatch that has one: of its windows, all together
constexpr double kLeastShare = 0.1;       // of the mean change: less is next to flat
constexpr std::size_t kLeastWindows = 20;

float brightness(const Float4& colour) {
  return (colour[0] + colour[1] + colour[2]) / 3;
}

// The angle of most change counts the same turned by half: twice it, as a vector.
struct Doubled {
  double x = 0, y = 0;
  double length() const { return std::hypot(x, y); }
};
Doubled doubled(const StructureTensor& t) {
  return {double{t.xx} - double{t.yy}, 2 * double{t.xy}};
}
double changeOf(const StructureTensor& t) {
  return double{t.xx} + double{t.yy};
}

// Degrees between the directions of windows that have one and `towards`.
std::vector<double> errors(std::span<const StructureTensor> tensors, const Doubled& towards) {
  double mean = 0;
  for (const StructureTensor& t : tensors)
    mean += changeOf(t) / static_cast<double>(tensors.size());
  std::vector<double> out;
  for (const StructureTensor& t : tensors) {
    const Doubled d = doubled(t);
    if (!(changeOf(t) > kLeastShare * mean) || !(d.length() > kLeastCoherence * changeOf(t)))
      continue;
    const double apart =
        std::atan2(d.x * towards.y - d.y * towards.x, d.x * towards.x + d.y * towards.y);
    out.push_back(std::abs(apart) / 2 * 180 / std::numbers::pi);
  }
  return out;
}

double quantile(std::vector<double>& values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace

// Differences between the sides of each square of four nodes: both lie in its middle.
StructureTensor structureTensor(const Window& window) {
  StructureTensor tensor;
  for (int row = 0; row + 1 < kWindowSide; ++row)
    for (int column = 0; column + 1 < kWindowSide; ++column) {
      const auto at = [&](int dx, int dy) {
        return brightness(
            window.node[static_cast<std::size_t>((row + dy) * kWindowSide + column + dx)]);
      };
      const float a = at(0, 0), b = at(1, 0), c = at(0, 1), d = at(1, 1);
      const float x = (b - a) + (d - c), y = (c - a) + (d - b);
      tensor.xx += x * x, tensor.xy += x * y, tensor.yy += y * y;
    }
  return tensor;
}

std::optional<DirectionError> directionError(std::span<const StructureTensor> actual,
                                             std::span<const StructureTensor> perfect) {
  Doubled towards;
  double change = 0;
  for (const StructureTensor& t : perfect) {
    towards.x += doubled(t).x, towards.y += doubled(t).y;
    change += changeOf(t);
  }
  if (!(towards.length() > kLeastAnisotropy * change)) return std::nullopt;
  std::vector<double> found = errors(actual, towards), best = errors(perfect, towards);
  if (found.size() < kLeastWindows || best.size() < kLeastWindows) return std::nullopt;
  return DirectionError{quantile(found, 0.5), quantile(found, 0.95), quantile(best, 0.5),
                        quantile(best, 0.95)};
}

}  // namespace dapple
