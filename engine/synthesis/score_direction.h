// Whether a pattern runs where it should: the direction in which colours change most, in windows
// turned as the swatch should lie, beside that of the whole swatch.
#pragma once

#include <optional>
#include <span>

#include "synthesis/score_window.h"
#include "synthesis/texture_score.h"

namespace dapple {

// The structure tensor of a window: sums of products of the brightness's differences along its rows
// (x) and columns (y).
struct StructureTensor {
  float xx = 0, xy = 0, yy = 0;
};
StructureTensor structureTensor(const Window& window);

// `perfect`: windows of the swatch as it should lie. None when the swatch has no direction, or when
// fewer than 20 windows have one.
std::optional<DirectionError> directionError(std::span<const StructureTensor> actual,
                                             std::span<const StructureTensor> perfect);

}  // namespace dapple
