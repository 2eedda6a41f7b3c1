// How alike two pictures look.
#pragma once

#include "swatch/image.h"

namespace dapple {

// Mean structural similarity (Wang et al. 2004) in windows of 8 x 8 pixels: 1 for equal pictures,
// about 0 for unrelated ones. Alpha is left out. Throws InvalidInput unless both pictures have the
// same size, at least 8 x 8.
double structuralSimilarity(const Image& a, const Image& b);

// 1 - structuralSimilarity: golden pictures allow 0.04.
double structuralSimilarityError(const Image& a, const Image& b);

}  // namespace dapple
