#include "swatch/material_maps.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, kChannels> kNames{"roughness", "height", "metallic", "ao",
                                                         "normal"};

// How files of a channel end, in lower case and without the '_' or '-' before; the better first.
struct Ending {
  std::string_view text;
  Channel channel;
  bool greenDown = false;
};
constexpr Ending kEndings[] = {
    {"roughness", Channel::Roughness},
    {"rough", Channel::Roughness},
    {"height", Channel::Height},
    {"displacement", Channel::Height},
    {"disp", Channel::Height},
    {"metallic", Channel::Metallic},
    {"metalness", Channel::Metallic},
    {"metal", Channel::Metallic},
    {"occlusion", Channel::Occlusion},
    {"ambientocclusion", Channel::Occlusion},
    {"ao", Channel::Occlusion},
    {"nor_gl", Channel::Normal},
    {"normal_gl", Channel::Normal},
    {"normalgl", Channel::Normal},
    {"normal", Channel::Normal},
    {"nrm", Channel::Normal},
    {"nor", Channel::Normal},
    {"nor_dx", Channel::Normal, true},
    {"normal_dx", Channel::Normal, true},
    {"normaldx", Channel::Normal, true},
};
// What a swatch's own name may end with in its channels' place.
constexpr std::string_view kColourEndings[] = {"basecolor", "base_color", "albedo", "diffuse",
                                               "diff",      "color",      "colour", "col"};
constexpr std::string_view kImages[] = {".png", ".jpg", ".jpeg", ".tif", ".tiff",
                                        ".exr", ".hdr", ".tga",  ".bmp", ".webp"};

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// "wood" of "wood_diff".
std::string baseOf(const std::string& stem) {
  for (const std::string_view ending : kColourEndings) {
    if (stem.size() <= ending.size() + 1 || !stem.ends_with(ending)) continue;
    const char before = stem[stem.size() - ending.size() - 1];
    if (before == '_' || before == '-') return stem.substr(0, stem.size() - ending.size() - 1);
  }
  return stem;
}

// Position in kEndings of what follows `base` in a file's stem; past the end: something else.
std::size_t endingOf(const std::string& stem, const std::string& base) {
  const std::size_t none = std::size(kEndings);
  if (stem.size() <= base.size() + 1 || !stem.starts_with(base)) return none;
  if (stem[base.size()] != '_' && stem[base.size()] != '-') return none;
  const std::string_view rest = std::string_view(stem).substr(base.size() + 1);
  for (std::size_t e = 0; e < none; ++e)
    if (rest == kEndings[e].text) return e;
  return none;
}

struct BilinearRead {
  std::size_t texel[4];
  float weight[4];
};

BilinearRead bilinear(const MaterialMaps& maps, vec2 texel, bool tileable) {
  const int size[2] = {maps.width, maps.height};
  int first[2], second[2];
  float beyond[2];
  for (int axis = 0; axis < 2; ++axis) {
    float shifted = texel[axis] - 0.5f;
    const float limit = static_cast<float>(size[axis]);
    shifted = tileable ? wrapCoordinate(shifted, limit) : std::clamp(shifted, 0.f, limit - 1);
    first[axis] = std::min(static_cast<int>(shifted), size[axis] - 1);
    beyond[axis] = shifted - static_cast<float>(first[axis]);
    const bool last = first[axis] + 1 == size[axis];
    second[axis] = last ? (tileable ? 0 : first[axis]) : first[axis] + 1;
  }
  BilinearRead read{};
  for (int corner = 0; corner < 4; ++corner) {
    const bool right = corner & 1, below = corner & 2;
    const auto x = static_cast<std::size_t>(right ? second[0] : first[0]);
    const auto y = static_cast<std::size_t>(below ? second[1] : first[1]);
    read.texel[corner] = y * static_cast<std::size_t>(maps.width) + x;
    read.weight[corner] = (right ? beyond[0] : 1 - beyond[0]) * (below ? beyond[1] : 1 - beyond[1]);
  }
  return read;
}

template <class T>
T sampled(const MaterialMaps& maps, const std::vector<T>& values, vec2 texel, bool tileable) {
  const BilinearRead read = bilinear(maps, texel, tileable);
  T sum(0);
  for (int corner = 0; corner < 4; ++corner)
    sum += read.weight[corner] * values[read.texel[corner]];
  return sum;
}

}  // namespace

std::string_view channelName(Channel channel) {
  return kNames[static_cast<std::size_t>(channel)];
}

Channel channelNamed(std::string_view name) {
  std::string all;
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (kNames[c] == name) return static_cast<Channel>(c);
    all += fmt::format("{}{}", c == 0 ? "" : ", ", kNames[c]);
  }
  throw InvalidInput(fmt::format("there is no channel '{}'; choose one of {}", name, all));
}

bool ChannelPaths::empty() const {
  return std::all_of(paths.begin(), paths.end(), [](const auto& path) { return path.empty(); });
}

ChannelPaths findChannels(const fs::path& swatch) {
  ChannelPaths out;
  const std::string own = lower(swatch.stem().string()), base = baseOf(own);
  std::array<std::size_t, kChannels> best;
  best.fill(std::size(kEndings));
  std::error_code error;
  const fs::path folder = swatch.has_parent_path() ? swatch.parent_path() : fs::path(".");
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::path& path = at->path();
    const std::string extension = lower(path.extension().string());
    if (std::find(std::begin(kImages), std::end(kImages), extension) == std::end(kImages)) continue;
    const std::string stem = lower(path.stem().string());
    const std::size_t ending = std::min(endingOf(stem, base), endingOf(stem, own));
    if (ending == std::size(kEndings)) continue;
    const Channel channel = kEndings[ending].channel;
    std::size_t& found = best[static_cast<std::size_t>(channel)];
    const std::string full = (swatch.parent_path() / path.filename()).string();
    // A folder is read in any order; the same answer whichever.
    if (ending > found || (ending == found && full >= out[channel])) continue;
    found = ending;
    out[channel] = full;
    if (channel == Channel::Normal) out.greenDown = kEndings[ending].greenDown;
  }
  return out;
}

bool MaterialMaps::has(Channel channel) const {
  return channel == Channel::Normal ? !normal.empty()
                                    : !scalar[static_cast<std::size_t>(channel)].empty();
}

std::size_t MaterialMaps::bytes() const {
  std::size_t sum = normal.capacity() * sizeof(vec3);
  for (const auto& values : scalar) sum += values.capacity() * sizeof(float);
  return sum;
}

void addMap(MaterialMaps& maps, Channel channel, const Image& image, const std::string& file,
            bool greenDown) {
  DAPPLE_CHECK(image.width, ==, maps.width);
  DAPPLE_CHECK(image.height, ==, maps.height);
  if (channel == Channel::Normal && image.channels < 3)
    throw InvalidInput(fmt::format("{}: a normal map has three channels, not {}; save it as RGB",
                                   file, image.channels));
  const auto pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const auto step = static_cast<std::size_t>(image.channels);
  if (channel != Channel::Normal) {
    std::vector<float>& values = maps.scalar[static_cast<std::size_t>(channel)];
    values.resize(pixels);
    for (std::size_t p = 0; p < pixels; ++p) values[p] = image.pixels[p * step];
    return;
  }
  maps.normal.resize(pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    const float* rgb = image.pixels.data() + p * step;
    vec3 n = 2.f * vec3(rgb[0], rgb[1], rgb[2]) - 1.f;
    if (greenDown) n.y = -n.y;
    maps.normal[p] = n;
  }
}

float sampleScalar(const MaterialMaps& maps, Channel channel, vec2 texel, bool tileable) {
  return sampled(maps, maps.scalar[static_cast<std::size_t>(channel)], texel, tileable);
}

vec3 sampleNormal(const MaterialMaps& maps, vec2 texel, bool tileable) {
  return sampled(maps, maps.normal, texel, tileable);
}

}  // namespace dapple
