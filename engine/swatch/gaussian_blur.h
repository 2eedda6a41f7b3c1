// A true (not iterated, not recursive) Gaussian over a swatch.
#pragma once

#include <vector>

#include "swatch/swatch.h"

namespace dapple {

// level 0 of `swatch` blurred by `sigma` > 0 pixels, w x h: wrapped when it tiles; else what lies
// beyond the border or is transparent carries no weight (normalised convolution). Transparent
// texels hold the blurred colour of the nearest opaque one. The kernel ends at 3.5 sigma.
std::vector<vec3> blurSwatch(const Swatch& swatch, double sigma);

// Gives every transparent texel (opaque = 0) the colour of the nearest opaque one, in pixels
// centre to centre; ties go to the smaller column, then the smaller row. At least one must be
// opaque.
void fillHoles(const Swatch& swatch, std::vector<vec3>& colours);

}  // namespace dapple
