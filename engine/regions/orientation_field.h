// Directions for the swatch to follow, everywhere on the surface, from what a user drew.
#pragma once

#include <span>
#include <vector>

#include "regions/field_options.h"
#include "regions/strokes.h"

namespace dapple {

struct OrientationField {
  std::vector<TangentFrame> frames;  // n; t is the direction, the swatch's top
  std::vector<float> scale;          // n, times the region's; empty: 1 everywhere
};

// Smooth, Spread and Diffuse take the strokes' directions exactly along them (their weighted sum
// where several run over one point) and their scales; strokes without one count as 1. Of an N-fold
// field the frames hold one of the N directions, chosen so that neighbours agree wherever the
// surface allows it; at the first stroke of a part the drawn one. The same bytes on any number of
// threads. Without neighbourhoods (k = 0) as FieldMethod::Up. Throws InvalidInput for a stroke that
// validate() refuses, Cancelled.
OrientationField orientPoints(const PointSet& points, const Neighborhoods& neighborhoods,
                              std::span<const Stroke> strokes, const FieldOptions& options,
                              Monitor& monitor);

}  // namespace dapple
