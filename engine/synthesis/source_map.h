// Where in the swatch every point's colour comes from: the one thing that every method writes, and
// from which colours, other channels, exports and diagnostic views all follow.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "points/point_set.h"
#include "swatch/swatch.h"

namespace dapple {

// One contribution to a gap point that was alpha blended.
struct BlendTerm {
  vec2 texel;
  Index patch;
  float weight;  // the weights of a point sum to 1
};

// n elements a column. A column that a method has nothing to say about stays empty.
struct SourceMap {
  float unit = 0;                   // local units per swatch pixel
  std::vector<float> scale;         // times the unit; empty: 1 everywhere
  std::vector<vec2> texel;          // swatch pixels
  std::vector<TangentFrame> frame;  // the swatch's axes on the surface
  std::vector<vec3> colour;         // 0..1
  std::vector<float> level;         // of the swatch's stack that the colour was read at, unless it
                                    // is blended; empty: 0 everywhere
  std::vector<PointState> state;
  std::vector<Index> patch;        // patch or cluster id, kNone when none
  std::vector<float> error;        // what the method minimised (distortion, matching error)
  std::vector<Index> order;        // rank in which the point was decided, kNone when never
  std::vector<vec2> domain;        // patches: position in the patch's flattened domain, pixels,
                                   // never wrapped: texel = domain + placement[patch], wrapped
  std::vector<vec2> placement;     // a patch each: where its domain's 0 lies in the swatch
  std::vector<Index> blendOffset;  // n + 1 offsets into blend, or empty
  std::vector<BlendTerm> blend;
};

// The level of the swatch's stack that points `spacing` apart show when its pixels are `unit` wide:
// each the mean of the pixels between them.
inline float filterLevel(float spacing, float unit) {
  return std::log2(std::max(1.0f, spacing / unit));
}

// The mean over points of the unit times their scale.
float meanUnit(float unit, std::span<const float> scale);

// A map of n free points.
SourceMap emptySourceMap(std::size_t n, float unit);

// Reads the swatch where patch point i lies now: texel and colour from domain and placement[patch].
void placePoint(SourceMap& map, const Swatch& swatch, std::size_t i);

// The colour that the map gives point i: its texel, or its blend.
vec3 mappedColour(const SourceMap& map, const Swatch& swatch, std::size_t i);

}  // namespace dapple
