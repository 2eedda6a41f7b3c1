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
constexpr std::size_t kChunk = 1 << 16;  // between checkpoints
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

template <class Body>
void forChunks(std::size_t count, const Checkpoint& checkpoint, const Body& body) {
  for (std::size_t begin = 0; begin < count; begin += kChunk) {
    checkpoint();
    for (std::size_t i = begin; i < std::min(count, begin + kChunk); ++i) body(i);
  }
}

// Sorts by the upper half of each entry, a digit after the other from the lowest; the lower half,
// an id, rises already where the upper halves are equal.
void radixSort(std::vector<std::uint64_t>& entries, const Checkpoint& checkpoint) {
  std::vector<std::uint64_t> sorted(entries.size());
  for (int shift = 32; shift < 64; shift += kDigitBits) {
    std::array<std::size_t, kDigits> next{};
    const auto digit = [shift](std::uint64_t entry) { return (entry >> shift) & (kDigits - 1); };
    forChunks(entries.size(), checkpoint, [&](std::size_t i) { ++next[digit(entries[i])]; });
    std::exclusive_scan(next.begin(), next.end(), next.begin(), std::size_t{0});
    forChunks(entries.size(), checkpoint,
              [&](std::size_t i) { sorted[next[digit(entries[i])]++] = entries[i]; });
    entries.swap(sorted);
  }
}

// 2^21 cubes a side over the bounds of the positions.
class Grid {
 public:
  Grid(const std::vector<vec3>& positions, const Checkpoint& checkpoint) {
    if (positions.empty()) return;
    vec3 low = positions[0], high = positions[0];
    forChunks(positions.size(), checkpoint, [&](std::size_t i) {
      low = glm::min(low, positions[i]);
      high = glm::max(high, positions[i]);
    });
    const dvec3 size = dvec3(high) - dvec3(low);
    const double extent = std::max({size.x, size.y, size.z});
    low_ = dvec3(low);
    if (extent > 0) scale_ = kCells / extent;
  }

  std::uint64_t code(const vec3& position) const {
    const dvec3 at = (dvec3(position) - low_) * scale_;
    return spreadBits(cell(at.x)) | spreadBits(cell(at.y)) << 1 | spreadBits(cell(at.z)) << 2;
  }

 private:
  static constexpr double kCells = std::uint64_t{1} << kGridBits;

  static std::uint64_t cell(double at) {
    return static_cast<std::uint64_t>(at < kCells - 1 ? at : kCells - 1);
  }

  dvec3 low_{0};
  double scale_ = 0;
};

Index idOf(std::uint64_t entry) {
  return static_cast<Index>(entry);
}

// By the upper 32 bits of the codes first, of which few are equal, and where they are by the rest:
// entries of 8 bytes for most of the work.
std::vector<Index> orderOf(const std::vector<std::uint64_t>& codes, const Checkpoint& checkpoint) {
  const std::size_t n = codes.size();
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), Index{0});
  checkpoint();
  if (std::is_sorted(codes.begin(), codes.end())) return order;  // a loaded scan is
  std::vector<std::uint64_t> entries(n), run;
  for (std::size_t i = 0; i < n; ++i) entries[i] = codes[i] >> kLowBits << 32 | i;
  radixSort(entries, checkpoint);
  for (std::size_t begin = 0, end = 0, checked = 0; begin < n; begin = end) {
    if (begin - checked >= kChunk) {
      checkpoint();
      checked = begin;
    }
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

std::vector<std::uint64_t> mortonCodes(const std::vector<vec3>& positions, Monitor& monitor) {
  const Grid grid(positions, [&] { monitor.checkpoint(); });
  std::vector<std::uint64_t> codes(positions.size());
  parallelFor(monitor, codes.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) codes[i] = grid.code(positions[i]);
  });
  return codes;
}

std::vector<Index> orderByCode(const std::vector<std::uint64_t>& codes, Monitor& monitor) {
  return orderOf(codes, [&] { monitor.checkpoint(); });
}

std::vector<Index> mortonOrder(const std::vector<vec3>& positions) {
  const Grid grid(positions, [] {});
  std::vector<std::uint64_t> codes(positions.size());
  for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = grid.code(positions[i]);
  return orderOf(codes, [] {});
}

}  // namespace dapple
