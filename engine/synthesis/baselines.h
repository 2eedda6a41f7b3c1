// What a scan could be coloured with today: the measures that every comparison prints.
#pragma once

#include "base/monitor.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

// Triplanar projection: the swatch laid along the three axes, blended by |normal|^4. The blend is
// kept in the map; texel is that of the strongest axis.
void projectTriplanar(const SynthesisInput& input, SourceMap& map, Monitor& monitor);

// A random texel at each point.
void scatterTexels(const SynthesisInput& input, std::uint64_t seed, SourceMap& map,
                   Monitor& monitor);

}  // namespace dapple
