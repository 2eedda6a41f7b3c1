// Colours points one by one by matching their coloured neighbours with the swatch ([Zhang] section
// 4), exhaustively or coherently, on one level or coarse to fine.
#pragma once

#include <vector>

#include "base/monitor.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

struct MatchingOptions {
  bool coherent = true;  // candidates from the neighbours' texels, kept as real numbers
  int levels = 1;        // [1, 8] of the point hierarchy; fewer are used on a swatch that does not
                         // tile and would be smaller than a neighbourhood
  std::uint64_t seed = 1;
  // Exhaustive search as [Zhang] prints it: whole-pixel places, no coherent candidates, one visit
  // to each point, coarsest level at random. Only to compare: the pattern falls apart.
  bool asPrinted = false;
};

struct MatchingStatistics {
  std::size_t matched = 0;   // points coloured here
  std::size_t searches = 0;  // exhaustive searches run
  double meanError = 0;      // root mean square colour difference per term and channel, 0..1
  int levels = 1;            // used
};

// Colours every point of `map` whose state is Free or Gap; Patch points stay as they are and count
// as coloured. map.frame must hold the axes of every point and map.unit the unit. Writes texel,
// colour, state = Matched, patch = kNone, error, order. The swatch's stack should have as many
// levels as are asked for; its last level stands in for those it lacks. The bytes written are the
// same at any number of threads. Throws Cancelled; then the map is as it was.
MatchingStatistics matchNeighborhoods(const SynthesisInput& input, const MatchingOptions& options,
                                      SourceMap& map, Monitor& monitor);

}  // namespace dapple
