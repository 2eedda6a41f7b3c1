// Decides through which points the borders between overlapping patches run.
#pragma once

#include "base/monitor.h"
#include "synthesis/patch_overlap.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

struct SeamStatistics {
  // Sum over pairs of neighbours that are laid out incoherently of the colour difference of both
  // layouts at both points, and a little for distortion; 0..1 per colour channel.
  double energyBefore = 0;   // every point in the nearest patch
  double energyAfter = 0;    // never more
  std::size_t moves = 0;     // sheets that were cut
  std::size_t changed = 0;   // points that are not in the nearest patch
  std::size_t stranded = 0;  // gap points that no patch reaches: they copy a neighbour
};

// Gives every point with several candidates one of them, so that colours change little where the
// layout jumps: a minimum cut for one local sheet of candidates after the other, as long as the
// energy falls. Writes texel, patch, domain, frame, error and colour; states stay. Candidates
// outside a swatch that does not tile, or on transparent texels, are not used. Counts every point
// once. The same bytes at any number of threads. Throws Cancelled; then the map is as it was.
SeamStatistics cutSeams(const SynthesisInput& input, const PatchOverlap& overlap, SourceMap& map,
                        Monitor& monitor);

}  // namespace dapple
