// What kind of pattern a swatch is: it decides how to synthesize it (methods: section 1.4).
#pragma once

#include <string_view>

#include "swatch/self_match.h"

namespace dapple {

enum class PatternKind {
  Isotropic,    // no turn shows: gravel, leopard
  Directional,  // turns show: grain
  Regular       // it repeats both ways: bricks, weave, text, scales
};
std::string_view patternName(PatternKind kind);  // "isotropic", "directional", "regular"

struct SwatchAnalysis {
  bool tileable = false;
  double area = 0;        // pixels
  double contrast = 0;    // swatchContrast()
  double anisotropy = 0;  // coherence of the structure tensor: 0 none, 1 changes one way only
  double grain = 0;       // along which colours change least: degrees, [0, 180), from the rows
                          // counter-clockwise
  // First minimum of the radial autocorrelation, or where nothing is left of it: half of a feature
  // with what lies around it, pixels.
  double feature = 0;
  double regularity = 0;  // autocorrelation at the strongest repeat, 0..1
  vec2 period{0};         // that repeat, pixels
  double lattice = 0;     // the same across the first one: a pattern that repeats both ways
  // Autocorrelation at the steps of the best lattice, at least eight of them, less that at its half
  // steps: 0 where no lattice goes on, about 1 where all repeats exactly.
  double latticeFit = 0;
  SelfMatch turned;

  bool turnShows() const;  // by 45, 90 or 180 degrees
  PatternKind kind() const;
  // N when it looks the same after a turn by 360 / N degrees, as far as pieces of it tell: 1, 2 or
  // 4; 0 after any.
  int folds() const;
};

// Of colours and, where the swatch has one, relief (swatch_relief.h). Deterministic. Large swatches
// are reduced to some 65 000 texels first; the lengths are those of the whole. Throws Cancelled.
SwatchAnalysis analyse(const Swatch& swatch, Monitor& monitor);

}  // namespace dapple
