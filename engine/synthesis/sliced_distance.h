// How unlike two clouds of vectors are as wholes.
#pragma once

#include <span>

#include "synthesis/score_patches.h"

namespace dapple {

// Sliced Wasserstein distance: the mean over 48 seeded directions of the 1-D earth mover's distance
// between the projections, over the mean standard deviation of the projected `reference`. 0 when
// either is empty, and when neither varies and both agree.
double slicedDistance(std::span<const PatchCode> codes, std::span<const PatchCode> reference,
                      std::uint64_t seed);

}  // namespace dapple
