#include "fixtures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/hash_rng.h"
#include "points/tangent_frames.h"

namespace dapple::fixtures {
namespace {

constexpr double kTau = 2 * std::numbers::pi;

Image emptyImage(int size) {
  Image image{size, size, 3, {}};
  image.pixels.resize(static_cast<std::size_t>(size) * size * 3);
  return image;
}

void setPixel(Image& image, int x, int y, vec3 colour) {
  for (int c = 0; c < 3; ++c) image.at(x, y, c) = std::clamp(colour[c], 0.0f, 1.0f);
}

// Shortest signed way from b to a on a circle of length `size`.
float around(float a, float b, int size) {
  return a - b - static_cast<float>(size) * std::round((a - b) / static_cast<float>(size));
}

}  // namespace

PointSet inMortonOrder(const PointSet& points) {
  PointSet sorted;
  for (const Index i : mortonOrder(points.positions)) {
    sorted.positions.push_back(points.positions[i]);
    sorted.normals.push_back(points.normals[i]);
  }
  return sorted;
}

PointSet makePlane(float width, float height, float spacing, float jitter) {
  PointSet plane;
  const int columns = static_cast<int>(width / spacing), rows = static_cast<int>(height / spacing);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const float dx = jitter * (hashUniform(1, x, y, 0) - 0.5f);
      const float dy = jitter * (hashUniform(1, x, y, 1) - 0.5f);
      plane.positions.emplace_back((static_cast<float>(x) + 0.5f + dx) * spacing,
                                   (static_cast<float>(y) + 0.5f + dy) * spacing, 0.0f);
      plane.normals.emplace_back(0.0f, 0.0f, 1.0f);
    }
  }
  return inMortonOrder(plane);
}

PointSet makeSphere(std::size_t count, float radius) {
  PointSet sphere;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double r = std::sqrt(1 - z * z), angle = golden * static_cast<double>(i);
    const vec3 n(r * std::cos(angle), r * std::sin(angle), z);
    sphere.positions.push_back(radius * n);
    sphere.normals.push_back(n);
  }
  return inMortonOrder(sphere);
}

Neighborhoods neighbourhoods(const PointSet& points, std::size_t k) {
  Workers workers(1);
  Monitor monitor(workers);
  return buildNeighborhoods(points.positions, k, monitor);
}

std::vector<TangentFrame> uprightFrames(const PointSet& points, vec3 up) {
  return framesTowards(points, up);
}

Image noise(int size) {
  Image image = emptyImage(size);
  // A sum of waves whose lengths lie between 4 and 12 pixels and that close on the square.
  const int low = size / 12, high = size / 4;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) setPixel(image, x, y, vec3(0.5f));
  int waves = 0;
  for (int k = 0; waves < 40; ++k) {
    const int fx = static_cast<int>(hashBelow(2 * high + 1, 2, k, 0)) - high;
    const int fy = static_cast<int>(hashBelow(2 * high + 1, 2, k, 1)) - high;
    const int length2 = fx * fx + fy * fy;
    if (length2 < low * low || length2 > high * high) continue;
    ++waves;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        for (int c = 0; c < 3; ++c) {
          const double phase =
              kTau * (hashUniform(2, k, 2 + c / 2) + (fx * x + fy * y) / static_cast<double>(size));
          image.at(x, y, c) += static_cast<float>(0.06 * std::cos(phase));
        }
  }
  for (float& value : image.pixels) value = std::clamp(value, 0.0f, 1.0f);
  return image;
}

Image blobs(int size) {
  Image image = emptyImage(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      setPixel(image, x, y, vec3(0.75f, 0.65f, 0.5f) + 0.1f * (hashUniform(4, x, y) - 0.5f));
  const int count = size * size / 100;
  for (int k = 0; k < count; ++k) {
    const float cx = hashUniform(3, k, 0) * static_cast<float>(size);
    const float cy = hashUniform(3, k, 1) * static_cast<float>(size);
    const float radius = 4.0f + 2.0f * static_cast<float>(k % 3);
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const float dx = around(static_cast<float>(x) + 0.5f, cx, size);
        const float dy = around(static_cast<float>(y) + 0.5f, cy, size);
        const float r = std::sqrt(dx * dx + dy * dy);
        if (r > radius) continue;
        // The comma starts thick on the right and thins out counter-clockwise over half a turn.
        const float turn = std::atan2(-dy, dx) / static_cast<float>(std::numbers::pi);
        const float thickness = turn >= 0 ? 0.9f * radius * (1 - turn) : 0.0f;
        const bool comma = std::abs(r - 0.55f * radius) < 0.5f * thickness;
        setPixel(image, x, y, comma ? vec3(0.95f, 0.9f, 0.2f) : vec3(0.3f, 0.12f, 0.1f));
      }
  }
  return image;
}

Image bricks(int size) {
  Image image = emptyImage(size);
  const int course = 12, length = 24;  // sizes that divide 96
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      // Moved so that no joint lies on the border, where it would look like a seam.
      const int row = (y + 5) % size / course, inRow = (y + 5) % course;
      const int shifted = (x + 7 + (row % 2) * length / 2) % size;
      const int inBrick = shifted % length;
      const float tone =
          0.15f * hashUniform(5, row, shifted / length) + 0.06f * hashUniform(6, x, y);
      vec3 colour = vec3(0.6f, 0.25f, 0.18f) + tone;
      if (inRow < 2 || inBrick < 2) colour = vec3(0.8f, 0.78f, 0.72f) - 0.5f * tone;
      if (inRow >= 2 && inRow < 7 && inBrick >= 2 && inBrick < 9 && inBrick - 2 < 9 - inRow)
        colour = vec3(0.1f, 0.1f, 0.15f);  // upper left corner
      setPixel(image, x, y, colour);
    }
  }
  return image;
}

Image stripes(int size, int period) {
  Image image = emptyImage(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      setPixel(image, x, y, vec3(0.5 + 0.4 * std::sin(kTau * (x + 0.5) / period)));
  return image;
}

Image flat(int size, vec3 colour) {
  Image image = emptyImage(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) setPixel(image, x, y, colour);
  return image;
}

Image mirrored(const Image& image) {
  Image result = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < image.channels; ++c)
        result.at(x, y, c) = image.at(image.width - 1 - x, y, c);
  return result;
}

Image cutOf(const Image& image, int x, int y, int width, int height) {
  Image out{.width = width, .height = height, .channels = 3};
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      for (int c = 0; c < 3; ++c)
        out.pixels.push_back(image.at((x + u) % image.width, (y + v) % image.height, c));
  return out;
}

Swatch swatchOf(const Image& image, Tileable tileable) {
  return makeSwatch(image, tileable, 4, "fixture");
}

}  // namespace dapple::fixtures
