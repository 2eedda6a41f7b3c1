// Height as a further colour of a swatch, so that what fits in colour alone, but not in height, is
// not taken to fit (methods: section 9, item 8).
#pragma once

#include <span>

#include "swatch/swatch.h"

namespace dapple {

// The swatch with a relief made of `height` (w x h, any range). `weight` >= 0: of differences in
// height, squared, over those of the three colours together, both as their mean over the swatch; so
// neither the range of the heights nor the swatch's contrast matters. No relief when the weight is
// 0 or the heights are all the same. Numbers that are not finite count as the mean.
Swatch withRelief(const Swatch& swatch, std::span<const float> height, double weight);

// A relief that is known, 0..1, w x h: its level 0.
void setRelief(Swatch& swatch, std::vector<float> relief);

// The swatch's relief at level 0 where its colours would be, in all three: for what works on
// colours.
Swatch reliefAsColours(const Swatch& swatch);

}  // namespace dapple
