// What coordinates are synthesized on: sites that know their neighbours and the way to each, in
// swatch pixels. Points of a surface, a plane and a torus all come down to this.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "swatch/appearance.h"

namespace dapple {

inline constexpr std::size_t kMostNear = 16;  // neighbours of a site that take part

// From a site to a neighbour as both see it, in 1/2048 of a level's step: way(i, j) = -way(j, i).
// The lowest bits of x and y together count the quarters by which the neighbour's axes are turned
// to the left of the site's own; then the way is not the same from both ends.
struct Way {
  std::int16_t x, y;
};
inline constexpr std::int16_t kNoWay = std::numeric_limits<std::int16_t>::min();  // as x

inline int quartersOf(Way way) {
  return (way.x & 1) | (way.y & 1) << 1;
}
inline Place placesOf(Way way, int level) {
  return {(way.x >> 1) * (1 << level), (way.y >> 1) * (1 << level)};
}
// Turns ways in pixels, x right and y down, into a level's. kNoWay when one is longer than `reach`
// (place units) along an axis.
class WayScale {
 public:
  WayScale(int level, std::int32_t reach)
      : scale_(std::ldexp(kPlaceScale, -level)),
        farthest_(static_cast<float>(reach) / kPlaceScale - 0.01f) {}
  Way operator()(vec2 pixels, int quarters) const {
    if (!(std::abs(pixels.x) < farthest_ && std::abs(pixels.y) < farthest_)) return {kNoWay, 0};
    return {static_cast<std::int16_t>(2 * rounded(pixels.x * scale_) + (quarters & 1)),
            static_cast<std::int16_t>(2 * rounded(pixels.y * scale_) + (quarters >> 1))};
  }

 private:
  static std::int32_t rounded(float value) {
    return static_cast<std::int32_t>(value < 0 ? value - 0.5f : value + 0.5f);
  }
  float scale_, farthest_;
};

struct SiteLevel {
  int level = 0;                     // its step is 2^level pixels
  std::size_t size = 0;              // n
  std::size_t k = 0;                 // neighbours of a site, at most kMostNear
  std::size_t stride = 0;            // ids from one site's row to the next one's
  std::span<const Index> ids;        // n x stride
  std::vector<Way> ways;             // n x k
  bool turned = false;               // some ways have quarters
  std::vector<Place> positions;      // n: of a plane's sites; empty: these are a surface's
  std::vector<std::uint8_t> frozen;  // n: keeps its place; empty: none does

  // Ways around any loop add up to none.
  bool plane() const { return !positions.empty(); }
};

}  // namespace dapple
