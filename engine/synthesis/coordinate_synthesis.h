// Coarse-to-fine synthesis of coordinates: every point holds a place of the swatch, and takes that
// of a neighbour's continuation which fits all of them best (methods: 3.4).
#pragma once

#include "base/monitor.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

struct CoordinateOptions {
  int levels = 0;   // 0: as many as the swatch asks for
  int quality = 1;  // passes over the finest level
  std::uint64_t seed = 1;
};

// Colours every point of `map` that is not kept. Writes texel, frame, colour, state = Matched,
// patch = kNone, error and order (the level on which a point was first placed, coarsest 0). Where
// nothing is kept the map need not have columns before: without them the search has more memory to
// itself. The same bytes at any number of threads. Throws Cancelled; then the map is as it was.
void synthesizeCoordinates(const SynthesisInput& input, const CoordinateOptions& options,
                           SourceMap& map, Monitor& monitor);

}  // namespace dapple
