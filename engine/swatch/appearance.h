// What the surroundings of every place in a swatch look like, short enough to be compared sixteen
// times for each of millions of candidates (methods: 3.4, step 1): the colours of 5 x 5 texels, a
// step apart, and their relief where there is one, projected on their eight principal components.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/monitor.h"
#include "swatch/continuation.h"
#include "swatch/swatch.h"

namespace dapple {

// A place in a swatch, or a way between two: 1/1024 pixel. Whole numbers, so that going there and
// back ends where it began, to the last bit.
struct Place {
  std::int32_t x, y;
  bool operator==(const Place&) const = default;
};
inline constexpr int kPlaceBits = 10;
inline constexpr float kPlaceScale = 1 << kPlaceBits;

// Rounded to the next place towards 0.
inline Place placeOf(vec2 pixels) {
  return {static_cast<std::int32_t>(pixels.x * kPlaceScale),
          static_cast<std::int32_t>(pixels.y * kPlaceScale)};
}
inline vec2 texelOf(Place place) {
  return vec2(static_cast<float>(place.x), static_cast<float>(place.y)) / kPlaceScale;
}

// Where places may lie: anywhere on a swatch that tiles; else where a bilinear read touches opaque
// texels of the image only.
class PlaceDomain {
 public:
  explicit PlaceDomain(const Swatch& swatch);
  // One that goes on beyond the sides of a swatch that does not tile (continuation.h).
  static PlaceDomain continuing(const Swatch& swatch);

  std::int32_t width() const { return width_; }  // place units
  std::int32_t height() const { return height_; }
  bool tileable() const { return columns_ == 0; }
  // No four opaque texels meet anywhere: nothing can be read between texels.
  bool empty() const { return empty_; }

  // The same place inside a swatch that tiles, at most one width and height away from it; else
  // unchanged.
  Place wrapped(Place place) const {
    if (!tileable()) return place;
    place.x += place.x < 0 ? width_ : place.x >= width_ ? -width_ : 0;
    place.y += place.y < 0 ? height_ : place.y >= height_ ? -height_ : 0;
    return place;
  }
  // Of a wrapped place.
  bool contains(Place place) const {
    if (tileable()) return true;
    constexpr std::int32_t kHalf = 1 << (kPlaceBits - 1);
    const std::int32_t x = (place.x - kHalf) >> kPlaceBits, y = (place.y - kHalf) >> kPlaceBits;
    if (static_cast<std::uint32_t>(x) >= static_cast<std::uint32_t>(columns_) ||
        static_cast<std::uint32_t>(y) >= static_cast<std::uint32_t>(rows_))
      return false;
    return usable_[static_cast<std::size_t>(y) * columns_ + x] != 0;
  }

  // Where the swatch goes on from a place outside, at most one width and height away: contained,
  // or else unchanged.
  Place continued(Place place) const;
  bool continues() const { return tileable() || !continuation_.none(); }

  // A contained place: `from` moved by `way`, any number of swatches far when it tiles; else, when
  // that leads out and nothing goes on there, by the opposite way, or not at all.
  Place moved(Place from, Place way) const;

  // Uniform over all that are contained, hashed from (seed, id, salt).
  Place random(std::uint64_t seed, std::uint64_t id, std::uint64_t salt) const;

 private:
  std::int32_t width_, height_, columns_ = 0, rows_ = 0;
  bool empty_ = false;
  Continuation continuation_;         // of one that goes on
  std::vector<std::uint8_t> usable_;  // cells between four texel centres; empty: all
  std::vector<Index> cells_;          // that are usable; empty: all are
};

inline constexpr int kAppearanceNumbers = 8;
struct alignas(16) Appearance {
  std::int16_t number[kAppearanceNumbers];
};

// One level of a stack that is blurred by half a step of 2^level pixels.
struct AppearanceLevel {
  int level = 0;
  int shift = 0;            // place >> shift: number of the sample that holds it
  std::int32_t reach = 0;   // places up to so far outside of the swatch have samples, place units
  std::int32_t stride = 0;  // samples of a row
  std::int32_t rows = 0;
  std::int32_t margin = 0;  // samples left of, and above, that of place (0, 0)
  float unit = 1;           // appearance numbers of a difference of 1 in all colours
  std::vector<Appearance> samples;
  // A sample of the swatch turned by 1, 2 or 3 quarters, as the unturned one would look beside it:
  // made when asked for, as few are. Null when the level was made without.
  std::function<Appearance(std::int32_t index, int quarters)> turned;
  std::size_t turnedBytes = 0;  // that it holds
  KeptTables tables;            // of all the above: small ones (similar_places.h)

  std::size_t bytes() const { return samples.size() * sizeof(Appearance) + turnedBytes; }

  std::int32_t indexOf(Place place) const {
    return ((place.y >> shift) + margin) * stride + (place.x >> shift) + margin;
  }
  const Appearance& at(Place place) const {
    return samples[static_cast<std::size_t>(indexOf(place))];
  }
};

// AppearanceLevel::reach of a level.
std::int32_t appearanceReach(const Swatch& swatch, int level);

// What of a swatch that does not tile lies beyond its sides is where it goes on, or else its mirror
// image. Throws Cancelled.
AppearanceLevel makeAppearance(const Swatch& swatch, int level, bool turned, Monitor& monitor);
// The same, kept with the swatch.
std::shared_ptr<const AppearanceLevel> appearanceOf(const Swatch& swatch, int level, bool turned,
                                                    Monitor& monitor);

// Sum over the numbers of the squared differences.
std::int32_t appearanceDistance(const Appearance& a, const Appearance& b);

// Levels, so that the step of the last is the largest that does not exceed a third of the swatch.
int appearanceLevels(const Swatch& swatch);

}  // namespace dapple
