// The order in which a surface is covered that grows from its starts outward.
#pragma once

#include <span>
#include <vector>

#include "regions/segmentation.h"

namespace dapple {

// All points, part by part of what hangs together; within a part by the distance along the surface
// from its starts, ties by id. Parts with starts come first, in the order of the starts; every
// other part starts at its point of least hash(seed, point) and comes by that hash. Throws
// InvalidInput when a start is not a point, Cancelled.
std::vector<Index> surfaceOrder(const PointGraph& graph, std::span<const Index> starts,
                                std::uint64_t seed, Monitor& monitor);

}  // namespace dapple
