#include "points/connected_parts.h"

#include <algorithm>
#include <numeric>

namespace dapple {
namespace {

Index rootOf(std::vector<Index>& parent, Index i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

ConnectedParts connectedParts(const Neighborhoods& neighborhoods,
                              const std::vector<vec3>& positions, float reach) {
  const std::size_t n = neighborhoods.size();
  std::vector<Index> parent(n);
  std::iota(parent.begin(), parent.end(), Index{0});
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < neighborhoods.k; ++j) {
      if (distanceBetween(positions[i], positions[neighborhoods.of(i)[j]]) > reach) break;
      const Index a = rootOf(parent, static_cast<Index>(i));
      const Index b = rootOf(parent, neighborhoods.of(i)[j]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  ConnectedParts out;
  out.part.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Index root = rootOf(parent, static_cast<Index>(i));
    out.part[i] = root == i ? static_cast<Index>(out.count++) : out.part[root];
  }
  return out;
}

}  // namespace dapple
