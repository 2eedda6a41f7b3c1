// [Lai] Geometric Texture Synthesis and Transfer via Geometry Images, section 4.3.
//
// Departure: the paper starts from the strokes' directions spread to the nearest faces; here points
// start with none and take one as soon as a neighbour has it.
#include "regions/diffused_field.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr float kStep = 0.1f;
constexpr int kMostSteps = 20000;
constexpr float kStill = 1.7e-5f;  // chord of a thousandth of a degree, in a step

}  // namespace

std::vector<vec2> diffusedDirections(const FieldLevels& field,
                                     const std::vector<Fixed<vec2>>& fixed, Monitor& monitor) {
  DAPPLE_CHECK(field.levels.size(), ==, 1u);
  const FieldLevel& level = field.levels[0];
  const std::size_t n = level.size();
  std::vector<Index> nodes;
  for (const Fixed<vec2>& f : fixed) nodes.push_back(f.node);
  const auto pulled = freeParts(field, nodes);
  std::vector<std::uint8_t> isFixed(n, 0);
  for (const Index i : nodes) isFixed[i] = 1;
  std::vector<vec2> now(n, vec2(0)), next(n);
  for (const Fixed<vec2>& f : fixed) now[f.node] = f.value;
  const Relaxation<vec2> mean{.level = level, .order = {}, .pulled = pulled[0], .step = kStep};
  std::vector<float> most((n + 4095) / 4096);
  for (int step = 0; step < kMostSteps; ++step) {
    parallelFor(monitor, n, 4096, [&](std::size_t begin, std::size_t end) {
      float& turned = most[begin / 4096] = 0;
      for (std::size_t i = begin; i < end; ++i) {
        next[i] = now[i];
        if (isFixed[i]) continue;
        next[i] = relaxed(mean, static_cast<Index>(i), now);
        turned = std::max(turned, glm::length(next[i] - now[i]));
      }
    });
    now.swap(next);
    if (*std::max_element(most.begin(), most.end()) < kStill) break;
  }
  for (vec2& direction : now)
    if (direction == vec2(0)) direction = vec2(1, 0);
  return now;
}

}  // namespace dapple
