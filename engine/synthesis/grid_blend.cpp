// Kwatra et al., "Texture optimization for example-based synthesis" (2005): a pixel is the mean of
// what all pieces around it want it to be. Departure: once, at the end, and over a pixel or two, as
// wider means blur. The 95th percentile of distances to the nearest patch of the sample, mean of
// eleven samples, is a tenth less than without.
#include "synthesis/grid_blend.h"

#include <array>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr int kReach = 2, kSide = 2 * kReach + 1;  // pixels
constexpr float kSigma = 1;                        // of their weights, pixels
constexpr std::size_t kRowGrain = 16;

using Weights = std::array<std::array<float, kSide>, kSide>;

Weights gaussian() {
  Weights weights;
  for (int v = -kReach; v <= kReach; ++v)
    for (int u = -kReach; u <= kReach; ++u)
      weights[v + kReach][u + kReach] =
          std::exp(-0.5f * static_cast<float>(u * u + v * v) / (kSigma * kSigma));
  return weights;
}

class Blend {
 public:
  Blend(const Swatch& swatch, const CoordinateGrid& grid, std::span<const Place> places)
      : swatch_(swatch), grid_(grid), places_(places), domain_(swatch) {}

  vec3 colour(int x, int y) const {
    const Place own = at(x, y);
    const vec3 ownColour = sampleSwatch(swatch_, texelOf(own));
    vec3 sum(0);
    float total = 0, others = 0;
    for (int v = -kReach; v <= kReach; ++v)
      for (int u = -kReach; u <= kReach; ++u) {
        if (!inside(x + u, y + v)) continue;
        const float weight = weights_[v + kReach][u + kReach];
        const Place there = at(x + u, y + v);
        const Place wanted =
            domain_.wrapped({there.x - u * (1 << kPlaceBits), there.y - v * (1 << kPlaceBits)});
        if (wanted == own) {
          total += weight;
          continue;
        }
        if (!domain_.contains(wanted)) continue;
        total += weight;
        others += weight;
        sum += weight * sampleSwatch(swatch_, texelOf(wanted));
      }
    return others == 0 ? ownColour : (sum + (total - others) * ownColour) / total;
  }

 private:
  bool inside(int x, int y) const {
    return grid_.torus || (x >= 0 && x < grid_.width && y >= 0 && y < grid_.height);
  }
  Place at(int x, int y) const {
    return places_[static_cast<std::size_t>(foldedIndex(y, grid_.height)) *
                       static_cast<std::size_t>(grid_.width) +
                   static_cast<std::size_t>(foldedIndex(x, grid_.width))];
  }

  const Swatch& swatch_;
  const CoordinateGrid& grid_;
  std::span<const Place> places_;
  PlaceDomain domain_;
  Weights weights_ = gaussian();
};

}  // namespace

Image blendedImage(const Swatch& swatch, const CoordinateGrid& grid, std::span<const Place> places,
                   Monitor& monitor) {
  const auto width = static_cast<std::size_t>(grid.width),
             height = static_cast<std::size_t>(grid.height);
  DAPPLE_CHECK(places.size(), ==, width * height);
  const Blend blend(swatch, grid, places);
  Image out{.width = grid.width, .height = grid.height, .channels = 3};
  out.pixels.resize(places.size() * 3);
  parallelFor(monitor, height, kRowGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const vec3 colour = blend.colour(static_cast<int>(x), static_cast<int>(y));
        for (int c = 0; c < 3; ++c)
          out.pixels[3 * (y * width + x) + static_cast<std::size_t>(c)] = colour[c];
      }
  });
  return out;
}

}  // namespace dapple
