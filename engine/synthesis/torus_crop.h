// A part of a swatch that repeats without a seam: nearly all of it is the swatch as it is, and only
// where its sides meet is it synthesized.
#pragma once

#include "synthesis/coordinate_grid.h"

namespace dapple {

struct TorusCrop {
  int x = 0, y = 0;           // of its top left pixel in the swatch
  int width = 0, height = 0;  // pixels
};

// The part of a swatch whose opposite sides look most alike, by colour over some pixels to both
// sides of them; of parts that are equally good the larger. The whole of a swatch that is too small
// to choose from. At least half of each side. Throws Cancelled.
TorusCrop bestTorusCrop(const Swatch& swatch, const Monitor& monitor);

// The place that each pixel of the part shows once its sides meet (width x height, top row first):
// its own, but for a band along the sides that is relaxed. Of a swatch without holes. The same at
// any number of threads. Throws Cancelled.
std::vector<Place> closedTorus(const Swatch& swatch, const TorusCrop& crop, int quality,
                               Monitor& monitor);

}  // namespace dapple
