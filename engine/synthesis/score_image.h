// The swatch at one scale, read and searched through windows.
#pragma once

#include <array>
#include <vector>

#include "swatch/swatch.h"
#include "synthesis/score_window.h"

namespace dapple {

// Where a window lies in the swatch: node (i, j) steps from its centre reads at
// centre + step * (i * right + j * up). Surface axes: x to the right, y up from the lower border,
// pixels; so y = height - row, and nothing is ever mirrored.
struct Placement {
  vec2 centre{0};
  vec2 right{1, 0}, up{0, 1};
};

Placement turnedPlacement(vec2 centre, float angle);

// How far from upright a window may be turned, radians.
struct TurnLimit {
  float angle = 4;  // beyond pi: any
};

class ScoreImage {
 public:
  // Blurs level 0 of the swatch by half a step (pixels). The swatch is kept by reference.
  ScoreImage(const Swatch& swatch, double step);

  int width() const { return swatch_.width; }
  int height() const { return swatch_.height; }
  float step() const { return step_; }
  bool wraps() const { return wraps_; }
  double contrast() const { return contrast_; }  // of the blurred image, as swatchContrast

  // True when every node reads opaque texels, at most a step beyond the border (or the image
  // wraps).
  bool holds(const Placement& placement) const;

  // A place that a perfect mapping could show: at random in the swatch, its window inside, turned
  // at random up to the limit. `draw` numbers the places.
  Placement randomPlacement(TurnLimit limit, std::uint64_t seed, std::uint64_t draw) const;

  Window read(const Placement& placement) const;

  // Moves, turns and stretches `placement` (singular values 0.8 to 1.25, never mirrored) to bring
  // its window nearer to `target`: at most `iterations` steps of Levenberg-Marquardt. Returns the
  // distance reached (as windowDistance), never more than at the start.
  float refine(const Window& target, TurnLimit limit, int iterations, Placement& placement) const;

 private:
  struct Fit;
  Fit compare(const Window& target, const Placement& placement) const;
  Placement restrained(Placement placement, TurnLimit limit) const;
  bool free() const { return wraps_ || relaxed_; }
  bool someWindowFits() const;
  vec2 rimOf(const Placement& placement) const;

  const Swatch& swatch_;
  float step_;
  bool wraps_;
  bool relaxed_ = false;  // no window fits between the holes: they may be read, filled in
  double contrast_ = 0;
  int pad_, stride_;
  std::vector<Float4> texels_;  // padded on all sides, bottom row first
};

}  // namespace dapple
