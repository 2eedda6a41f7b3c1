#include "app/render/splat_chunks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dapple {
namespace {

constexpr int kSquare = 8;        // samples a side, of the finest level
constexpr float kSlack = 1;       // samples
constexpr float kCloser = 1e-6f;  // depths are rounded

SplatChunk chunkOf(const SplatColumns& columns, std::size_t begin, std::size_t end) {
  SplatChunk chunk;
  vec3 low(std::numeric_limits<float>::infinity()), high = -low;
  for (std::size_t i = begin; i < end; ++i) {
    if (!(columns.radii[i] > 0)) continue;
    low = glm::min(low, columns.positions[i]);
    high = glm::max(high, columns.positions[i]);
    chunk.largestRadius = std::max(chunk.largestRadius, columns.radii[i]);
    chunk.normal += columns.normals[i];
  }
  if (!(chunk.largestRadius > 0)) return chunk;
  chunk.centre = 0.5f * (low + high);
  for (std::size_t i = begin; i < end; ++i)
    if (columns.radii[i] > 0)
      chunk.reach = std::max(chunk.reach, glm::distance(columns.positions[i], chunk.centre));
  return chunk;
}

}  // namespace

std::vector<SplatChunk> splatChunks(const SplatColumns& columns) {
  const std::size_t n = columns.positions.size();
  std::vector<SplatChunk> chunks;
  chunks.reserve((n + SplatChunk::kPoints - 1) / SplatChunk::kPoints);
  for (std::size_t begin = 0; begin < n; begin += SplatChunk::kPoints)
    chunks.push_back(chunkOf(columns, begin, std::min(n, begin + SplatChunk::kPoints)));
  return chunks;
}

ChunkImage chunkImage(const SplatChunk& chunk, const SplatLens& lens) {
  ChunkImage image;
  if (chunk.reach < 0) return image;
  const vec3 c = lens.view * glm::vec4(chunk.centre, 1);
  const float radius = chunk.largestRadius * lens.enlarge, ball = chunk.reach + radius;
  // A splat is drawn when its centre lies between the planes.
  if (-c.z + chunk.reach < lens.nearest || -c.z - chunk.reach > lens.farthest) return image;
  image.drawn = true;
  image.nearest = -c.z - ball;
  const vec3 toEye = lens.orthographic ? vec3(0, 0, 1) : -c;
  image.away = glm::dot(glm::mat3(lens.view) * chunk.normal, toEye) < 0;

  constexpr float kFar = std::numeric_limits<float>::infinity();
  if (lens.orthographic) {
    const float size =
        std::max(lens.focal * ball, lens.lowPass + lens.focal * chunk.reach) + kSlack;
    image.box = {lens.focal * glm::vec2(c) - size, lens.focal * glm::vec2(c) + size};
    image.radius = lens.focal * radius;
    return image;
  }
  if (!(image.nearest > 0)) {
    image.box = {glm::vec2(-kFar), glm::vec2(kFar)};
    image.radius = kFar;
    return image;
  }
  // The ball lies in a box of its size, whose image is bounded by those of its near and far sides.
  const float front = lens.focal / image.nearest, back = lens.focal / (-c.z + ball);
  const glm::vec2 low = glm::vec2(c) - ball, high = glm::vec2(c) + ball;
  const float pad = lens.lowPass + kSlack;
  image.box.low = glm::min(low * front, low * back) - pad;
  image.box.high = glm::max(high * front, high * back) + pad;
  // Off the axis a disc's image is longer, by the square of the ray's length at most.
  const glm::vec2 off = glm::max(glm::abs(image.box.low), glm::abs(image.box.high)) / lens.focal;
  image.radius = radius * front * (1 + glm::dot(off, off));
  return image;
}

void DepthPyramid::build(std::span<const float> depths, int width, int height) {
  levels_.clear();
  Level first{(width + kSquare - 1) / kSquare, (height + kSquare - 1) / kSquare, {}};
  first.farthest.assign(static_cast<std::size_t>(first.width) * first.height, 0);
  for (int y = 0; y < height; ++y) {
    float* row = first.farthest.data() + static_cast<std::size_t>(y / kSquare) * first.width;
    const float* from = depths.data() + static_cast<std::size_t>(y) * width;
    for (int square = 0; square < first.width; ++square) {
      const int end = std::min(width, (square + 1) * kSquare);
      float farthest = row[square];
      for (int x = square * kSquare; x < end; ++x) farthest = std::max(farthest, from[x]);
      row[square] = farthest;
    }
  }
  levels_.push_back(std::move(first));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    coarse.farthest.assign(static_cast<std::size_t>(coarse.width) * coarse.height, 0);
    for (int y = 0; y < fine.height; ++y)
      for (int x = 0; x < fine.width; ++x) {
        float& farthest = coarse.farthest[static_cast<std::size_t>(y / 2) * coarse.width + x / 2];
        farthest = std::max(farthest, fine.farthest[static_cast<std::size_t>(y) * fine.width + x]);
      }
    levels_.push_back(std::move(coarse));
  }
}

bool DepthPyramid::hides(const SampleBox& box, float depth) const {
  const Level& finest = levels_.front();
  const auto square = [](float v, int count) {
    return static_cast<int>(std::clamp(v / kSquare, 0.f, static_cast<float>(count - 1)));
  };
  int left = square(box.low.x, finest.width), right = square(box.high.x, finest.width);
  int bottom = square(box.low.y, finest.height), top = square(box.high.y, finest.height);
  std::size_t level = 0;
  constexpr int kMost = 3;  // squares looked at along a side
  while (right - left >= kMost || top - bottom >= kMost) {
    left /= 2, right /= 2, bottom /= 2, top /= 2;
    ++level;
  }
  const Level& l = levels_[level];
  for (int y = bottom; y <= top; ++y)
    for (int x = left; x <= right; ++x)
      if (depth - kCloser <= l.farthest[static_cast<std::size_t>(y) * l.width + x]) return false;
  return true;
}

}  // namespace dapple
