#include "app/render/splats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.h"
#include "synthesis/source_map.h"

namespace dapple {
namespace {

constexpr float kRadiusPerSpacing = 1.2f;
constexpr float kMostStray = 2;  // times the spacing of most neighbours, and among the nearest
constexpr std::size_t kFew = 6;
// Strewn points, each far from all others: no radius is more than so many times that which all but
// a few are below.
constexpr float kMostStrewn = 3, kAllButAFew = 0.98f;
constexpr int kLargestPicture = 16384;
constexpr int kLargestSamples = 4;

}  // namespace

void validate(int width, int height, const SplatOptions& options) {
  if (width < 1 || height < 1 || width > kLargestPicture || height > kLargestPicture)
    throw InvalidInput(
        fmt::format("A picture of {} x {} pixels cannot be drawn; sides go from 1 to {}.", width,
                    height, kLargestPicture));
  if (!(options.lowPass > 0))
    throw InvalidInput(
        fmt::format("The low-pass radius is {} pixels; it must be above 0.", options.lowPass));
  if (!(options.enlarge > 0))
    throw InvalidInput(
        fmt::format("Radii cannot be enlarged {} times; it must be above 0.", options.enlarge));
  if (options.samples < 1 || options.samples > kLargestSamples)
    throw InvalidInput(fmt::format("{} samples along a pixel's side cannot be drawn; give 1 to {}.",
                                   options.samples, kLargestSamples));
}

std::vector<vec2> plainTexels(const TexelColumns& columns, const Swatch& swatch, float unit) {
  constexpr float kSame = 2.5f / 255;  // files hold 8 bits
  const vec2 none(std::numeric_limits<float>::quiet_NaN());
  std::vector<vec2> texels(columns.texel.begin(), columns.texel.end());
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const float pixel = columns.scale.empty() ? unit : unit * columns.scale[i];
    const float blur = filterLevel(columns.spacing[i], pixel);
    const auto same = [&](float level) {
      const vec3 d = glm::abs(sampleSwatch(swatch, texels[i], level) - columns.colours[i]);
      return std::max({d.r, d.g, d.b}) < kSame;
    };
    if (!same(0) && !same(blur)) texels[i] = none;
  }
  return texels;
}

float splatRadius(float spacing) {
  return kRadiusPerSpacing * spacing;
}

std::vector<float> splatRadii(const Neighborhoods& neighborhoods,
                              const std::vector<vec3>& positions) {
  const std::vector<float> spacing = localSpacing(neighborhoods, positions);
  std::vector<float> radii(spacing.size()), around;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    around.clear();
    for (const Index j : neighborhoods.of(i)) around.push_back(spacing[j]);
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
    std::nth_element(around.begin(), middle, around.end());
    // The nearest alone: a few stray points together have most of their neighbours far away.
    const std::size_t few = std::min(kFew, neighborhoods.k);
    const float close = distanceBetween(positions[i], positions[neighborhoods.of(i)[few - 1]]) *
                        std::sqrt(std::numbers::pi_v<float> / (static_cast<float>(few) + 0.5f));
    radii[i] = splatRadius(std::min(spacing[i], kMostStray * std::min(*middle, close)));
  }
  if (radii.empty()) return radii;
  std::vector<float> sorted = radii;
  const auto usual = sorted.begin() + static_cast<std::ptrdiff_t>(
                                          kAllButAFew * static_cast<float>(sorted.size() - 1));
  std::nth_element(sorted.begin(), usual, sorted.end());
  for (float& radius : radii) radius = std::min(radius, kMostStrewn * *usual);
  return radii;
}

}  // namespace dapple
