// Which points belong together: what the selection tools and the automatic segmentation ask.
#pragma once

#include <span>
#include <vector>

#include "base/monitor.h"
#include "points/neighborhoods.h"
#include "regions/point_mask.h"

namespace dapple {

// A scan whose points are linked to their 12 nearest, in both directions, unless their normals look
// away from each other: so that nothing leaks through a thin sheet.
struct LinkedPoints {
  const PointSet& points;  // with normals
  const Neighborhoods& neighborhoods;
};

// With every point that is linked to one of the mask.
PointMask grown(const LinkedPoints& graph, const PointMask& mask, Monitor& monitor);

// Without every point that is linked to one outside of the mask.
PointMask shrunk(const LinkedPoints& graph, const PointMask& mask, Monitor& monitor);

// All that hangs together with `seed`.
PointMask connectedTo(const LinkedPoints& graph, Index seed, Monitor& monitor);

enum class WandBy {
  Normal,   // angle to the normal around the seed, degrees
  Colour,   // distance to the colour around the seed, 0 .. sqrt 3
  Distance  // along the surface from the seed, local units
};

struct WandOptions {
  WandBy by = WandBy::Normal;
  float threshold = 20;
  bool connected = true;  // only what hangs together with the seed
};

// Points that are like the seed. `colours` (n) is what Colour compares. Throws InvalidInput when it
// is empty and asked for, or the threshold is not a number of 0 or more.
PointMask wand(const LinkedPoints& graph, std::span<const vec3> colours, Index seed,
               const WandOptions& options, Monitor& monitor);

// Length of the shortest way along the links from any of the seeds, local units (n); infinite
// beyond `limit`.
std::vector<float> surfaceDistances(const LinkedPoints& graph, std::span<const Index> seeds,
                                    float limit, Monitor& monitor);

struct SegmentOptions {
  int parts = 4;  // 1 .. 250
};

// The part (0 .. parts - 1) of each point: compact parts that end at creases and where the colour
// changes (k-medoids under a distance along the surface to which every crease and change adds).
// `colours` may be empty. Scraps that hang together with nothing join the nearest part. Throws
// InvalidInput, Cancelled.
std::vector<std::uint8_t> segment(const LinkedPoints& graph, std::span<const vec3> colours,
                                  const SegmentOptions& options, Monitor& monitor);

}  // namespace dapple
