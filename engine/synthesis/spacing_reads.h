// How far points blur the swatch that they are to show.
#pragma once

#include "base/monitor.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

// The level of the swatch's stack whose pixels are as wide as points are apart, on the mean.
int meanReadLevel(const SynthesisInput& input);

// Points wider apart than pixels show the mean of the pixels between them: the colours of all that
// are not kept. Throws Cancelled.
void readBySpacing(const SynthesisInput& input, SourceMap& map, Monitor& monitor);

}  // namespace dapple
