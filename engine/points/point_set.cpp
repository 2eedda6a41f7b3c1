#include "points/point_set.h"

#include <algorithm>
#include <numeric>

namespace dapple {
namespace {

// Spreads the low 21 bits to every third bit.
std::uint64_t spreadBits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  return (x | x << 2) & 0x1249249249249249ull;
}

std::vector<std::uint64_t> mortonCodes(const std::vector<vec3>& positions) {
  vec3 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
  for (const vec3& p : positions) low = glm::min(low, p), high = glm::max(high, p);
  const vec3 extent = high - low;
  const double side = std::max({extent.x, extent.y, extent.z});
  const double scale = side > 0 ? 2097151.0 / side : 0.0;
  std::vector<std::uint64_t> codes(positions.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const dvec3 q = dvec3(positions[i] - low) * scale;
    codes[i] = spreadBits(static_cast<std::uint64_t>(q.x)) |
               spreadBits(static_cast<std::uint64_t>(q.y)) << 1 |
               spreadBits(static_cast<std::uint64_t>(q.z)) << 2;
  }
  return codes;
}

}  // namespace

std::vector<Index> mortonOrder(const std::vector<vec3>& positions) {
  const std::vector<std::uint64_t> codes = mortonCodes(positions);
  std::vector<Index> order(positions.size());
  std::iota(order.begin(), order.end(), Index{0});
  // A loaded scan is in this order already: then there is nothing to sort.
  if (std::is_sorted(codes.begin(), codes.end())) return order;
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return codes[a] != codes[b] ? codes[a] < codes[b] : a < b; });
  return order;
}

}  // namespace dapple
