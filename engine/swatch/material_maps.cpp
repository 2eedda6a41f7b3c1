#include "swatch/material_maps.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::array<std::string_view, kChannels> kNames{"roughness", "height", "metallic", "ao",
                                                         "normal"};

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
