// Coordinate synthesis of a part of a surface, so that it fits what lies around it.
#pragma once

#include "base/monitor.h"
#include "synthesis/surface_sites.h"

namespace dapple {

// Relaxes the places of `open` points (n, 1: open), which begin where `places` (n) has them; all
// others keep theirs. `surface` is what thinSurface() says of the input. The same bytes at any
// number of threads. Throws Cancelled; then the places are as they were.
void repairPlaces(const SynthesisInput& input, std::span<const SurfaceLevel> surface,
                  std::span<const std::uint8_t> open, std::vector<Place>& places, Monitor& monitor);

}  // namespace dapple
