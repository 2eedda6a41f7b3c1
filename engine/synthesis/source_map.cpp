#include "synthesis/source_map.h"

namespace dapple {

float meanUnit(float unit, std::span<const float> scale) {
  if (scale.empty()) return unit;
  double sum = 0;
  for (const float s : scale) sum += double{s};
  return unit * static_cast<float>(sum / static_cast<double>(scale.size()));
}

SourceMap emptySourceMap(std::size_t n, float unit) {
  SourceMap map;
  map.unit = unit;
  map.texel.assign(n, vec2(0));
  map.frame.assign(n, TangentFrame{});
  map.colour.assign(n, vec3(0));
  map.state.assign(n, PointState::Free);
  map.patch.assign(n, kNone);
  map.error.assign(n, 0.0f);
  map.order.assign(n, kNone);
  return map;
}

void placePoint(SourceMap& map, const Swatch& swatch, std::size_t i) {
  map.texel[i] = wrapTexel(swatch, map.domain[i] + map.placement[map.patch[i]]);
  map.colour[i] = sampleSwatch(swatch, map.texel[i]);
}

vec3 mappedColour(const SourceMap& map, const Swatch& swatch, std::size_t i) {
  const bool blended = !map.blendOffset.empty() && map.blendOffset[i] < map.blendOffset[i + 1];
  if (!blended) return sampleSwatch(swatch, map.texel[i]);
  vec3 colour(0);
  for (Index b = map.blendOffset[i]; b < map.blendOffset[i + 1]; ++b)
    colour += map.blend[b].weight * sampleSwatch(swatch, map.blend[b].texel);
  return colour;
}

}  // namespace dapple
