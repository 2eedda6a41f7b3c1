// Directions that a user draws on the surface, and how they spread from there.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "points/neighborhoods.h"
#include "points/tangent_frames.h"

namespace dapple {

// A line over the surface: the swatch's top points along it.
struct Stroke {
  std::vector<vec3> positions;  // m >= 2, local units
  std::vector<Index> points;    // m: the scan's nearest point to each
  float weight = 1;             // against other strokes, > 0
  std::optional<float> scale;   // times the region's; none: as the region
  bool operator==(const Stroke&) const = default;
};

// Throws InvalidInput that names what is wrong with a stroke over a scan of n points.
void validate(const Stroke& stroke, std::size_t points);

// Frames (n) that follow the strokes where one lies and, further away, those nearer to a stroke,
// in the order of their distance ([Zeng] 2.3, by links weighted 1 / distance). Points that no
// stroke reaches keep their frame of `otherwise` (n).
std::vector<TangentFrame> spreadStrokes(const PointSet& points, const Neighborhoods& neighborhoods,
                                        std::span<const Stroke> strokes,
                                        std::vector<TangentFrame> otherwise, Monitor& monitor);

}  // namespace dapple
