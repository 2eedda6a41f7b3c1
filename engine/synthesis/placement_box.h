// Keeping what is laid into a swatch that does not tile inside of it, whatever a search would like.
#pragma once

#include <vector>

#include "swatch/swatch.h"
#include "swatch/swatch_search.h"

namespace dapple {

// What must stay inside, in the flattened domain that is to be placed, pixels.
struct PlacementBox {
  vec2 low{0}, high{0};
};

// The box and, where the swatch has room, a margin of up to 3 pixels that is needed beyond it.
PlacementBox roomyBox(const Swatch& swatch, const PlacementBox& box);

// Drops terms outside of the roomy box and adds its corners, so that a search keeps the box inside.
// At least `most` of the others stay, some of them more than once, so that the corners, whose
// colour means nothing, do not count for much. Leaves no term when all lie outside.
void keepInside(const Swatch& swatch, const PlacementBox& box, std::size_t most,
                std::vector<SearchTerm>& terms);

// The nearest placement of the domain's 0 that has the box inside: rounding in a search may leave a
// corner outside by a fraction of a pixel. Any that tiles does.
vec2 clampedPlacement(const Swatch& swatch, const PlacementBox& box, vec2 placement);

}  // namespace dapple
