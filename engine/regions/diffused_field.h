// Directions that diffuse from the strokes on one level.
#pragma once

#include "regions/field_levels.h"
#include "regions/field_relaxation.h"

namespace dapple {

// N-th powers of unit length (n) by explicit diffusion over the last of `field`'s levels, which is
// the points themselves ([Lai] 4.3: t = 0.1), until none turns by more than a thousandth of a
// degree in a step, at most 20,000 steps. The energy is that of SmoothField. Throws Cancelled.
std::vector<vec2> diffusedDirections(const FieldLevels& field,
                                     const std::vector<Fixed<vec2>>& fixed, Monitor& monitor);

}  // namespace dapple
