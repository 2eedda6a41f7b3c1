// A synthesized texture carried on beyond the rim of its region: what its swatch would look like a
// little further on.
//
// Every point beyond takes the texel that lies as far from its decided neighbours' texels, along
// their axes, as it lies from them: the neighbours' patches go on. Where they disagree, patches end
// there: the largest group of like opinions counts. A texel that the swatch does not have (beyond
// the edge of one that does not tile, in a hole) is replaced by the place of the swatch that fits
// the colours around best.
#pragma once

#include <span>
#include <vector>

#include "points/neighborhoods.h"
#include "synthesis/source_map.h"

namespace dapple {

struct ExtensionInput {
  const PointSet& points;  // with normals
  const Neighborhoods& neighborhoods;
  const Swatch& swatch;
  float unit = 0;  // local units per swatch pixel
  // n each; read where `decided`.
  const std::vector<vec2>& texel;
  const std::vector<TangentFrame>& frame;
  const std::vector<float>* scale = nullptr;  // times the unit; null: 1 everywhere
};

// One element for each of the points beyond.
struct Extension {
  std::vector<bool> reached;
  std::vector<vec2> texel;
  std::vector<vec3> up;      // of the swatch
  std::vector<float> scale;  // times the unit
};

// `decided` (n): has a texel. `beyond`: those to carry on over, nearest first.
// Serial, and of the same bytes always. Throws Cancelled.
Extension extendTexture(const ExtensionInput& input, const std::vector<bool>& decided,
                        std::span<const Index> beyond, Monitor& monitor);

}  // namespace dapple
