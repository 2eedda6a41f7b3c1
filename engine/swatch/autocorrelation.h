// How alike a swatch is to itself shifted: what its features and its repeats are read from.
#pragma once

#include <vector>

#include "base/monitor.h"
#include "swatch/swatch.h"

namespace dapple {

struct Autocorrelation {
  int reachX = 0, reachY = 0;  // half the swatch: beyond, too few texels overlap to tell
  // (2 reachX + 1) x (2 reachY + 1) for lags from (-reachX, -reachY) on, pixels: the mean product
  // of deviations from the mean (of colour and relief) over all opaque texels that far apart, 1 at
  // lag (0, 0).
  std::vector<float> values;

  float at(int x, int y) const {
    return values[static_cast<std::size_t>(y + reachY) * (2 * reachX + 1) + (x + reachX)];
  }
};

// Of level 0. What lies beyond the border or is transparent does not count; a swatch of one colour
// has 0 everywhere but at lag (0, 0). O(n log n) for n texels. Throws
// Cancelled.
Autocorrelation autocorrelation(const Swatch& swatch, Monitor& monitor);

// Its mean over all lags of about the same length: values for 0, 1, 2, ... pixels, up to the
// smaller reach.
std::vector<double> radialMean(const Autocorrelation& correlation);

}  // namespace dapple
