// Sums of squared differences over 7-bit colours, 64 (AVX-512), 32 (AVX2) or 1 (scalar) places at a
// time: all terms of a block of places before the next block, so that sums and the running minimum
// stay in registers. Seven bits keep every product exact: a difference fits a signed byte, and a
// pair of squares fits 16 bits with sign.
#include "swatch/search_kernels.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <bit>

namespace dapple::detail {
namespace {

// Bits x ... x + 63 of a row of blocked places.
inline std::uint64_t blockedBits(const KernelArea& area, int x, int y) {
  if (area.blocked == nullptr) return 0;
  const std::uint64_t* word = area.blocked + y * area.blockedStride + (x >> 6);
  const int shift = x & 63;
  return shift == 0 ? word[0] : (word[0] >> shift) | (word[1] << (64 - shift));
}

// Places from (x, y) on along a row; bit i of `dead`: place x + i does not count.
struct Block {
  int x, y;
  std::uint64_t dead;
};

inline Block blockAt(const KernelArea& area, int x, int y) {
  return {x, y, blockedBits(area, x, y)};
}

// Leaves out what lies beyond the end of the area.
inline Block shortened(Block block, const KernelArea& area) {
  const int left = area.x1 - block.x;
  if (left < 64) block.dead |= ~std::uint64_t{0} << left;
  return block;
}

// The smallest of the lanes in `lanes` (bits); ties to the earlier row, then x.
void takeBest(const std::uint32_t* errors, const std::uint32_t* places, std::uint32_t lanes,
              KernelBest& best) {
  for (; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    const int x = static_cast<int>(places[lane] & 0xffff) + lane;
    const int y = static_cast<int>(places[lane] >> 16);
    const bool earlier = y < best.y || (y == best.y && x < best.x);
    if (errors[lane] < best.error || (errors[lane] == best.error && earlier)) {
      best = {errors[lane], x, y};
    }
  }
}

}  // namespace

KernelBest searchScalar(const KernelArea& area) {
  KernelBest best{area.bound};
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      if ((blockedBits(area, x, y) & 1) != 0) continue;
      std::uint32_t error = 0;
      for (std::size_t t = 0; t < area.termCount && error < best.error; ++t) {
        const std::uint32_t pixel = area.terms[t].row[y * area.stride + x];
        const std::uint32_t colour = area.terms[t].colour;
        for (int shift = 0; shift < 32; shift += 8) {
          const int d =
              static_cast<int>((pixel >> shift) & 127) - static_cast<int>((colour >> shift) & 127);
          error += static_cast<std::uint32_t>(d * d);
        }
      }
      if (error < best.error) best = {error, x, y};
    }
  }
  return best;
}

#if defined(__x86_64__)

namespace {

#define DAPPLE_AVX2 __attribute__((target("avx2")))
#define DAPPLE_AVX512 __attribute__((target("avx512f,avx512bw,avx512vnni")))

struct Minima2 {
  __m256i error[4], place[4];
};

// N vectors of 8 places from (x, y) on; `dead` has a bit for each place that does not count.
template <int N>
DAPPLE_AVX2 inline void blockAvx2(const KernelArea& area, const Block& block, Minima2& minima) {
  const __m256i ones = _mm256_set1_epi16(1);
  const std::ptrdiff_t at = block.y * area.stride + block.x;
  __m256i sum[N];
  for (int v = 0; v < N; ++v) sum[v] = _mm256_setzero_si256();
  for (std::size_t t = 0; t < area.termCount; ++t) {
    const __m256i colour = _mm256_set1_epi32(static_cast<int>(area.terms[t].colour));
    const std::uint32_t* row = area.terms[t].row + at;
    for (int v = 0; v < N; ++v) {
      const __m256i pixel = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row + 8 * v));
      const __m256i d = _mm256_abs_epi8(_mm256_sub_epi8(pixel, colour));
      sum[v] = _mm256_add_epi32(sum[v], _mm256_madd_epi16(_mm256_maddubs_epi16(d, d), ones));
    }
  }
  const __m256i place = _mm256_set1_epi32((block.y << 16) | block.x);
  for (int v = 0; v < N; ++v) {
    __m256i error = sum[v];
    if (block.dead != 0) {
      const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
      const __m256i bits = _mm256_set1_epi32(static_cast<int>((block.dead >> (8 * v)) & 255));
      error = _mm256_or_si256(error, _mm256_cmpeq_epi32(_mm256_and_si256(bits, bit), bit));
    }
    const __m256i best = minima.error[v];
    const __m256i least = _mm256_min_epu32(error, best);
    const __m256i keep = _mm256_cmpeq_epi32(least, best);
    minima.place[v] = _mm256_blendv_epi8(place, minima.place[v], keep);
    minima.error[v] = least;
  }
}

DAPPLE_AVX2 inline void restAvx2(const KernelArea& area, Block block, Minima2& minima) {
  block = shortened(block, area);
  switch ((area.x1 - block.x + 7) / 8) {
    case 1:
      return blockAvx2<1>(area, block, minima);
    case 2:
      return blockAvx2<2>(area, block, minima);
    case 3:
      return blockAvx2<3>(area, block, minima);
    default:
      return blockAvx2<4>(area, block, minima);
  }
}

struct Minima512 {
  __m512i error[4], place[4];
};

// |I - c|^2 = I.I - 2 I.c + c.c: two dot products for each vector of 16 places instead of a
// difference, its absolute value and one dot product. `constant` is the sum of c.c.
template <int N>
DAPPLE_AVX512 inline void blockAvx512(const KernelArea& area, int constant, const Block& block,
                                      Minima512& minima) {
  const std::ptrdiff_t at = block.y * area.stride + block.x;
  __m512i squares[N], products[N];
  for (int v = 0; v < N; ++v) {
    squares[v] = _mm512_set1_epi32(constant);
    products[v] = _mm512_setzero_si512();
  }
  for (std::size_t t = 0; t < area.termCount; ++t) {
    const __m512i colour = _mm512_set1_epi32(static_cast<int>(area.terms[t].colour));
    const std::uint32_t* row = area.terms[t].row + at;
    for (int v = 0; v < N; ++v) {
      const __m512i pixel = _mm512_loadu_si512(row + 16 * v);
      squares[v] = _mm512_dpbusd_epi32(squares[v], pixel, pixel);
      products[v] = _mm512_dpbusd_epi32(products[v], pixel, colour);
    }
  }
  const __m512i place = _mm512_set1_epi32((block.y << 16) | block.x);
  for (int v = 0; v < N; ++v) {
    const __m512i twice = _mm512_add_epi32(products[v], products[v]);
    const __m512i error = _mm512_sub_epi32(squares[v], twice);
    const auto alive = static_cast<__mmask16>(~(block.dead >> (16 * v)));
    const __mmask16 less = _mm512_mask_cmplt_epu32_mask(alive, error, minima.error[v]);
    minima.error[v] = _mm512_mask_mov_epi32(minima.error[v], less, error);
    minima.place[v] = _mm512_mask_mov_epi32(minima.place[v], less, place);
  }
}

DAPPLE_AVX512 inline void restAvx512(const KernelArea& area, int constant, Block block,
                                     Minima512& minima) {
  block = shortened(block, area);
  switch ((area.x1 - block.x + 15) / 16) {
    case 1:
      return blockAvx512<1>(area, constant, block, minima);
    case 2:
      return blockAvx512<2>(area, constant, block, minima);
    case 3:
      return blockAvx512<3>(area, constant, block, minima);
    default:
      return blockAvx512<4>(area, constant, block, minima);
  }
}

// Sum over terms of colour . colour.
int squaredColours(const KernelArea& area) {
  std::uint32_t sum = 0;
  for (std::size_t t = 0; t < area.termCount; ++t) {
    for (int shift = 0; shift < 32; shift += 8) {
      const std::uint32_t c = (area.terms[t].colour >> shift) & 127;
      sum += c * c;
    }
  }
  return static_cast<int>(sum);
}

}  // namespace

DAPPLE_AVX2 KernelBest searchAvx2(const KernelArea& area) {
  Minima2 minima;
  for (int v = 0; v < 4; ++v) {
    minima.error[v] = _mm256_set1_epi32(static_cast<int>(area.bound));
    minima.place[v] = _mm256_setzero_si256();
  }
  for (int y = area.y0; y < area.y1; ++y) {
    int x = area.x0;
    for (; x + 32 <= area.x1; x += 32) {
      Block block = blockAt(area, x, y);
      block.dead &= 0xffffffff;
      blockAvx2<4>(area, block, minima);
    }
    if (x < area.x1) {
      restAvx2(area, blockAt(area, x, y), minima);
    }
  }
  KernelBest best{area.bound};
  for (int v = 0; v < 4; ++v) {
    alignas(32) std::uint32_t errors[8], places[8];
    _mm256_store_si256(reinterpret_cast<__m256i*>(errors), minima.error[v]);
    _mm256_store_si256(reinterpret_cast<__m256i*>(places),
                       _mm256_add_epi32(minima.place[v], _mm256_set1_epi32(8 * v)));
    const __m256i same =
        _mm256_cmpeq_epi32(minima.error[v], _mm256_set1_epi32(static_cast<int>(area.bound)));
    const int lanes = ~_mm256_movemask_ps(_mm256_castsi256_ps(same)) & 255;
    takeBest(errors, places, static_cast<std::uint32_t>(lanes), best);
  }
  return best;
}

DAPPLE_AVX512 KernelBest searchAvx512Vnni(const KernelArea& area) {
  Minima512 minima;
  for (int v = 0; v < 4; ++v) {
    minima.error[v] = _mm512_set1_epi32(static_cast<int>(area.bound));
    minima.place[v] = _mm512_setzero_si512();
  }
  const int constant = squaredColours(area);
  for (int y = area.y0; y < area.y1; ++y) {
    int x = area.x0;
    for (; x + 64 <= area.x1; x += 64) {
      blockAvx512<4>(area, constant, blockAt(area, x, y), minima);
    }
    if (x < area.x1) restAvx512(area, constant, blockAt(area, x, y), minima);
  }
  KernelBest best{area.bound};
  for (int v = 0; v < 4; ++v) {
    alignas(64) std::uint32_t errors[16], places[16];
    _mm512_store_si512(errors, minima.error[v]);
    _mm512_store_si512(places, _mm512_add_epi32(minima.place[v], _mm512_set1_epi32(16 * v)));
    const __m512i bound = _mm512_set1_epi32(static_cast<int>(area.bound));
    takeBest(errors, places, _mm512_cmplt_epu32_mask(minima.error[v], bound), best);
  }
  return best;
}

#endif

}  // namespace dapple::detail
