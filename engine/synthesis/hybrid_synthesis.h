// Patches first, then what lies between them ([Zhang] section 5).
#pragma once

#include "base/monitor.h"
#include "synthesis/neighborhood_matching.h"
#include "synthesis/patch_parameterization.h"
#include "synthesis/seam_cut.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"
#include "synthesis/texture_options.h"

namespace dapple {

struct HybridOptions {
  PatchOptions patches;
  GapFill gaps = GapFill::Cut;
  bool expand = false;       // Match: patch points next to a gap become gap first
  MatchingOptions matching;  // Match
  float overlap = 8;         // Cut: pixels that patches grow over each other, [0, 64]
};

struct HybridStatistics {
  PatchStatistics patches;
  std::size_t expanded = 0;  // patch points that became gap
  MatchingStatistics matching;
  std::size_t movedPatches = 0;  // by alignment with their neighbours
  SeamStatistics seams;
};

// How often synthesizeHybrid() counts every point (Match: gap points only, after the first time).
std::size_t hybridPasses(GapFill gaps);

// Writes every column of `map` for every point. States: Patch; Match: Matched for gap points; Cut:
// Gap for points that growth left, whichever patch they now belong to. Throws InvalidInput (options
// out of range), Cancelled.
HybridStatistics synthesizeHybrid(const SynthesisInput& input, const HybridOptions& options,
                                  SourceMap& map, Monitor& monitor);

}  // namespace dapple
