// Parts of a scan that hang together.
#pragma once

#include <vector>

#include "points/neighborhoods.h"

namespace dapple {

struct ConnectedParts {
  std::size_t count = 0;
  std::vector<Index> part;  // n: 0 .. count - 1, numbered by their first point
};

// Points are linked to their neighbours within `reach` (local units).
ConnectedParts connectedParts(const Neighborhoods& neighborhoods,
                              const std::vector<vec3>& positions, float reach);

}  // namespace dapple
