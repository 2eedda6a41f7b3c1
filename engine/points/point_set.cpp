#include "points/point_set.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

namespace dapple {
namespace {

constexpr int kGridBits = 21;  // three of them fill 63 bits
constexpr int kLowBits = 31;   // of a code, sorted only among equal upper 32
constexpr int kDigitBits = 11;
constexpr std::size_t kLongRun = 4096;
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

using Checkpoint = std::function<void()>;

// Sorts by the upper half of each entry, a digit after the other from the lowest; the lower half,
// an id, rises already where the upper halves are equal.
void radixSort(std::vector<std::uint64_t>& entries, const Checkpoint& checkpoint) {
  std::vector<std::uint64_t> sorted(entries.size());
  for (int shift = 32; shift < 64; shift += kDigitBits) {
    checkpoint();
    std::array<std::size_t, kDigits> next{};
    const auto digit = [shift](std::uint64_t entry) { return (entry >> shift) & (kDigits - 1); };
    for (const std::uint64_t entry : entries) ++next[digit(entry)];
    std::exclusive_scan(next.begin(), next.end(), next.begin(), std::size_t{0});
    for (const std::uint64_t entry : entries) sorted[next[digit(entry)]++] = entry;
    entries.swap(sorted);
  }
}

Index idOf(std::uint64_t entry) {
  return static_cast<Index>(entry);
}

// By the upper 32 bits of the codes first, of which few are equal, and where they are by the rest:
// entries of 8 bytes for most of the work.
std::vector<Index> orderOf(const std::vector<std::uint64_t>& codes, const Checkpoint& checkpoint) {
  const std::size_t n = codes.size();
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), Index{0});
  if (std::is_sorted(codes.begin(), codes.end())) return order;  // a loaded scan is
  std::vector<std::uint64_t> entries(n), run;
  for (std::size_t i = 0; i < n; ++i) entries[i] = codes[i] >> kLowBits << 32 | i;
  radixSort(entries, checkpoint);
  for (std::size_t begin = 0, end = 0; begin < n; begin = end) {
    run.clear();
    for (; end < n && entries[end] >> 32 == entries[begin] >> 32; ++end) {
      const Index id = idOf(entries[end]);
      run.push_back(codes[id] << (64 - kLowBits) >> 1 | id);
    }
    if (run.size() > kLongRun) radixSort(run, checkpoint);
    if (run.size() <= kLongRun && run.size() > 1) std::sort(run.begin(), run.end());
    for (std::size_t k = 0; k < run.size(); ++k) order[begin + k] = idOf(run[k]);
  }
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
    const double at = x * scale;
    return static_cast<std::uint64_t>(at < cells - 1 ? at : cells - 1);
  };
  std::vector<std::uint64_t> codes(positions.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const dvec3 p = dvec3(positions[i]) - low;
    codes[i] = spreadBits(cell(p.x)) | spreadBits(cell(p.y)) << 1 | spreadBits(cell(p.z)) << 2;
  }
  return codes;
}

std::vector<Index> orderByCode(const std::vector<std::uint64_t>& codes, Monitor& monitor) {
  return orderOf(codes, [&] { monitor.checkpoint(); });
}

std::vector<Index> mortonOrder(const std::vector<vec3>& positions) {
  return orderOf(mortonCodes(positions), [] {});
}

}  // namespace dapple
