// Points by the chunk: which of them a picture needs at all, and how large they look. Cheap,
// because points that follow each other lie together (Morton order); always on the safe side.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "app/render/splats.h"

namespace dapple {

// 64 points in a row; the last chunk may have fewer.
struct SplatChunk {
  static constexpr std::size_t kPoints = 64;

  vec3 centre{0};
  float reach = -1;  // from the centre to the farthest point; negative: nothing to draw
  float largestRadius = 0;
  vec3 normal{0};  // the sum of the points'
};

std::vector<SplatChunk> splatChunks(const SplatColumns& columns);

// The camera in samples: x to the right, y upwards, counted from the view axis.
struct SplatLens {
  glm::mat4 view{1};
  float focal = 1;  // samples; orthographic: samples per local unit
  bool orthographic = false;
  float nearest = 0, farthest = 1;
  float lowPass = 1;  // samples
  float enlarge = 1;
};

// A part of the picture.
struct SampleBox {
  glm::vec2 low{0}, high{0};  // samples from the view axis
};

// How a chunk looks: whatever its points may touch, the nearest that they may be.
struct ChunkImage {
  SampleBox box;  // of all their splats
  float nearest = 0;
  float radius = 0;  // samples, of the largest splat: infinite when it may lie around the eye
  bool drawn = false, away = false;  // away: most normals look away from the eye
};
ChunkImage chunkImage(const SplatChunk& chunk, const SplatLens& lens);

// How deep a drawn picture can be looked into: the farthest depth of squares of samples.
class DepthPyramid {
 public:
  // `depths`: of w x h samples, lowest row first, 0 (nearest) to 1 (farthest).
  void build(std::span<const float> depths, int width, int height);
  // True when all of the box lies behind what was drawn; in samples of the picture.
  bool hides(const SampleBox& box, float depth) const;

 private:
  struct Level {
    int width, height;
    std::vector<float> farthest;
  };
  std::vector<Level> levels_;
};

}  // namespace dapple
