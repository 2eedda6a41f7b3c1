#include "points/point_set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

namespace dapple {
namespace {

constexpr int kGridBits = 21;  // three of them fill 63 bits
constexpr int kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;

// The 21 bits of x, two zeros after each.
std::uint64_t spreadBits(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffffull;
  x = (x | x << 16) & 0x001f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  x = (x | x << 2) & 0x1249249249249249ull;
  return x;
}

// Stable sort by a digit after the other, from the lowest: ties keep the order of the ids.
std::vector<Index> orderOf(const std::vector<std::uint64_t>& codes,
                           const std::function<void()>& checkpoint) {
  struct Entry {
    std::uint64_t code;
    Index id;
  };
  const std::size_t n = codes.size();
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), Index{0});
  if (std::is_sorted(codes.begin(), codes.end())) return order;  // a loaded scan
  std::vector<Entry> entries(n), sorted(n);
  for (std::size_t i = 0; i < n; ++i) entries[i] = {codes[i], static_cast<Index>(i)};
  for (int shift = 0; shift < 3 * kGridBits; shift += kDigitBits) {
    checkpoint();
    const auto digit = [shift](const Entry& e) { return (e.code >> shift) & (kDigits - 1); };
    std::array<std::size_t, kDigits> next{};
    for (const Entry& e : entries) ++next[digit(e)];
    if (std::find(next.begin(), next.end(), n) != next.end()) continue;
    std::exclusive_scan(next.begin(), next.end(), next.begin(), std::size_t{0});
    checkpoint();
    for (const Entry& e : entries) sorted[next[digit(e)]++] = e;
    entries.swap(sorted);
  }
  for (std::size_t i = 0; i < n; ++i) order[i] = entries[i].id;
  return order;
}

}  // namespace

std::vector<std::uint64_t> mortonCodes(const std::vector<vec3>& positions) {
  if (positions.empty()) return {};
  dvec3 low(positions[0]), high(positions[0]);
  for (const vec3& p : positions) {
    low = glm::min(low, dvec3(p));
    high = glm::max(high, dvec3(p));
  }
  const dvec3 size = high - low;
  const double extent = std::max({size.x, size.y, size.z});
  const double cells = static_cast<double>(std::uint64_t{1} << kGridBits);
  const double scale = extent > 0 ? cells / extent : 0;
  const auto cell = [&](double x) {
    return static_cast<std::uint64_t>(std::fmin(std::fmax(x * scale, 0.0), cells - 1));
  };
  std::vector<std::uint64_t> codes(positions.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const dvec3 p = dvec3(positions[i]) - low;
    codes[i] = spreadBits(cell(p.x)) | spreadBits(cell(p.y)) << 1 | spreadBits(cell(p.z)) << 2;
  }
  return codes;
}

std::vector<Index> mortonOrder(const std::vector<vec3>& positions) {
  return orderOf(mortonCodes(positions), [] {});
}

std::vector<Index> mortonOrder(const std::vector<vec3>& positions, Monitor& monitor) {
  return orderOf(mortonCodes(positions), [&] { monitor.checkpoint(); });
}

}  // namespace dapple
