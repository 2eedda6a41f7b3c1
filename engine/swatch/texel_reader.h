// Bilinear reads of one level of a swatch, fast enough for some hundred per point.
#pragma once

#include <limits>
#include <vector>

#include "base/simd.h"
#include "swatch/swatch.h"

namespace dapple {

// r, g, b and, of a swatch that has one, its relief; else 0.
using Float4 = float __attribute__((vector_size(16)));

inline Float4 toFloat4(vec3 c, float relief = 0) {
  return Float4{c.x, c.y, c.z, relief};
}
inline float sumOf(Float4 v) {
  return ((v[0] + v[1]) + v[2]) + v[3];
}

// Colours wanted around a place, a column for each number.
class WantedTexels {
 public:
  std::size_t size() const { return count_; }
  vec2 offset(std::size_t t) const { return {x_[t], y_[t]}; }  // from the place, x right, y down
  const Float4& colour(std::size_t t) const { return colour_[t]; }

  void clear() { count_ = 0; }
  void add(vec2 offset, const Float4& wanted) {
    if (count_ + kLanes > x_.size()) grow();
    x_[count_] = offset.x, y_[count_] = offset.y, colour_[count_] = wanted;
    ++count_;
  }

 private:
  friend struct WantedRange;
  // So that whole lanes can be read from any start.
  void grow() {
    const std::size_t room = 2 * (x_.size() + kLanes);
    x_.resize(room), y_.resize(room), colour_.resize(room);
  }

  std::size_t count_ = 0;
  std::vector<float> x_, y_;  // pixels
  std::vector<Float4> colour_;
};

// Some of them that follow one another.
struct WantedRange {
  WantedRange(const WantedTexels& wanted, std::size_t begin, std::size_t end)
      : x(wanted.x_.data() + begin),
        y(wanted.y_.data() + begin),
        colour(wanted.colour_.data() + begin),
        count(end - begin) {}

  const float *x, *y;
  const Float4* colour;
  std::size_t count;
};

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

  // 0 without a relief; of the nearest place inside.
  float relief(vec2 place) const {
    if (!hasRelief_) return 0;
    if (!tileable_) place = glm::clamp(place, vec2(0), vec2(lastX_, lastY_));
    return read(place.x, place.y)[3];
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

  // Sum of the squared differences to what is read around `place`: infinite where a read is not
  // inside(), any value above `bound` when it exceeds that.
  float differences(vec2 place, const WantedRange& wanted, float bound) const;

  // The nearest place that can be read: the same when tileable.
  vec2 nearest(vec2 place) const {
    return tileable_ ? place : glm::clamp(place, vec2(0), vec2(lastX_, lastY_));
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
  bool tileable_, hasRelief_;
  float lastX_, lastY_;
  std::vector<Float4> texels_;  // (w + 1) x (h + 1), the last ones repeat
};

}  // namespace dapple
