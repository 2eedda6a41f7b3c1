// Axes on the surface for the swatch to follow where no strokes say otherwise.
#pragma once

#include <vector>

#include "points/point_set.h"

namespace dapple {

// n frames with t as near to `up` (local coordinates, any length > 0) as the tangent plane allows;
// where the surface faces along `up`, as near as possible to z, then x.
std::vector<TangentFrame> framesTowards(const PointSet& points, const vec3& up);

// n frames turned by an angle hashed from (seed, point).
std::vector<TangentFrame> randomFrames(const PointSet& points, std::uint64_t seed);

// Right-handed orthonormal axes, n along the given one (length > 0), t as near to the given one as
// can be; any t when that is along n.
TangentFrame orthonormalFrame(const vec3& n, const vec3& t);

// The direction that `t`, tangent at a normal `from`, becomes at `to` by the smallest rotation.
// Both are of unit length and not opposite.
vec3 transported(const vec3& t, const vec3& from, const vec3& to);

}  // namespace dapple
