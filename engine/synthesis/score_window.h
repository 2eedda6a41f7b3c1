// What the score compares: 8 x 8 colours a step apart, from the surface or from the swatch.
#pragma once

#include <array>
#include <span>

#include "points/tangent_patch.h"
#include "swatch/texel_reader.h"

namespace dapple {

inline constexpr int kWindowSide = 8;
inline constexpr int kWindowNodes = kWindowSide * kWindowSide;
inline constexpr int kWindowNumbers = 3 * kWindowNodes;
inline constexpr float kWindowReach = 0.5f * (kWindowSide - 1);  // centre to outermost node, steps

// Node (row, column) lies at (column - 3.5, row - 3.5) steps along s and t from the centre.
struct Window {
  std::array<Float4, kWindowNodes> node;  // red, green, blue, 0
};

// Root mean square difference of all numbers of two windows.
float windowDistance(const Window& a, const Window& b);

// Sum of squared differences between nodes side by side.
float windowDetail(const Window& window);

// Resamples scattered colours to windows. The points are given once, their colours as often as
// there are windows over them.
class WindowSampler {
 public:
  // `points` around a centre, turned by `turn` (radians, counter-clockwise about the normal: where
  // the window's own axes lie), with `step` in the units of their positions.
  void place(std::span<const FlatPoint> points, float step, float turn);

  struct Sample {
    Index id;
    vec2 position;  // in the window's axes, units of the points
  };
  // The points that a window needs, in the order in which colours are given.
  const std::vector<Sample>& samples() const { return samples_; }

  // False when some node has no point near: the surface ends there.
  bool complete() const { return complete_; }

  // Gaussian average (sigma = half a step) of `colours` (one a sample) at every node.
  Window window(std::span<const Float4> colours) const;

 private:
  struct Weights {
    int corner;  // of the 4 x 4 nodes that the point reaches, in the padded grid
    Float4 column;
    std::array<float, 4> row;
  };
  std::vector<Sample> samples_;
  std::vector<Weights> weights_;
  std::array<float, kWindowNodes> total_{};
  bool complete_ = false;
};

}  // namespace dapple
