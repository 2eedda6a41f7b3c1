// The sample image that a region takes its pattern from.
#pragma once

#include <string>
#include <vector>

#include "swatch/image.h"
#include "swatch/kept_tables.h"

namespace dapple {

enum class Tileable { Auto, Yes, No };

// Texel coordinates everywhere: swatch pixels, x to the right, y down, pixel centres at +0.5.
struct Swatch {
  int width = 0, height = 0;
  bool tileable = false;
  bool hasHoles = false;             // some texel is transparent
  std::vector<std::uint8_t> opaque;  // w x h, 1 = may be used
  // Gaussian stack, full size at every level: level 0 is the image, level l is blurred by
  // 0.5 * 2^l pixels; transparent texels hold the colour of the nearest opaque one, so that a
  // filter at the rim of a hole never mixes in what is hidden.
  std::vector<std::vector<vec3>> stack;
  // By level as `stack`: a fourth number of every texel that places are compared by
  // (swatch_relief.h). Nobody sees it; empty: colours are all.
  std::vector<std::vector<float>> relief;
  // Of all the above (appearance.h, swatch_search.h), which from then on must not change.
  KeptTables tables;

  const std::vector<vec3>& colours() const { return stack.front(); }
  std::size_t pixels() const { return static_cast<std::size_t>(width) * height; }
};

// Grey, RGB or RGBA image to a swatch with `levels` >= 1 of the stack. A texel is opaque when its
// alpha is >= 0.5 and its numbers are finite. Tileable::Auto detects it (an image with holes never
// tiles, not even with Tileable::Yes). Throws InvalidInput
// when the image is smaller than 2 x 2 or wholly transparent; `name` is for the message.
Swatch makeSwatch(const Image& image, Tileable tileable, int levels, const std::string& name);

// True when the step across both pairs of opposite borders is at most 1.5 times the mean step
// inside along the same direction (methods: section 1.4).
bool looksTileable(const Image& image);

// Bilinear colour; wrapped when tileable, else clamped to the border pixels. A fractional level
// blends two levels of the stack.
vec3 sampleSwatch(const Swatch& swatch, vec2 texel, float level = 0);

// Bilinear, of level 0; 0 where the swatch has no relief.
float sampleRelief(const Swatch& swatch, vec2 texel);

// The same coordinate in [0, size).
float wrapCoordinate(float value, float size);

// The texel inside the image: wrapped into [0, w) x [0, h) when tileable, else unchanged.
vec2 wrapTexel(const Swatch& swatch, vec2 texel);

// True when a bilinear read at `texel` touches opaque texels of the image only (always true for a
// tileable swatch).
bool usableTexel(const Swatch& swatch, vec2 texel);

// The centre of an opaque texel, hashed from (seed, id, salt).
vec2 randomTexel(const Swatch& swatch, std::uint64_t seed, std::uint64_t id,
                 std::uint64_t salt = 0);

// Root mean square deviation from the mean colour over all numbers (opaque texels x 3 channels):
// the swatch's contrast sigma, on a level of its stack.
double swatchContrast(const Swatch& swatch, int level = 0);

}  // namespace dapple
