#include "swatch/swatch.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "swatch/gaussian_blur.h"

namespace dapple {
namespace {

constexpr double kTileableStep = 1.5;  // methods, section 1.4
constexpr int kMostTries = 64;         // for an opaque texel

int colourChannels(const Image& image) {
  return image.channels >= 3 ? 3 : 1;
}
bool hasAlpha(const Image& image) {
  return image.channels == 2 || image.channels == 4;
}

// Sum of |difference| over the colour channels of two pixels.
double pixelStep(const Image& image, ivec2 a, ivec2 b) {
  double step = 0;
  for (int c = 0; c < colourChannels(image); ++c)
    step += std::abs(image.at(a.x, a.y, c) - image.at(b.x, b.y, c));
  return step;
}

bool isOpaque(const Image& image, int x, int y) {
  // A float image may hold NaN or infinities, which would spread through every filter.
  for (int c = 0; c < image.channels; ++c)
    if (!std::isfinite(image.at(x, y, c))) return false;
  return !hasAlpha(image) || image.at(x, y, image.channels - 1) >= 0.5f;
}

void checkImage(const Image& image, const std::string& name) {
  DAPPLE_CHECK(image.pixels.size(), ==,
               static_cast<std::size_t>(image.width) * image.height * image.channels);
  if (image.width < 2 || image.height < 2)
    throw InvalidInput(
        fmt::format("{}: {} x {} pixels, but a swatch needs at least 2 x 2. Choose a larger image",
                    name, image.width, image.height));
  if (image.channels < 1 || image.channels > 4)
    throw InvalidInput(
        fmt::format("{}: {} channels, but a swatch has 1 to 4 (grey, grey and alpha, RGB, RGBA). "
                    "Save it as RGB",
                    name, image.channels));
}

// The two texels that a linear read between pixel centres touches, and the weight of the second.
struct LinearRead {
  int first, second;
  float weight;
};

LinearRead linearRead(float coordinate, int size, bool wraps) {
  const float limit = static_cast<float>(size);
  float shifted = coordinate - 0.5f;
  if (wraps) {
    shifted = wrapCoordinate(shifted, limit);
    const int first = std::min(static_cast<int>(shifted), size - 1);
    return {first, first + 1 == size ? 0 : first + 1, shifted - static_cast<float>(first)};
  }
  const float whole = std::floor(shifted);
  return {static_cast<int>(std::clamp(whole, 0.0f, limit - 1)),
          static_cast<int>(std::clamp(whole + 1, 0.0f, limit - 1)), shifted - whole};
}

template <class T>
T sampleValues(const Swatch& swatch, const std::vector<T>& values, vec2 texel) {
  const LinearRead x = linearRead(texel.x, swatch.width, swatch.tileable);
  const LinearRead y = linearRead(texel.y, swatch.height, swatch.tileable);
  const T* upper = values.data() + static_cast<std::size_t>(y.first) * swatch.width;
  const T* lower = values.data() + static_cast<std::size_t>(y.second) * swatch.width;
  return glm::mix(glm::mix(upper[x.first], upper[x.second], x.weight),
                  glm::mix(lower[x.first], lower[x.second], x.weight), y.weight);
}

}  // namespace

bool looksTileable(const Image& image) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (!isOpaque(image, x, y)) return false;
  const auto tilesAlong = [&](int axis) {
    const int length = axis == 0 ? image.width : image.height;
    const int lines = axis == 0 ? image.height : image.width;
    const auto pixel = [axis](int along, int line) {
      return axis == 0 ? ivec2(along, line) : ivec2(line, along);
    };
    double inside = 0, across = 0;
    for (int line = 0; line < lines; ++line) {
      across += pixelStep(image, pixel(0, line), pixel(length - 1, line));
      for (int i = 1; i < length; ++i)
        inside += pixelStep(image, pixel(i - 1, line), pixel(i, line));
    }
    return across <= kTileableStep * inside / (length - 1);
  };
  return tilesAlong(0) && tilesAlong(1);
}

Swatch makeSwatch(const Image& image, Tileable tileable, int levels, const std::string& name) {
  DAPPLE_CHECK(levels, >=, 1);
  checkImage(image, name);
  Swatch swatch{.width = image.width, .height = image.height};
  swatch.opaque.resize(swatch.pixels());
  std::vector<vec3> colours(swatch.pixels(), vec3(0));
  std::size_t usable = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * image.width + x;
      swatch.opaque[i] = isOpaque(image, x, y);
      usable += swatch.opaque[i];
      for (int c = 0; c < 3; ++c)
        colours[i][c] = image.at(x, y, std::min(c, colourChannels(image) - 1));
    }
  }
  if (usable == 0)
    throw InvalidInput(fmt::format(
        "{}: every pixel is transparent (alpha below 0.5). Choose an image with opaque pixels",
        name));
  swatch.hasHoles = usable < swatch.pixels();
  // Even on demand an image with holes does not tile: a wrapped patch would run into them.
  swatch.tileable = !swatch.hasHoles && (tileable == Tileable::Yes ||
                                         (tileable == Tileable::Auto && looksTileable(image)));
  if (swatch.hasHoles) fillHoles(swatch, colours);
  swatch.stack.push_back(std::move(colours));
  for (int level = 1; level < levels; ++level)
    swatch.stack.push_back(blurSwatch(swatch, std::ldexp(0.5, level)));
  return swatch;
}

vec3 sampleSwatch(const Swatch& swatch, vec2 texel, float level) {
  const float coarsest = static_cast<float>(swatch.stack.size() - 1);
  const float clamped = std::clamp(level, 0.0f, coarsest);
  const auto finer = static_cast<std::size_t>(clamped);
  const float blend = clamped - static_cast<float>(finer);
  const vec3 colour = sampleValues(swatch, swatch.stack[finer], texel);
  if (blend <= 0) return colour;
  return glm::mix(colour, sampleValues(swatch, swatch.stack[finer + 1], texel), blend);
}

float sampleRelief(const Swatch& swatch, vec2 texel) {
  return swatch.relief.empty() ? 0 : sampleValues(swatch, swatch.relief.front(), texel);
}

float wrapCoordinate(float value, float size) {
  if (value >= 0 && value < size) return value;
  const float wrapped = value - size * std::floor(value / size);
  return wrapped < size && wrapped >= 0 ? wrapped : 0.0f;  // rounding may land on the end
}

vec2 wrapTexel(const Swatch& swatch, vec2 texel) {
  if (!swatch.tileable) return texel;
  return {wrapCoordinate(texel.x, static_cast<float>(swatch.width)),
          wrapCoordinate(texel.y, static_cast<float>(swatch.height))};
}

bool usableTexel(const Swatch& swatch, vec2 texel) {
  if (swatch.tileable) return true;
  const float right = static_cast<float>(swatch.width) - 0.5f;
  const float bottom = static_cast<float>(swatch.height) - 0.5f;
  // Written so that NaN is refused.
  if (!(texel.x >= 0.5f && texel.x <= right && texel.y >= 0.5f && texel.y <= bottom)) return false;
  if (!swatch.hasHoles) return true;
  const LinearRead x = linearRead(texel.x, swatch.width, false);
  const LinearRead y = linearRead(texel.y, swatch.height, false);
  const int lastColumn = x.weight > 0 ? x.second : x.first;
  const int lastRow = y.weight > 0 ? y.second : y.first;
  for (int row : {y.first, lastRow})
    for (int column : {x.first, lastColumn})
      if (!swatch.opaque[static_cast<std::size_t>(row) * swatch.width + column]) return false;
  return true;
}

vec2 randomTexel(const Swatch& swatch, std::uint64_t seed, std::uint64_t id, std::uint64_t salt) {
  const std::size_t pixels = swatch.pixels();
  std::uint64_t pixel = 0;
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    pixel = hashBelow(pixels, seed, id, salt, static_cast<std::uint64_t>(attempt));
    if (swatch.opaque[pixel]) break;
  }
  while (!swatch.opaque[pixel]) pixel = (pixel + 1) % pixels;
  const auto width = static_cast<std::uint64_t>(swatch.width);
  return vec2(pixel % width, pixel / width) + 0.5f;
}

double swatchContrast(const Swatch& swatch, int level) {
  const std::vector<vec3>& colours = swatch.stack.at(static_cast<std::size_t>(level));
  dvec3 sum(0);
  double count = 0;
  for (std::size_t i = 0; i < swatch.pixels(); ++i) {
    if (!swatch.opaque[i]) continue;
    sum += dvec3(colours[i]);
    ++count;
  }
  const dvec3 mean = sum / count;
  double squares = 0;
  for (std::size_t i = 0; i < swatch.pixels(); ++i) {
    if (!swatch.opaque[i]) continue;
    const dvec3 d = dvec3(colours[i]) - mean;
    squares += glm::dot(d, d);
  }
  return std::sqrt(squares / (3 * count));
}

}  // namespace dapple
