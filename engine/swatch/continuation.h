// Where a swatch that does not tile goes on beyond its sides: at the part of itself that the rim
// along each side resembles most. A pattern that repeats goes on a whole number of periods away,
// whatever its lattice; any other where it shows least.
#pragma once

#include <array>
#include <memory>

#include "swatch/swatch.h"

namespace dapple {

struct Continuation {
  // From beyond the left, right, upper and lower side back into the swatch, pixels, y down.
  std::array<ivec2, 4> back{};

  bool none() const { return back[0] == ivec2(0); }
  std::size_t bytes() const { return sizeof(*this); }
};

// None for a swatch that tiles, has holes or is smaller than 32 pixels.
Continuation findContinuation(const Swatch& swatch);

// The same, kept with the swatch.
std::shared_ptr<const Continuation> continuationOf(const Swatch& swatch);

}  // namespace dapple
