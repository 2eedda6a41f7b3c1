// The picture that places on a plane show.
#pragma once

#include "swatch/image.h"
#include "synthesis/coordinate_grid.h"

namespace dapple {

// width x height x 3 of `places` (one for each pixel of the grid, top row first): the colours there
// wherever the pixels around copy the same piece of the swatch; where pieces meet, a mixture of how
// each would go on, about two pixels wide. Throws Cancelled.
Image blendedImage(const Swatch& swatch, const CoordinateGrid& grid, std::span<const Place> places,
                   Monitor& monitor);

}  // namespace dapple
