// Region borders that blend: near a border, points mix their own colour with the pattern of the
// region beyond, carried on over them (synthesis/texture_extension.h).
//
// A border is blended where both regions have results of their own (not stopped ones, and with
// their swatches at hand) and one has a width; of two widths the wider counts. The weight of the
// other side is smoothstep of the distance to the border along the surface: 0 half a width inside,
// 1/2 on the border. The points of a locked region stay as they are; then its pattern has all its
// weight on the border, and the whole width lies in the neighbour.
//
// Nothing is synthesized: a border follows from the results on both its sides. So the points' own
// texels are those without a border, and after the synthesis of one region the borders of its
// neighbours with it are of the newest results, too.
#pragma once

#include "document/document.h"

namespace dapple {

// The document's results with all borders blended as its regions now ask for. Entries of Results'
// border at points of locked regions, and what came of a swatch that is not at hand, stay. The same
// bytes at any number of threads. Throws Cancelled.
Results blendBorders(const Document& document, Monitor& monitor);

// The results without what sources of no points any more gave to the borders of unlocked regions:
// the other terms take their weight. For ClearResult.
Results withoutLostTerms(const Document& document);

}  // namespace dapple
