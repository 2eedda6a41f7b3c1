// Moves patches in the swatch to where they fit what their neighbours show.
#pragma once

#include "base/monitor.h"
#include "synthesis/patch_overlap.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

// Chooses map.placement of every patch but the first so that the colours of its overlap with the
// patches placed before it differ least; patches with most overlap first. Patches stay inside a
// swatch that does not tile, and on opaque texels. Updates texel and colour of patch points.
// Counts every point once. Returns the number of patches that were moved. Throws Cancelled.
std::size_t placePatches(const SynthesisInput& input, const PatchOverlap& overlap, SourceMap& map,
                         Monitor& monitor);

}  // namespace dapple
