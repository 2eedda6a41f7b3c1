// Lays pieces of the swatch over clusters of points, large ones where they fit what lies around
// them and smaller ones where not ([Soler]).
#pragma once

#include "base/monitor.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

struct MappingOptions {
  float threshold = 0.7f;        // largest difference along a cluster's border, of the contrast
  float followThreshold = 0.9f;  // the same where clusters follow directions
  float band = 8;                // width of the border that is compared, pixels
  std::uint64_t seed = 1;
};

struct MappingStatistics {
  std::size_t clusters = 0;      // laid into the swatch, and ids in map.patch
  std::size_t flattened = 0;     // charts made for that
  std::size_t forcedPoints = 0;  // in clusters too small to be cut further
  // Root mean square colour difference per channel along all borders, over the swatch's contrast.
  double matchedError = 0;  // at the best places
  double borderError = 0;   // after relaxation; never more
};

// Colours every point that is not kept, and fits what it lays out to those that are. Writes all
// columns but blends: patch is the cluster's, its points lie at domain, which is turned and relaxed
// already, error is its border's difference (0..1), state = Matched. No texel is outside a swatch
// that does not tile. The same bytes at any number of threads. Throws Cancelled; then `map` is good
// for nothing.
MappingStatistics mapPattern(const SynthesisInput& input, const MappingOptions& options,
                             SourceMap& map, Monitor& monitor);

}  // namespace dapple
