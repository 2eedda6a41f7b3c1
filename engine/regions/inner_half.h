// The inner half of regions: what of an arm, or of a small region, may not be taken from outside.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "regions/segmentation.h"

namespace dapple {

// How deep points lie in their regions.
struct RegionDepths {
  std::span<const std::uint8_t> label;  // n
  std::span<const float> depth;  // n, local units from the border; infinite: deeper than counts
  float spacing = 0;             // mean, local units
};

// Which of `asked` lie more than half as deep in their region as the radius of the widest disc
// within it that covers them, by the order of `asked`: the inner half of a strip, whatever its ends
// run into, and nothing beside a straight border. Throws Cancelled.
std::vector<bool> innerHalf(const LinkedPoints& graph, const RegionDepths& regions,
                            std::span<const Index> asked, Monitor& monitor);

}  // namespace dapple
