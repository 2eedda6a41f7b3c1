#include "swatch/texel_reader.h"

#include <algorithm>

namespace dapple {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A level as differences() reads it.
struct TexelGrid {
  const Float4* texels;
  int width, height;
  bool tileable;
};

// Eight coordinates along one axis, pixels.
struct SplitCoordinates {
  Int8 pixel;     // before each, counted from the image's start when it repeats
  Float8 beyond;  // how far each lies behind that
  Int8 outside;   // -1 where an image that does not repeat has nothing to read
};

[[gnu::always_inline]] inline void split(const Float8& at, int size, SplitCoordinates& out) {
  const float limit = static_cast<float>(size);
  out.outside = (at < 0) | (at > limit - 1);
  Int8 whole = __builtin_convertvector(at, Int8);
  whole += __builtin_convertvector(whole, Float8) > at;  // -1: rounded up
  const Float8 before = __builtin_convertvector(whole, Float8);
  out.beyond = at - before;
  const Int8 turns = __builtin_convertvector(before * (1 / limit), Int8);
  out.pixel = whole - turns * size;  // less than one size outside, whatever was rounded
  out.pixel += (out.pixel < 0) & size;
  out.pixel -= (out.pixel >= size) & size;
}

DAPPLE_CLONES float sumDifferences(const TexelGrid& grid, vec2 place, const WantedRange& wanted,
                                   float bound) {
  const int stride = grid.width + 1;
  SplitCoordinates column, row;
  float sum = 0;
  for (std::size_t b = 0; b < wanted.count && sum <= bound; b += kLanes) {
    const std::size_t here = std::min(kLanes, wanted.count - b);
    split(*reinterpret_cast<const Float8*>(wanted.x + b) + place.x, grid.width, column);
    split(*reinterpret_cast<const Float8*>(wanted.y + b) + place.y, grid.height, row);
    const Int8 first = row.pixel * stride + column.pixel;
    if (!grid.tileable) {
      const Int8 lane{0, 1, 2, 3, 4, 5, 6, 7};
      const Int8 outside = (column.outside | row.outside) & (lane < static_cast<int>(here));
      if (anyLane(outside)) return kInfinity;
    }
    Float4 squares{0, 0, 0, 0};
    for (std::size_t l = 0; l < here; ++l) {
      const Float4* upper = grid.texels + first[l];
      // Two texels at once, one above the other ...
      const Float8 above = *reinterpret_cast<const Float8*>(upper);
      const Float8 below = *reinterpret_cast<const Float8*>(upper + stride);
      const Float8 between = above + (below - above) * row.beyond[l];
      // ... then side by side.
      const Float4 left = __builtin_shufflevector(between, between, 0, 1, 2, 3);
      const Float4 right = __builtin_shufflevector(between, between, 4, 5, 6, 7);
      const Float4 d = left + (right - left) * column.beyond[l] - wanted.colour[b + l];
      squares += d * d;
    }
    sum += sumOf(squares);
  }
  return sum;
}

}  // namespace

TexelReader::TexelReader(const Swatch& swatch, int level)
    : swatch_(&swatch),
      width_(swatch.width),
      height_(swatch.height),
      tileable_(swatch.tileable),
      hasRelief_(!swatch.relief.empty()),
      lastX_(static_cast<float>(swatch.width - 1)),
      lastY_(static_cast<float>(swatch.height - 1)) {
  const int coarsest = static_cast<int>(swatch.stack.size()) - 1;
  const auto used = static_cast<std::size_t>(std::min(level, coarsest));
  const std::vector<vec3>& image = swatch.stack[used];
  texels_.reserve(static_cast<std::size_t>(width_ + 1) * (height_ + 1));
  for (int y = 0; y <= height_; ++y) {
    const int row = y < height_ ? y : tileable_ ? 0 : height_ - 1;
    for (int x = 0; x <= width_; ++x) {
      const int column = x < width_ ? x : tileable_ ? 0 : width_ - 1;
      const std::size_t i = static_cast<std::size_t>(row) * width_ + column;
      texels_.push_back(toFloat4(image[i], hasRelief_ ? swatch.relief[used][i] : 0));
    }
  }
}

float TexelReader::differences(vec2 place, const WantedRange& wanted, float bound) const {
  if (swatch_->hasHoles)
    for (std::size_t t = 0; t < wanted.count; ++t)
      if (!inside(place.x + wanted.x[t], place.y + wanted.y[t])) return kInfinity;
  return sumDifferences({texels_.data(), width_, height_, tileable_}, place, wanted, bound);
}

vec2 TexelReader::wrap(vec2 place) const {
  if (!tileable_) return place;
  return {wrapCoordinate(place.x, static_cast<float>(width_)),
          wrapCoordinate(place.y, static_cast<float>(height_))};
}

}  // namespace dapple
