#include "synthesis/baselines.h"

#include <cmath>

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;

// Repeats a swatch that does not tile, too: that is what projecting it does.
vec2 repeated(const Swatch& swatch, vec2 texel) {
  const vec2 size(swatch.width, swatch.height);
  return texel - size * glm::floor(texel / size);
}

}  // namespace

void projectTriplanar(const SynthesisInput& input, SourceMap& map, Monitor& monitor) {
  const std::size_t n = input.points.size();
  map.blendOffset.resize(n + 1);
  map.blend.resize(3 * n);
  for (std::size_t i = 0; i <= n; ++i) map.blendOffset[i] = static_cast<Index>(3 * i);
  parallelFor(
      monitor, n, kGrain,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const vec3 p = input.points.positions[i] / input.unitAt(i);
          const vec3 square = input.points.normals[i] * input.points.normals[i];
          const vec3 weight = square * square / (glm::dot(square, square) + 1e-20f);
          const vec2 plane[3] = {{p.z, -p.y}, {p.x, -p.z}, {p.x, -p.y}};
          int strongest = 0;
          for (int axis = 0; axis < 3; ++axis) {
            map.blend[3 * i + axis] = {repeated(input.swatch, plane[axis]), kNone, weight[axis]};
            if (weight[axis] > weight[strongest]) strongest = axis;
          }
          map.texel[i] = map.blend[3 * i + strongest].texel;
          map.frame[i] = input.frames[i];
          map.colour[i] = mappedColour(map, input.swatch, i);
          map.state[i] = PointState::Matched;
        }
      },
      true);
}

void scatterTexels(const SynthesisInput& input, std::uint64_t seed, SourceMap& map,
                   Monitor& monitor) {
  const Swatch& swatch = input.swatch;
  parallelFor(
      monitor, input.points.size(), kGrain,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          map.texel[i] = randomTexel(swatch, seed, i);
          map.frame[i] = input.frames[i];
          map.colour[i] = sampleSwatch(swatch, map.texel[i]);
          map.state[i] = PointState::Matched;
        }
      },
      true);
}

}  // namespace dapple
