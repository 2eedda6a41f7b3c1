#include "swatch/texel_reader.h"

#include <algorithm>

namespace dapple {

TexelReader::TexelReader(const Swatch& swatch, int level)
    : swatch_(&swatch),
      width_(swatch.width),
      height_(swatch.height),
      tileable_(swatch.tileable),
      lastX_(static_cast<float>(swatch.width - 1)),
      lastY_(static_cast<float>(swatch.height - 1)) {
  const int coarsest = static_cast<int>(swatch.stack.size()) - 1;
  const std::vector<vec3>& image = swatch.stack[std::min(level, coarsest)];
  texels_.reserve(static_cast<std::size_t>(width_ + 1) * (height_ + 1));
  for (int y = 0; y <= height_; ++y) {
    const int row = y < height_ ? y : tileable_ ? 0 : height_ - 1;
    for (int x = 0; x <= width_; ++x) {
      const int column = x < width_ ? x : tileable_ ? 0 : width_ - 1;
      texels_.push_back(toFloat4(image[static_cast<std::size_t>(row) * width_ + column]));
    }
  }
}

vec2 TexelReader::wrap(vec2 place) const {
  if (!tileable_) return place;
  return {wrapCoordinate(place.x, static_cast<float>(width_)),
          wrapCoordinate(place.y, static_cast<float>(height_))};
}

}  // namespace dapple
