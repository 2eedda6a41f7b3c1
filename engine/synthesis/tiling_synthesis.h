// Repeats a swatch that tiles over a surface without a seam: by a phase field, and where that is
// stretched too much, by coordinate synthesis (methods: section 9, item 10). Where most is
// stretched, as on a surface that hardly holds the swatch twice, there is nothing to repeat, and
// all of it is. Of a swatch that does not tile the part that comes nearest to it is closed to one
// that does.
#pragma once

#include "base/monitor.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

struct TilingOptions {
  float stretch = 0.18f;  // pixels per pixel: points that are off by more are synthesized
  int starts = 3;         // of the phase field, of which the smoothest is taken
  std::uint64_t seed = 1;
};

// Colours every point of `map`. Writes texel, frame, colour, state = Matched, patch, order and
// error: by how much the phase field is stretched, pixels per pixel. The same bytes at any number
// of threads. Throws InvalidInput when the swatch does not tile and has nothing to be read between
// texels; Cancelled. Then the map is as it was.
void synthesizeTiling(const SynthesisInput& input, const TilingOptions& options, SourceMap& map,
                      Monitor& monitor);

}  // namespace dapple
