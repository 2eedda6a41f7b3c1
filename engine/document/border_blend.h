// Region borders: how the patterns of two regions meet, each carried on over the points of the
// other (synthesis/texture_extension.h).
//
// Hard: each point shows its own region's pattern. Blend: near the border both are mixed; the
// weight of the other side is smoothstep of the distance to the border along the surface, 0 half a
// width inside, 1/2 on the border, and then sharpened so that contrast is kept (border_weights.h).
// Cut: in the same band each point shows one of them, parted by a minimum cut along the features of
// both (synthesis/pattern_cut.h); the band's rims are each side's own.
//
// Of two kinds blend counts before hard, and hard before cut: what departs from the default shows.
// Of two widths of the kind that counts the wider does. Where both a blend and a cut reach a point,
// the pattern that the cut leaves there is mixed.
//
// A border is made where both regions have results of their own (not stopped ones, and with their
// swatches at hand). The points of a locked region stay as they are; then the whole width lies in
// the neighbour: a blend has all of the locked pattern's weight on the border, a cut runs anywhere
// from there to the far rim.
//
// Nothing is synthesized: a border follows from the results on both its sides. So the points' own
// texels are those without a border, and after the synthesis of one region the borders of its
// neighbours with it are of the newest results, too.
#pragma once

#include "document/document.h"

namespace dapple {

// Both ask for the same borders, labels and results aside.
bool asksForSameBorder(const Region& a, const Region& b);

// The document's results with all borders as its regions now ask for. Entries of Results'
// border at points of locked regions, and what came of a swatch that is not at hand, stay. The same
// bytes at any number of threads. Throws Cancelled.
Results blendBorders(const Document& document, Monitor& monitor);

// The results without what sources of no points any more gave to the borders of unlocked regions:
// the other terms take their weight. For ClearResult.
Results withoutLostTerms(const Document& document);

}  // namespace dapple
