// Whether two results are one, byte for byte.
#pragma once

#include <cstring>
#include <vector>

#include "synthesis/source_map.h"

namespace dapple::testing {

// For elements without padding.
template <class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// All columns, also those that a method leaves empty.
inline bool sameMaps(const SourceMap& a, const SourceMap& b) {
  return a.unit == b.unit && sameBytes(a.scale, b.scale) && sameBytes(a.texel, b.texel) &&
         sameBytes(a.frame, b.frame) && sameBytes(a.colour, b.colour) &&
         sameBytes(a.level, b.level) && sameBytes(a.state, b.state) &&
         sameBytes(a.patch, b.patch) && sameBytes(a.error, b.error) &&
         sameBytes(a.order, b.order) && sameBytes(a.domain, b.domain) &&
         sameBytes(a.placement, b.placement) && sameBytes(a.blendOffset, b.blendOffset) &&
         sameBytes(a.blend, b.blend);
}

}  // namespace dapple::testing
