// From the best whole pixel to the best place between pixels.
#pragma once

#include "base/types.h"

namespace dapple {

// Downhill from `place` (pixels) in steps of 1/2, 1/4 and 1/8. errorAt(place, bound) may give any
// value above `bound` when the error exceeds it; `error` is that of `place`, then of the new one.
template <class ErrorAt>
void refinePlace(ErrorAt errorAt, vec2& place, float& error) {
  constexpr vec2 kWays[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  for (float step = 0.5f; step >= 0.125f; step *= 0.5f) {
    const vec2 centre = place;
    for (const vec2& way : kWays) {
      const vec2 moved = centre + way * step;
      const float there = errorAt(moved, error);
      if (there < error) {
        error = there;
        place = moved;
      }
    }
  }
}

}  // namespace dapple
