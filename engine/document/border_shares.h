// What regions give to the points beyond their borders: their patterns, carried on.
#pragma once

#include "document/border_sides.h"

namespace dapple {

// A texel of a region beyond a border, for a point.
struct BorderShare {
  Index point = 0;
  BorderTerm term;   // weight: of the texel among those of its source
  float beyond = 0;  // of the source at the point, 0..1, before others are heard; cut: none yet
  BorderKind kind = BorderKind::Hard;
  bool locked = false;  // the source's region
};

// By point, then source. Throws Cancelled.
std::vector<BorderShare> borderShares(const Document& document, const BorderSides& sides,
                                      Monitor& monitor);

// The colour that a term has by itself.
vec3 colourOf(const Results& results, const BorderTerm& term);

}  // namespace dapple
