// Bilinear reads of one level of a swatch, fast enough for some hundred per point.
#pragma once

#include <vector>

#include "swatch/swatch.h"

namespace dapple {

// r, g, b, 0.
using Float4 = float __attribute__((vector_size(16)));

inline Float4 toFloat4(vec3 c) {
  return Float4{c.x, c.y, c.z, 0};
}
inline float sumOf(Float4 v) {
  return (v[0] + v[1]) + v[2];
}

// Places are pixel coordinates counted from the first pixel's centre: texel - 0.5.
class TexelReader {
 public:
  TexelReader(const Swatch& swatch, int level);

  // True when a read touches opaque texels of the image only.
  bool inside(float x, float y) const {
    if (tileable_) return true;
    if (!(x >= 0 && x <= lastX_ && y >= 0 && y <= lastY_)) return false;
    return swatch_->hasHoles ? usableTexel(*swatch_, {x + 0.5f, y + 0.5f}) : true;
  }

  // Colour at a place; wrapped when tileable, else the place must be inside.
  Float4 read(float x, float y) const {
    int column = static_cast<int>(x), row = static_cast<int>(y);
    column -= static_cast<float>(column) > x;
    row -= static_cast<float>(row) > y;
    const float u = x - static_cast<float>(column), v = y - static_cast<float>(row);
    if (static_cast<unsigned>(column) >= static_cast<unsigned>(width_)) {
      column = folded(column, width_);
    }
    if (static_cast<unsigned>(row) >= static_cast<unsigned>(height_)) row = folded(row, height_);
    const Float4* upper = texels_.data() + static_cast<std::size_t>(row) * (width_ + 1) + column;
    const Float4* lower = upper + (width_ + 1);
    const Float4 top = upper[0] + (upper[1] - upper[0]) * u;
    const Float4 bottom = lower[0] + (lower[1] - lower[0]) * u;
    return top + (bottom - top) * v;
  }

  // The same place in [0, w) x [0, h) when tileable.
  vec2 wrap(vec2 place) const;

 private:
  static int folded(int i, int size) {
    i %= size;
    return i < 0 ? i + size : i;
  }

  const Swatch* swatch_;
  int width_, height_;
  bool tileable_;
  float lastX_, lastY_;
  std::vector<Float4> texels_;  // (w + 1) x (h + 1), the last ones repeat
};

}  // namespace dapple
