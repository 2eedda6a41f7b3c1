// Periodic coordinates: two phases at every point, along the swatch's axes, that advance from point
// to point by as much as the way between them is long. Where that cannot be everywhere, the
// difference is spread, or a course begins or ends (methods: section 9, item 10).
#pragma once

#include <span>

#include "base/monitor.h"
#include "synthesis/surface_sites.h"

namespace dapple {

struct PhaseOptions {
  int starts = 3;  // of which the smoothest is taken, for each axis
  std::uint64_t seed = 1;
};

// Levels of thinSurface(), so that the step of the last is at most a sixth of the swatch.
int phaseLevels(const Swatch& swatch);

// From the coarsest level to the points, one at a time.
class PhaseField {
 public:
  // Both are kept by reference. `surface` is what thinSurface() says of the input.
  PhaseField(const SynthesisInput& input, std::span<const SurfaceLevel> surface,
             const PhaseOptions& options);

  // Level l, from the next coarser one, which has been solved; the last from nothing. The same
  // bytes at any number of threads. Throws Cancelled.
  void solve(std::size_t l, Monitor& monitor);

  // Of the level solved last (n_l): swatch pixels, inside of the swatch.
  std::vector<vec2> texels(Monitor& monitor) const;

  // Of the level solved last (n_l): how far the neighbours' texels lie from where they should, root
  // mean square, pixels per pixel of the way. Neighbours whose axes are turned by a quarter or more
  // count as 1.
  std::vector<float> residuals(Monitor& monitor) const;

 private:
  // A level's links, kLinks a site; those that are missing lead back to the site itself.
  struct Links {
    std::vector<Index> ids;
    std::vector<vec2> pixels;        // the way
    std::vector<float> length, cut;  // n_l: sum of squares of the ways, also those across a cut
  };
  void link(std::size_t l, Monitor& monitor);
  void prolong(std::size_t l, Monitor& monitor);

  const SynthesisInput& in_;
  std::span<const SurfaceLevel> surface_;
  PhaseOptions options_;
  SiteWays ways_;
  Links links_;
  std::vector<vec2> phase_[2];  // n_l: unit complex numbers along x and y
};

}  // namespace dapple
