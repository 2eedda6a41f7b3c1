// The order in which a surface is covered that grows from its starts outward.
#pragma once

#include <span>
#include <vector>

#include "points/neighborhoods.h"

namespace dapple {

// All points (with normals) by the distance along the surface from the nearest of the starts, ties
// by id. Points that no start reaches follow, part by part of what hangs together, each by the
// distance from a start of its own: the first that is left of an order hashed from `seed`. Throws
// InvalidInput when a start is not a point, Cancelled.
std::vector<Index> surfaceOrder(const PointSet& points, const Neighborhoods& neighborhoods,
                                std::span<const Index> starts, std::uint64_t seed,
                                Monitor& monitor);

}  // namespace dapple
