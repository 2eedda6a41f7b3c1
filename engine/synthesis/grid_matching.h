// Colours points by comparing the square around each with the whole swatch, in the order of their
// distance from a start ([Zeng]); one match may colour one point or all that is open in its square.
#pragma once

#include "base/monitor.h"
#include "synthesis/seam_cut.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"
#include "synthesis/texture_options.h"

namespace dapple {

struct GridOptions {
  int size = 21;  // N: swatch pixels along each side of the square; odd, [3, 31]
  GridAssign assign = GridAssign::Multi;
  bool coherent = true;  // prefer places that continue what the square shows already
  bool seams = true;     // Multi: cut the squares where they differ least
  int neighbours = 0;    // most points that a square is filled from, [0, 4096]; 0: all it covers
  std::uint64_t seed = 1;
};

struct GridStatistics {
  std::size_t matches = 0;  // squares compared with the swatch, and ids in map.patch
  double meanError = 0;     // root mean square colour difference per term and channel, 0..1
  SeamStatistics seams;
};

// How often matchGrid() counts every point.
std::size_t gridPasses(const GridOptions& options);

// Colours every point. Writes all columns but blends: patch is the match that a point comes from,
// domain its offset from the centre of that match's square, placement where the centre lies; state
// = Matched. `input.starts` are coloured first. No texel is outside a swatch that does not tile.
// The bytes written are the same at any number of threads. Throws InvalidInput (options out of
// range), Cancelled; then `map` is good for nothing.
GridStatistics matchGrid(const SynthesisInput& input, const GridOptions& options, SourceMap& map,
                         Monitor& monitor);

}  // namespace dapple
