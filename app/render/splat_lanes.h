// What the loops of the CPU splatter share: eight floats at a time.
#pragma once

#include <cmath>

#include "base/simd.h"

namespace dapple {

using Float4 = float __attribute__((vector_size(16), aligned(4), may_alias));

using Int4 = int __attribute__((vector_size(16), aligned(4), may_alias));
// For sums and products only: the compiler takes comparisons of these apart.
using Float16 = float __attribute__((vector_size(64), aligned(4), may_alias));

inline const Float8& lanes(const float* from) {
  return *reinterpret_cast<const Float8*>(from);
}
inline Float8& lanes(float* from) {
  return *reinterpret_cast<Float8*>(from);
}
inline Float16& sixteenLanes(float* from) {
  return *reinterpret_cast<Float16*>(from);
}
inline Int8& lanes(int* from) {
  return *reinterpret_cast<Int8*>(from);
}
inline const Float4& fourLanes(const float* from) {
  return *reinterpret_cast<const Float4*>(from);
}
inline Float4& fourLanes(float* from) {
  return *reinterpret_cast<Float4*>(from);
}

[[gnu::always_inline]] inline void squareRoot(Float8& v) {
  for (std::size_t l = 0; l < kLanes; ++l) v[l] = std::sqrt(v[l]);
}
[[gnu::always_inline]] inline void limitTo(Float8& v, const Float8& low, const Float8& high) {
  v = v < low ? low : v;
  v = v > high ? high : v;
}

}  // namespace dapple
