// What to synthesize again after an edit, when the user wants to see every change at once.
#pragma once

#include <vector>

#include "document/document.h"

namespace dapple {

// Regions whose result would be another one now: their swatch, options, strokes or direction have
// changed, or they have points that were not theirs. Points that they lost do not count: the others
// stay as they are. Empty when `after` is of another scan. Ascending.
std::vector<RegionId> touchedRegions(const Document& before, const Document& after);

// The borders between regions are others now (BlendBorders): their kinds, widths, locks or places
// have changed.
bool bordersTouched(const Document& before, const Document& after);

// It can be synthesized: it has points and a swatch, and is not locked.
bool canSynthesize(const Document& document, RegionId region);

}  // namespace dapple
