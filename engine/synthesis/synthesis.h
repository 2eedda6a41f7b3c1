// One door to all methods: whatever colours a region comes in here and leaves a source map.
#pragma once

#include "base/monitor.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"
#include "synthesis/texture_options.h"

namespace dapple {

struct SynthesisStatistics {
  std::size_t patches = 0;
  double gapShare = 0;                           // of all points: not flattened by growth
  double matchedShare = 0;                       // of all points: coloured by matching
  double meanDistortion = 0, maxDistortion = 0;  // D over patch points
  // Mapping: of all points, in clusters that were not to be cut further, whether they fit or not;
  // and colour differences along the clusters' borders, root mean square over the swatch's
  // contrast.
  double forcedShare = 0;
  double matchedBorderError = 0, borderError = 0;  // before and after relaxation
};

struct SynthesisResult {
  SourceMap map;
  SynthesisStatistics statistics;
};

// Methods that take SynthesisInput::kept.
bool keepsPoints(const TextureOptions& options);

// The level of the swatch's stack that a method gives points `spacing` apart when pixels are `unit`
// wide (patches show the swatch itself, whatever the spacing).
float shownLevel(Method method, float spacing, float unit);

// Colours every point. Progress counts points. The same bytes at any number of threads. Throws
// InvalidInput, Cancelled.
SynthesisResult synthesize(const SynthesisInput& given, const TextureOptions& options,
                           Monitor& monitor);

}  // namespace dapple
