// Whether a swatch looks the same when it is turned.
#pragma once

#include "base/monitor.h"
#include "swatch/swatch.h"

namespace dapple {

// How much worse pieces of the swatch match the rest of it when they are turned than when they are
// not: RMS distance of the best match, turned / unturned. About 1: the turn does not show.
struct SelfMatch {
  double half = 1, quarter = 1, eighth = 1;  // turned by 180, 90 and 45 degrees
};

// Squares of 5 x 5 nodes, `step` >= 1 pixels apart, in places spread over level 0, compared by
// colours and relief but for their means. Deterministic. All 1 for a swatch too small for two
// pieces side by side, or of one colour. Throws Cancelled.
SelfMatch selfMatch(const Swatch& swatch, double step, Monitor& monitor);

}  // namespace dapple
