// Flattens a point set into patches of bounded distortion, one neighbour after the other ([Zhang]
// section 3 and Appendix A), and colours what could not be flattened by blending.
#pragma once

#include <vector>

#include "base/monitor.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

struct PatchOptions {
  float distortion =
      1.6f;  // threshold of D = 3 D_ori + 2 D_pos, [0, inf]; 1.6 is about +-15 % stretch
  float sizeLimit = 0.8f;  // (0, 1]: largest share of the swatch's width and height that a patch
                           // covers; not used for a tileable swatch, whose patches are unlimited
  bool smooth = true;      // flatten smoothed positions (real scans fail without)
  std::uint64_t seed = 1;
};

struct PatchStatistics {
  std::size_t patches = 0;
  std::size_t gapPoints = 0;
  double meanDistortion = 0, maxDistortion = 0;  // of D over patch points
};

// Grows patches until no point is free, and lays each into the swatch: anywhere for a tileable one,
// else at a random place inside. Writes domain (pixels, the patch's seed at 0), texel, frame,
// patch, state (Patch or Gap), error (D), order and colour of patch points; gap points have no
// colour yet. Throws InvalidInput (options out of range), Cancelled.
PatchStatistics growPatches(const SynthesisInput& input, const PatchOptions& options,
                            SourceMap& map, Monitor& monitor);

// Colours the gap points of growPatches() from their neighbours' patches by alpha blending, in the
// queue's order ([Zhang] section 3.3); each keeps its blend in the map and joins its dominant
// patch.
void blendGaps(const SynthesisInput& input, SourceMap& map, Monitor& monitor);

}  // namespace dapple
