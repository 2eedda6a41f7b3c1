// SIMD by the compiler: functions built for several processors and lanes of floats.
#pragma once

#include <cstddef>

// The same function for processors with AVX-512, with AVX2 and without either, chosen when the
// program starts. The bits are the same, as nothing is contracted or reordered. What it calls must
// be inlined into it. (The sanitizers' runtimes are not there yet when the choice is made.)
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define DAPPLE_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define DAPPLE_CLONES
#endif

namespace dapple {

// Eight floats in a row in memory: one register or several, as the processor has them. Not to be
// passed or returned by value: how that is done depends on the processor.
using Float8 = float __attribute__((vector_size(32), aligned(4), may_alias));
using Int8 = int __attribute__((vector_size(32), aligned(4), may_alias));
inline constexpr std::size_t kLanes = 8;

// True when a lane of a comparison is.
[[gnu::always_inline]] inline bool anyLane(const Int8& mask) {
  using Pairs = long long __attribute__((vector_size(32), aligned(4), may_alias));
  const Pairs& pairs = reinterpret_cast<const Pairs&>(mask);
  return ((pairs[0] | pairs[1]) | (pairs[2] | pairs[3])) != 0;
}

inline std::size_t paddedToLanes(std::size_t count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

}  // namespace dapple
