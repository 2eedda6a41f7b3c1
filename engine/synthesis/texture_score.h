// How good is a textured point set? Objective measures on the points themselves, no mesh, no
// picture (methods: section 8).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "points/neighborhoods.h"
#include "points/point_set.h"
#include "swatch/swatch.h"
#include "synthesis/source_map.h"

namespace dapple {

struct ScoreInput {
  const PointSet& points;              // with normals
  const Neighborhoods& neighborhoods;  // k >= 14
  const std::vector<vec3>& colours;    // n, 0..1
  const Swatch& swatch;
  float unit = 0;                                 // local units per swatch pixel
  const SourceMap* map = nullptr;                 // texel, frame, state, patch where there is one
  const std::vector<vec3>* directions = nullptr;  // n, tangents: where the swatch's t should point;
                                                  // needed for the oriented figures
  std::span<const float> scale = {};              // n, times the unit; empty: 1 everywhere

  // Local units per swatch pixel at point i.
  float unitAt(std::size_t i) const { return scale.empty() ? unit : unit * scale[i]; }
};

struct ScoreOptions {
  std::size_t evaluationPoints = 2000;  // [50, 100000]; compare figures of equal numbers only
  std::uint64_t seed = 1;
};

// Figures at one scale h = max(1, spacing/unit) * {1, 2, 4} pixels.
struct ScaleScore {
  double step = 0;           // h, pixels
  std::size_t windows = 0;   // evaluated: those for which the surface is large enough
  double residual = 0;       // c: mean RMS distance to the best swatch patch / sigma_h
  double residual95 = 0;     // its 95th percentile
  double residualFloor = 0;  // c of a perfect mapping of the same points
  double defects = 0;        // share of evaluated points with c > tau_h
  double threshold = 0;      // tau_h
  double detail = 0;         // contrast between neighbouring nodes / a perfect mapping's
  double sliced = 0;         // sw: sliced Wasserstein distance of patches / deviation
  double slicedNoise = 0;    // sw between two perfect mappings: what chance alone makes of it
};

// How far the direction in which colours change most is off that of the swatch, in windows where
// they change in one direction much more than across it. Degrees, 0 to 90.
struct DirectionError {
  double median = 0, percentile95 = 0;
  double perfectMedian = 0, perfect95 = 0;  // of a perfect mapping: how far the swatch itself turns
};

struct TextureScore {
  std::array<ScaleScore, 3> free;                     // any rotation
  std::optional<std::array<ScaleScore, 3>> oriented;  // within +-20 degrees of the directions
  // (1 - def_2) max(0, 1 - max(0, sw_2 - floor) / 0.25) min(1, detail_1 / 0.85): the floor is 0.045
  // with 2000 evaluation points, more with fewer; detail_1 falls with blur.
  double F = 0;
  std::optional<double> orientedF;
  std::optional<DirectionError> direction;  // at the finest scale, where the swatch has one
  std::optional<double> seamError;    // mean over k-NN edges |I(s_i + R_i o_ij) - c_j| / sigma
  std::optional<double> breaks;       // share of edges off by more than 0.8 px
  std::optional<double> verbatim;     // area-weighted mean size of coherent pieces, points
  std::optional<double> gapContrast;  // contrast of gap (and matched) points / the swatch's
};

// Deterministic for a seed at any number of threads. Throws InvalidInput (fewer than 200 points, a
// unit that is not positive, a surface smaller than an evaluation window), Cancelled.
TextureScore scoreTexture(const ScoreInput& input, const ScoreOptions& options, Monitor& monitor);

}  // namespace dapple
