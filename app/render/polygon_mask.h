// An outline in a picture, ready for many questions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/types.h"

namespace dapple {

// Even-odd rule; the outline closes itself and may cross itself. Exact, but most questions are
// answered by a grid whose cells lie wholly inside or outside.
class PolygonMask {
 public:
  // For pixels in 0..width, 0..height. Corners that are not finite are left out.
  PolygonMask(std::span<const vec2> corners, int width, int height);

  // What may lie inside; empty (low > high) when nothing does.
  vec2 low() const { return low_; }
  vec2 high() const { return high_; }
  // For pixels between low() and high().
  bool contains(vec2 pixel) const;

 private:
  enum Cell : std::uint8_t { kOutside, kInside, kMixed };
  struct Edge {
    vec2 a, b;
    bool crosses(float y) const { return (a.y > y) != (b.y > y); }
    float at(float y) const { return a.x + (y - a.y) * (b.x - a.x) / (b.y - a.y); }
  };
  void gatherRows();
  void markEdges();
  void fillRows();
  std::span<const Edge> edgesOf(int row) const {
    return {rowEdges_.data() + rowBegin_[static_cast<std::size_t>(row)],
            rowEdges_.data() + rowBegin_[static_cast<std::size_t>(row) + 1]};
  }
  Cell& cell(int column, int row) {
    return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  }
  int columnOf(float x) const;
  int rowOf(float y) const;

  vec2 low_{1}, high_{0};
  float side_ = 1, perSide_ = 1;  // of a cell, pixels, and its inverse
  int columns_ = 0, rows_ = 0;
  std::vector<Edge> edges_, rowEdges_;
  std::vector<std::size_t> rowBegin_;  // rows + 1
  std::vector<Cell> cells_;
};

}  // namespace dapple
