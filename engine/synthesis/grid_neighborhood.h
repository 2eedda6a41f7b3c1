// The square around a point that is compared with the swatch: its surroundings projected onto the
// tangent plane and gathered at the nodes of a regular grid ([Zeng], "neighborhood").
#pragma once

#include <span>
#include <vector>

#include "synthesis/synthesis_input.h"

namespace dapple {

struct GridPoint {
  Index id;
  vec2 offset;  // from the centre, swatch pixels (x right, y down)
};

// One square at a time; keeps its memory between calls, so have one for each thread.
class GridNeighborhood {
 public:
  // `size` nodes along each side (odd), one swatch pixel apart. At most `neighbours` points are
  // projected, the nearest; 0: all that may reach a node. `input` must outlive this.
  GridNeighborhood(const SynthesisInput& input, int size, int neighbours);

  // Local units from the centre within which points are looked at.
  static float reachOf(int size, float unit);

  // The square around `centre`, its axes those of input.frames[centre].
  void gather(Index centre);

  // The points projected by gather(), the centre first.
  std::span<const GridPoint> points() const { return points_; }
  // size x size places in points(), rows from the top; kNone at nodes that no point is near to. A
  // point may be at several nodes.
  std::span<const Index> nodes() const { return nodes_; }
  // True for points inside the square: half a pixel beyond the outer nodes.
  bool covers(const GridPoint& point) const;

 private:
  void walk(Index centre, float reach);
  void keepNearest(Index centre);
  void fillNodes();

  const SynthesisInput& input_;
  const std::vector<vec3>& positions_;
  const int size_;
  const std::size_t neighbours_;
  std::vector<Index> stamp_;  // n: the last call that met the point
  Index call_ = 0;
  std::vector<Index> met_;
  std::vector<GridPoint> points_;
  std::vector<Index> nodes_;
  std::vector<float> nodeDistance2_;
};

}  // namespace dapple
