// Mends the seams of a synthesis, whatever made it: where the places of neighbours in the swatch do
// not continue each other, coordinates are relaxed in a band (methods: sections 4, 5 and 6).
#pragma once

#include "base/monitor.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

// The level of the swatch's stack that points `spacing` apart show when its pixels are `unit` wide.
using LevelRule = float (*)(float spacing, float unit);

struct RepairOptions {
  float width = 3;            // pixels to both sides of a seam, [0, 64]
  int levels = 2;             // that places are relaxed on, [1, 8]
  int passes = 1;             // over the finest, at least 1; coarser ones get more
  LevelRule level = nullptr;  // that colours are read at; null: of the swatch itself
};

struct RepairStatistics {
  std::size_t seams = 0;  // points that a neighbour does not continue, or that are blended
  std::size_t open = 0;   // points of the bands
  std::size_t moved = 0;  // of them, those with another place
};

// Writes texel and colour of points in the bands, level where the map has any, patch and domain
// where the map has placements: those of a neighbour that the point continues now. Blends there
// end. Kept points and all others stay as they are, and so do frames and states. `map`: every point
// has its texel, inside the swatch, and frame. The same bytes at any number of threads. Counts
// every point once. Throws InvalidInput (options out of range), Cancelled; then the map is as it
// was.
RepairStatistics repairSeams(const SynthesisInput& input, const RepairOptions& options,
                             SourceMap& map, Monitor& monitor);

}  // namespace dapple
