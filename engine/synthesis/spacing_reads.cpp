#include "synthesis/spacing_reads.h"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

constexpr std::size_t kGrain = 1024;

}  // namespace

int meanReadLevel(const SynthesisInput& input) {
  const double pixels =
      meanSpacing(input.neighborhoods, input.points.positions) / meanUnit(input.unit, input.scale);
  const int last = static_cast<int>(input.swatch.stack.size()) - 1;
  return std::clamp(static_cast<int>(std::lround(std::log2(pixels))), 0, last);
}

void readBySpacing(const SynthesisInput& input, SourceMap& map, Monitor& monitor) {
  const std::vector<float> spacing = localSpacing(input.neighborhoods, input.points.positions);
  parallelFor(monitor, spacing.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!input.isKept(i))
        map.colour[i] =
            sampleSwatch(input.swatch, map.texel[i], filterLevel(spacing[i], input.unitAt(i)));
  });
}

}  // namespace dapple
