// Levels of detail: an order of points such that the first so many of them show all of the surface.
#pragma once

#include <vector>

#include "base/types.h"

namespace dapple {

struct LevelOrder {
  std::vector<Index> order;         // n ids
  std::vector<std::size_t> counts;  // of each level, the coarsest first: how many make it up

  // By which radii grow so that this level (below counts.size()) leaves no hole.
  float enlargement(std::size_t level) const;
};

// For points in Morton order: every 2nd, 4th, 8th ... of them make up the levels, down to some
// thousands. Random ones would leave holes.
LevelOrder levelOrder(std::size_t n);

}  // namespace dapple
