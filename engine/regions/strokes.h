// Directions that a user draws on the surface.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "points/neighborhoods.h"

namespace dapple {

// A line over the surface: the swatch's top points along it.
struct Stroke {
  std::vector<vec3> positions;  // m >= 2, local units
  std::vector<Index> points;    // m: the scan's nearest point to each
  float weight = 1;             // against other strokes, > 0
  std::optional<float> scale;   // times the region's; none: as the region
  bool operator==(const Stroke&) const = default;
};

// Their first points: as in [Zeng], whoever draws where the pattern runs also says where it begins.
std::vector<Index> startsOf(std::span<const Stroke> strokes);

// Throws InvalidInput that names what is wrong with a stroke over a scan of n points.
void validate(const Stroke& stroke, std::size_t points);

// What a stroke says at a point that it runs over.
struct StrokeMark {
  Index point;
  vec3 direction;  // in the point's tangent plane, unit length
  float weight;
  float scale;  // 1 where the stroke has none
};

// The marks of all strokes in their order, along each without gaps: from each of its points to the
// next they follow the neighbours. A point that several strokes run over, or one several times, has
// several. Throws InvalidInput as validate() does.
std::vector<StrokeMark> strokeMarks(const PointSet& points, const Neighborhoods& neighborhoods,
                                    std::span<const Stroke> strokes);

}  // namespace dapple
