// The key to a heat map, drawn into its picture.
#pragma once

#include "app/render/views.h"
#include "swatch/image.h"

namespace dapple {

// A bar of heatColour() with the numbers of its ends, in the lower left corner, larger in larger
// pictures. Left out of pictures too small for it (less than about 100 x 40 pixels).
void drawLegend(Image& picture, const HeatRange& range);

}  // namespace dapple
