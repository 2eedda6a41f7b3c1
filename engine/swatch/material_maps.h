// Further images of a swatch: what the same place of the material is like beyond its colour. They
// follow the source map of a synthesis, which at most looks at the heights (swatch_relief.h).
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "swatch/swatch.h"

namespace dapple {

enum class Channel { Roughness, Height, Metallic, Occlusion, Normal };
inline constexpr std::size_t kScalarChannels = 4;  // all but Normal
inline constexpr std::size_t kChannels = 5;

// "roughness", "height", "metallic", "ao", "normal": in command line, project and PLY files.
std::string_view channelName(Channel channel);
// Throws InvalidInput that lists all.
Channel channelNamed(std::string_view name);

// The files of a swatch's channels; empty: none.
struct ChannelPaths {
  std::array<std::string, kChannels> paths;
  bool greenDown = false;  // the normal map's green is as of DirectX; else as of OpenGL, up

  std::string& operator[](Channel channel) { return paths[static_cast<std::size_t>(channel)]; }
  const std::string& operator[](Channel channel) const {
    return paths[static_cast<std::size_t>(channel)];
  }
  bool empty() const;
  bool operator==(const ChannelPaths&) const = default;
};

// w x h values each, or none.
struct MaterialMaps {
  int width = 0, height = 0;
  std::array<std::vector<float>, kScalarChannels> scalar;  // as stored, 0..1 but for float images
  std::vector<vec3> normal;  // tangent space: x along the rows to the right, y up, z outwards

  bool has(Channel channel) const;
  std::size_t bytes() const;
};

// Puts the image of a channel, of the size that the maps have, into its place: its first channel,
// or as a normal. Throws InvalidInput when it is no normal map; `file` is for the message.
void addMap(MaterialMaps& maps, Channel channel, const Image& image, const std::string& file,
            bool greenDown);

// Bilinear, wrapped when `tileable`, else clamped. The channel is there.
float sampleScalar(const MaterialMaps& maps, Channel channel, vec2 texel, bool tileable);
vec3 sampleNormal(const MaterialMaps& maps, vec2 texel, bool tileable);  // not normalised

}  // namespace dapple
