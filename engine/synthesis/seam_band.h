// Matches the points along the seams of a cut once more.
#pragma once

#include "base/monitor.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

struct BandOptions {
  float width = 3;  // pixels to both sides of a seam
  int passes = 4;
  std::uint64_t seed = 1;
};

// In the band each point takes, of its own layout and those that continue its neighbours', the one
// whose surroundings look most like what the neighbours show. Writes patch, domain, texel, frame,
// error and colour; points outside the band stay as they are. `map` as cutSeams() leaves it.
// Returns the number of points changed. The same bytes at any number of threads. Throws Cancelled;
// then the map is as it was.
std::size_t matchBand(const SynthesisInput& input, const BandOptions& options, SourceMap& map,
                      Monitor& monitor);

}  // namespace dapple
