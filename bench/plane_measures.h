// How much a synthesized picture is like its sample: measures of the plane, where other programs
// can be measured by the same code.
#pragma once

#include "base/parallel.h"
#include "swatch/image.h"

namespace dapple::bench {

// Colours count 0..255 here. Lower is better.
struct PlaneMeasures {
  double coh7 = 0,
         coh15 = 0;  // mean over the picture's 7 x 7 (15 x 15) patches of the RMS distance
                     // to the nearest patch of the sample: what is not in the sample
  double seam = 0;   // 95th percentile of coh7's distances
  double com7 = 0, com15 = 0;  // from the sample to the picture: what is missing
  double swd = 0;              // sliced Wasserstein distance of the colours
  double grad = 0;             // Wasserstein distance of gradient magnitudes, mean of three scales
  double acf = 0;              // RMS difference of the luminance's autocorrelations, lags to 24
  double per = 0;  // share of 15 x 15 patches with a near twin (RMS < 4) in the picture at
                   // one of the two commonest displacements
};

// RGB pictures of at least 64 x 64 pixels. Deterministic.
PlaneMeasures measurePlane(const Image& sample, const Image& picture, Workers& workers);

}  // namespace dapple::bench
