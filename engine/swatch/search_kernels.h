// The inner loops of SwatchSearch, one for each instruction set.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dapple::detail {

// A term of the search with its plane shifted so that pixel (x, y) of the searched rectangle is
// compared with row[y * stride + x]. At least 64 pixels may be read from any x on.
struct KernelTerm {
  const std::uint32_t* row;  // 7-bit RGB0 pixels
  std::uint32_t colour;      // 7-bit RGB0
};

// A rectangle of places. No place in it is off any plane.
struct KernelArea {
  const KernelTerm* terms;
  std::size_t termCount;
  std::ptrdiff_t stride;         // pixels
  int x0, x1, y0, y1;            // half open
  const std::uint64_t* blocked;  // bit x of row y: (blocked + y * blockedStride), or null
  std::ptrdiff_t blockedStride;  // words; one more than x1 needs
  std::uint32_t bound;           // only places with a smaller error count
};

struct KernelBest {
  std::uint32_t error = 0xffffffff;
  int x = -1, y = -1;  // -1: no place that is not blocked and below the bound
};

using Kernel = KernelBest (*)(const KernelArea&);

KernelBest searchScalar(const KernelArea& area);
#if defined(__x86_64__)
KernelBest searchAvx2(const KernelArea& area);
KernelBest searchAvx512Vnni(const KernelArea& area);
#endif

}  // namespace dapple::detail
