// What is drawn as splats, and how: the same for both renderers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "base/types.h"
#include "points/neighborhoods.h"
#include "swatch/swatch.h"

namespace dapple {

// The swatch inside the splats: where the view magnifies it, a splat shows the swatch around its
// texel instead of its colour; where it does not, the colours are smoother.
struct SplatTexture {
  const Swatch& swatch;
  const std::vector<vec2>& texel;          // n, swatch pixels; NaN: this one shows its colour
  const std::vector<TangentFrame>& frame;  // n, s and t are the swatch's axes
  float unit;                              // local units per swatch pixel
  float longestStep = 1.1f;  // swatch pixels from sample to sample; further away: its colour
  const std::vector<float>* scale = nullptr;  // n, times the unit; null: 1 everywhere

  // Swatch pixels per local unit at point i.
  float pixelsPerUnit(std::size_t i) const { return 1 / (scale ? unit * (*scale)[i] : unit); }
};

// What is drawn: n elements a column, borrowed for the call of update() only. Points that are
// near each other in this order (Morton order) are drawn up to twice as fast.
struct SplatColumns {
  const std::vector<vec3>& positions;
  const std::vector<vec3>& normals;  // either side counts as front; zero: faces the eye
  const std::vector<vec3>& colours;  // 0..1, drawn as they are
  const std::vector<float>& radii;   // local units, of the disc; 0: not drawn
  const SplatTexture* texture = nullptr;
  const std::vector<Index>* order = nullptr;  // n: in which they are drawn; null: as they are
};

// 1 for each point that shows its colour although it has a texel; empty: none does.
using PlainPoints = std::vector<std::uint8_t>;

// 8 bits a channel: red in the lowest byte, then green, blue, 255. 0..1, clamped.
inline std::uint32_t packedColour(const vec3& colour) {
  // Through int: SSE has no conversion to unsigned.
  const auto byte = [](float v) {
    return static_cast<std::uint32_t>(static_cast<int>(std::clamp(255 * v, 0.f, 255.f) + 0.5f));
  };
  return byte(colour.r) | byte(colour.g) << 8 | byte(colour.b) << 16 | 0xff000000u;
}

// As packedColour(); 0 in the highest byte: the point is plain.
inline std::uint32_t packedColour(const vec3& colour, bool plain) {
  return plain ? packedColour(colour) & 0xffffffu : packedColour(colour);
}

// A colour laid over points, whose texels it hides.
struct Tint {
  vec3 colour{1};
  float share = 0.5f;  // of the colour; the rest is the point's own

  std::uint32_t over(std::uint32_t packed) const {
    const vec3 own(packed & 255, packed >> 8 & 255, packed >> 16 & 255);
    return packedColour(glm::mix(own / 255.f, colour, share), true);
  }
};

// What a splat may show of the swatch: the texel of each point whose colour is the swatch's there,
// filtered to the point's spacing (n, local units) or not. NaN for the others: blends, and points
// of another swatch. `unit`: local units per swatch pixel.
struct TexelColumns {
  std::span<const vec2> texel;
  std::span<const vec3> colours;
  std::span<const float> spacing;
  std::span<const float> scale = {};  // times the unit; empty: 1 everywhere
};
std::vector<vec2> plainTexels(const TexelColumns& columns, const Swatch& swatch, float unit);

// The radius that leaves no hole and yet blurs little, for a point that owns a square of surface of
// this side.
float splatRadius(float spacing);

// The same for each point of a scan (n, local units), from its neighbours: stray points, alone or a
// few together, are drawn not much larger than the others.
std::vector<float> splatRadii(const Neighborhoods& neighborhoods,
                              const std::vector<vec3>& positions);

// None; a lamp at the eye; or three lamps that stay with the camera, as in a photographer's studio.
enum class Shading { Off, Headlight, Studio };

// What the studio's lamps are worth, red, green and blue, for a normal that is turned to the eye:
// a lamp, times the cosine to it; the sky, times `below` (straight down) to 1 (straight up); and
// light from behind, times the cube of how far it looks aside, from 0 to 1. x to the right, y up, z
// to the eye.
struct StudioLight {
  vec3 towardsKey{-0.45f, 0.60f, 0.66f};
  vec3 key{0.74f, 0.70f, 0.64f}, sky{0.50f, 0.53f, 0.58f}, rim{0.16f, 0.19f, 0.26f};
  float below = 0.35f;
};
inline constexpr StudioLight kStudioLight;

inline constexpr std::size_t kAllPoints = std::numeric_limits<std::size_t>::max();

struct SplatOptions {
  Shading shading = Shading::Off;
  glm::vec3 background{1.0f, 1.0f, 1.0f};  // 0..1
  float lowPass = 1.0f;                    // pixels, > 0: radius of the screen-space filter
  int samples = 1;  // 1..4: a pixel is the mean of samples x samples, for smooth outlines
  std::size_t count = kAllPoints;  // only this many of the first points are drawn ...
  float enlarge = 1;               // ... with their radii times this, > 0

  bool operator==(const SplatOptions&) const = default;
};

// Throws InvalidInput unless 1 <= width, height <= 16384 and the options are in range.
void validate(int width, int height, const SplatOptions& options);

}  // namespace dapple
