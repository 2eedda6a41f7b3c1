// The squares that [Zeng] pastes overlap: here they are cut where they differ least.
#pragma once

#include <span>

#include "base/monitor.h"
#include "synthesis/seam_cut.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

// Times that cutSquares() counts every point.
inline constexpr std::size_t kSeamPasses = 1;

// Chooses for every point one of the squares that cover it, so that colours change little where
// the layout jumps. `centres`: by patch of `map`, whose columns are as matchGrid() leaves them;
// `size`: nodes along a square's side. The same bytes at any number of threads. Throws Cancelled.
SeamStatistics cutSquares(const SynthesisInput& input, std::span<const Index> centres, int size,
                          SourceMap& map, Monitor& monitor);

}  // namespace dapple
