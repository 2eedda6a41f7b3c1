// Sites on a surface: its points, thinned out level by level to about one per step.
#pragma once

#include "synthesis/coordinate_sites.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

struct SurfaceLevel {
  int level = 0;              // a step is 2^level swatch pixels; below 0 nothing is synthesized
  std::vector<Index> points;  // n_l, ascending; empty: all points
  Neighborhoods near;         // of these, as indices of `points`; empty at the finest level, whose
                              // own are the input's
  std::vector<Index> parent;  // n_l, indices of the next level's points; empty at the last
};

inline Index pointAt(const SurfaceLevel& level, std::size_t site) {
  return level.points.empty() ? static_cast<Index>(site) : level.points[site];
}
inline const Neighborhoods& nearOf(const SurfaceLevel& level, const SynthesisInput& input) {
  return level.points.empty() ? input.neighborhoods : level.near;
}

// The level of the swatch's stack that a point shows: the swatch itself as long as points lie about
// a pixel apart.
float readLevel(const SynthesisInput& input, std::size_t point);
// The same of points `spacing` apart where pixels are `unit` wide.
float siteLevel(float spacing, float unit);

// Finest first, down to `levels` or to a few sites. Steps are of absolute size: where points lie
// further apart than a step all of them stay, and where they are closer than pixels the first
// levels lie below 0. Points of level l + 1 are points of level l as well. Throws Cancelled.
std::vector<SurfaceLevel> thinSurface(const SynthesisInput& input, int levels, Monitor& monitor);

// The ways between points, and what lies apart.
class SiteWays {
 public:
  explicit SiteWays(const SynthesisInput& input) : in_(input) {}

  struct Offset {
    bool seen = false;  // false: they face away from each other, or lie above each other
    vec2 pixels{0};     // x right, y down
    int quarters = 0;   // by which the axes at `to` are turned to the left of those at `from`
  };
  // The mean of what both points see, turned back by whole quarters.
  Offset between(Index from, Index to) const;

  // What a level of at least 0 is synthesized on. Sites of points that are not `open` (n, empty:
  // all are) are frozen and have no ways; frozen are those as well that lie much further apart than
  // the level's step. `reach` as AppearanceLevel's. Throws Cancelled.
  SiteLevel sitesOf(const SurfaceLevel& surface, std::int32_t reach,
                    std::span<const std::uint8_t> open, Monitor& monitor) const;

 private:
  SynthesisInput in_;
};

}  // namespace dapple
