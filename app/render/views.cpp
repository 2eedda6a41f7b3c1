// Colours are laid out in CIE 1976 L*a*b* (as lightness, chroma, hue), where equal steps look
// equal.
#include "app/render/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "base/errors.h"
#include "base/hash_rng.h"

namespace dapple {
namespace {

constexpr NamedView kViews[] = {
    {"colour", View::Colour, "the colours"},
    {"normals", View::Normals, "the surface's directions"},
    {"state", View::State, "free, patch, gap or matched"},
    {"patch", View::Patch, "the patches that grew"},
    {"distortion", View::Distortion, "how far the swatch is stretched"},
    {"order", View::Order, "what was decided first, and last"},
    {"regions", View::Regions, "the regions"},
    {"coordinates", View::Coordinates, "the place in the swatch: red to the right, green down"},
    {"roughness", View::Roughness, "the swatches' roughness"},
    {"height", View::Height, "the swatches' height"},
    {"metallic", View::Metallic, "where the swatches are of metal"},
    {"ao", View::Occlusion, "the swatches' ambient occlusion"},
    {"mapped-normals", View::MappedNormals, "the directions that the swatches' normal maps give"},
};

constexpr vec3 kUnknown{0.75f, 0.75f, 0.75f};
constexpr float kBeyondMost = 2;  // of the span that nine tenths of the values take
constexpr int kHeatSteps = 256;

float decoded(float f) {  // the inverse of L*a*b*'s cube root with its straight piece
  constexpr float kKnee = 6.0f / 29;
  return f > kKnee ? f * f * f : 3 * kKnee * kKnee * (f - 4.0f / 29);
}

float gamma(float linear) {  // IEC 61966-2-1
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

// Linear sRGB of a lightness 0..100, a chroma and a hue in turns (white D65).
vec3 linearFromLch(float lightness, float chroma, float turns) {
  const float angle = 2 * std::numbers::pi_v<float> * turns;
  const float fy = (lightness + 16) / 116;
  const float x = 0.95047f * decoded(fy + chroma * std::cos(angle) / 500);
  const float y = decoded(fy);
  const float z = 1.08883f * decoded(fy - chroma * std::sin(angle) / 200);
  return {3.2406f * x - 1.5372f * y - 0.4986f * z, -0.9689f * x + 1.8758f * y + 0.0415f * z,
          0.0557f * x - 0.2040f * y + 1.0570f * z};
}

// As much of the chroma as the screen can show.
vec3 fromLch(float lightness, float chroma, float turns) {
  vec3 rgb = linearFromLch(lightness, chroma, turns);
  for (float c = chroma; c > 0; c -= 1) {
    rgb = linearFromLch(lightness, c, turns);
    if (glm::all(glm::greaterThanEqual(rgb, vec3(0))) && glm::all(glm::lessThanEqual(rgb, vec3(1))))
      break;
  }
  rgb = glm::clamp(rgb, vec3(0), vec3(1));
  return {gamma(rgb.r), gamma(rgb.g), gamma(rgb.b)};
}

template <typename T>
std::span<const T> known(std::span<const T> column, std::string_view name) {
  if (column.empty())
    throw InvalidInput(fmt::format(
        "There is nothing to show as '{}': these points have no such column. Show 'colour', or "
        "give a scan that {}.",
        name,
        name == "regions"            ? "has a vertex property 'region'"
        : isChannel(viewNamed(name)) ? "was textured with --channel"
                                     : "was textured with --source-map"));
  return column;
}

template <typename T, typename Map>
std::vector<vec3> mapped(std::span<const T> column, const Map& map) {
  std::vector<vec3> colours;
  colours.reserve(column.size());
  for (const T& value : column) colours.push_back(map(value));
  return colours;
}

float heatValue(float value) {
  return value;
}
float heatValue(Index value) {
  return value == kNone ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value);
}

// A few values far above all others, as the distortion of gaps, leave the rest its colours.
template <typename T>
std::optional<HeatRange> heatRange(std::span<const T> column) {
  std::vector<float> values;
  for (const T& element : column)
    if (const float v = heatValue(element); std::isfinite(v)) values.push_back(v);
  if (values.empty()) return std::nullopt;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  HeatRange range{*low, *high};
  const auto most = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
  std::nth_element(values.begin(), most, values.end());
  if (*most > range.low)
    range.high = std::min(range.high, range.low + kBeyondMost * (*most - range.low));
  return range;
}

template <typename T>
ViewColours heatMap(std::span<const T> column) {
  const std::optional<HeatRange> found = heatRange(column);
  if (!found) return {std::vector<vec3>(column.size(), kUnknown), std::nullopt};
  const HeatRange range = *found;

  std::array<vec3, kHeatSteps> heat;
  for (int i = 0; i < kHeatSteps; ++i) heat[i] = heatColour(i / (kHeatSteps - 1.0f));
  const float width = range.high - range.low;
  auto colour = [&](const T& element) {
    const float v = heatValue(element);
    if (!std::isfinite(v)) return kUnknown;
    const float t = width > 0 ? std::min(1.f, (v - range.low) / width) : 0;
    return heat[static_cast<std::size_t>(t * (kHeatSteps - 1) + 0.5f)];
  };
  return {mapped(column, colour), range};
}

// A material channel as painters know it: 0 is black, 1 is white, or the ends of a wider range.
ViewColours greyMap(std::span<const float> column) {
  float low = 0, high = 1;
  for (const float v : column)
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  return {
      mapped(column,
             [&](float v) { return std::isfinite(v) ? vec3((v - low) / (high - low)) : kUnknown; }),
      std::nullopt};
}

vec3 normalColour(const vec3& n) {
  return 0.5f * n + vec3(0.5f);
}

vec2 sizeOfSwatch(const ViewColumns& columns) {
  if (columns.swatchSize.x > 0 && columns.swatchSize.y > 0) return columns.swatchSize;
  vec2 largest(0);
  for (const vec2& texel : columns.texel)
    if (std::isfinite(texel.x) && std::isfinite(texel.y)) largest = glm::max(largest, texel);
  return glm::max(largest, vec2(1));
}

ViewColours coordinates(const ViewColumns& columns) {
  const auto texels = known(columns.texel, "coordinates");
  const vec2 size = sizeOfSwatch(columns);
  ViewColours out;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const bool free = !columns.state.empty() && columns.state[i] == PointState::Free;
    const bool none = free || !std::isfinite(texels[i].x) || !std::isfinite(texels[i].y);
    out.colours.push_back(none ? kUnknown : coordinateColour(texels[i] / size));
  }
  return out;
}

}  // namespace

std::span<const NamedView> allViews() {
  return kViews;
}

std::string viewNames(std::string_view separator) {
  std::string names;
  for (const NamedView& v : kViews)
    names += fmt::format("{}{}", names.empty() ? "" : separator, v.name);
  return names;
}

View viewNamed(std::string_view name) {
  for (const NamedView& v : kViews)
    if (v.name == name) return v.view;
  throw InvalidInput(
      fmt::format("There is nothing named '{}' to show; choose one of {}.", name, viewNames(", ")));
}

vec3 stateColour(PointState state) {
  switch (state) {
    case PointState::Free:
      return kUnknown;
    case PointState::Patch:
      return {0.10f, 0.40f, 0.75f};
    case PointState::Gap:
      return {0.95f, 0.58f, 0.05f};
    case PointState::Matched:
      return {0.10f, 0.65f, 0.45f};
  }
  return kUnknown;
}

vec3 patchColour(Index patch) {
  if (patch == kNone) return kUnknown;
  constexpr float kGoldenTurn = 0.618034f;  // successive multiples stay far apart on the circle
  const float turns = std::fmod(static_cast<float>(patch % 10000) * kGoldenTurn, 1.0f);
  const float lightness = 45 + 15 * static_cast<float>(hashBelow(4, 1, patch));
  return fromLch(lightness, 60, turns);
}

vec3 regionColour(Index region) {
  if (region == kNone) return kUnknown;
  // Hues in an order that keeps neighbours apart: by 5 twelfths of the circle. A circle later all
  // are a shade darker, then lighter.
  constexpr Index kHues = 12;
  constexpr float kShades[] = {74, 60, 86};
  const float turns = (static_cast<float>(region * 5 % kHues) + 0.6f) / kHues;
  return fromLch(kShades[region / kHues % 3], 32, turns);
}

vec3 coordinateColour(vec2 place) {
  constexpr float kBlue = 0.35f;
  return {std::clamp(place.x, 0.f, 1.f), std::clamp(place.y, 0.f, 1.f), kBlue};
}

vec3 heatColour(float t) {
  const float u = t > 0 ? std::min(t, 1.0f) : 0.0f;
  return fromLch(15 + 77 * u, 45 + 30 * u, 0.86f - 0.58f * u);
}

bool isChannel(View view) {
  return view == View::Roughness || view == View::Height || view == View::Metallic ||
         view == View::Occlusion || view == View::MappedNormals;
}

ViewColours viewColours(View view, const ViewColumns& columns) {
  switch (view) {
    case View::Colour:
      return {mapped(known(columns.colours, "colour"), [](const vec3& c) { return c; }), {}};
    case View::Normals:
      return {mapped(known(columns.normals, "normals"), normalColour), {}};
    case View::State:
      return {mapped(known(columns.state, "state"), stateColour), {}};
    case View::Patch:
      return {mapped(known(columns.patch, "patch"), patchColour), {}};
    case View::Distortion:
      return heatMap(known(columns.error, "distortion"));
    case View::Order:
      return heatMap(known(columns.order, "order"));
    case View::Regions:
      return {mapped(known(columns.region, "regions"), regionColour), {}};
    case View::Coordinates:
      return coordinates(columns);
    case View::Roughness:
      return greyMap(known(columns.roughness, "roughness"));
    case View::Height:
      return greyMap(known(columns.height, "height"));
    case View::Metallic:
      return greyMap(known(columns.metallic, "metallic"));
    case View::Occlusion:
      return greyMap(known(columns.occlusion, "ao"));
    case View::MappedNormals:
      return {mapped(known(columns.mappedNormals, "mapped-normals"), normalColour), {}};
  }
  throw Bug("no such view");
}

}  // namespace dapple
