// Words of the command line that say how a picture looks.
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "app/cli/picture.h"
#include "base/errors.h"

namespace dapple {
namespace {

constexpr int kLargest = 8192;  // pixels a side

template <class Value>
struct Named {
  std::string_view name;
  Value value;
};
constexpr Named<Shading> kShadings[] = {
    {"off", Shading::Off}, {"headlight", Shading::Headlight}, {"studio", Shading::Studio}};
constexpr Named<Overlay> kOverlays[] = {
    {"none", Overlay::None}, {"directions", Overlay::Directions}, {"regions", Overlay::Regions}};
const Named<vec3> kColours[] = {{"white", vec3(1)}, {"grey", vec3(0.5f)}, {"black", vec3(0)}};

template <class Values>
auto valueNamed(const Values& values, std::string_view option, const std::string& name) {
  std::string names;
  for (const auto& v : values) {
    if (v.name == name) return v.value;
    names += fmt::format("{}{}", names.empty() ? "" : "|", v.name);
  }
  throw InvalidInput(fmt::format("{}: '{}' is not allowed; choose one of {}", option, name, names));
}

// "#rrggbb" or "#rgb".
std::optional<vec3> hexColour(std::string_view text) {
  if (text.empty() || text[0] != '#' || (text.size() != 4 && text.size() != 7)) return std::nullopt;
  const std::size_t digits = (text.size() - 1) / 3;
  vec3 colour;
  for (std::size_t c = 0; c < 3; ++c) {
    const char* begin = text.data() + 1 + c * digits;
    int value = 0;
    const auto [end, error] = std::from_chars(begin, begin + digits, value, 16);
    if (error != std::errc() || end != begin + digits || value < 0) return std::nullopt;
    colour[static_cast<int>(c)] = static_cast<float>(value) / (digits == 1 ? 15.f : 255.f);
  }
  return colour;
}

// "r,g,b", 0 to 255 each.
std::optional<vec3> listedColour(std::string_view text) {
  const char *at = text.data(), *end = at + text.size();
  vec3 colour;
  for (int c = 0; c < 3; ++c) {
    float value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !(value >= 0 && value <= 255)) return std::nullopt;
    colour[c] = value / 255;
    at = next;
    if (c < 2 && (at == end || *at++ != ',')) return std::nullopt;
  }
  if (at != end) return std::nullopt;
  return colour;
}

}  // namespace

void parseSize(const std::string& text, PictureOptions& options) {
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, options.width);
  bool good = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
  if (good) {
    const auto height = std::from_chars(width.ptr + 1, end, options.height);
    good = height.ec == std::errc() && height.ptr == end;
  }
  auto inRange = [](int size) { return size >= 1 && size <= kLargest; };
  if (!good || !inRange(options.width) || !inRange(options.height))
    throw InvalidInput(fmt::format(
        "--size: '{}' is not allowed; give WIDTHxHEIGHT in pixels, 1 to {} each", text, kLargest));
}

Shading shadingNamed(const std::string& name) {
  return valueNamed(kShadings, "--shading", name);
}

Overlay overlayNamed(const std::string& name) {
  return valueNamed(kOverlays, "--overlay", name);
}

vec3 parseColour(const std::string& text) {
  for (const auto& c : kColours)
    if (c.name == text) return c.value;
  if (const auto colour = hexColour(text)) return *colour;
  if (const auto colour = listedColour(text)) return *colour;
  throw InvalidInput(fmt::format(
      "--background: '{}' is not allowed; give white, grey, black, #rrggbb, or red,green,blue from "
      "0 to 255",
      text));
}

}  // namespace dapple
