// Histograms of what sites show.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <vector>

#include "base/monitor.h"

namespace dapple {

// How many of the sites 0 ... sites - 1 have each cell of 0 ... cells - 1 (`cells`). Whole numbers
// add up to the same in any order, at any number of threads. Throws Cancelled.
template <class CellOf>
std::vector<std::uint32_t> countCells(std::size_t sites, std::size_t cells, const CellOf& cellOf,
                                      Monitor& monitor) {
  std::vector<std::uint32_t> counts(cells, 0);
  std::mutex mutex;
  // So that adding up costs no more than counting.
  const std::size_t grain = std::max(std::size_t{1} << 14, cells);
  parallelFor(monitor, sites, grain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> own(cells, 0);
    for (std::size_t i = begin; i < end; ++i) ++own[cellOf(i)];
    const std::lock_guard lock(mutex);
    for (std::size_t cell = 0; cell < cells; ++cell) counts[cell] += own[cell];
  });
  return counts;
}

}  // namespace dapple
