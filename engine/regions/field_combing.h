// One direction of each N-fold one, so that neighbours agree.
#pragma once

#include "points/point_graph.h"
#include "regions/strokes.h"

namespace dapple {

struct FoldedField {
  const PointSet& points;
  const PointGraph& graph;
  const std::vector<vec2>& powers;  // n, unit N-th powers (tangent_numbers.h)
  int folds;
  vec3 up;  // local axes, where nothing is drawn
};

// Roots (n, unit length). Each part of the graph is walked breadth first from its first mark, whose
// drawn direction it takes, or from its first point and the direction nearest to `up`; each further
// point takes the root nearest to that of the point from which it was reached. Throws Cancelled.
std::vector<vec2> combed(const FoldedField& field, std::span<const StrokeMark> marks,
                         const Monitor& monitor);

}  // namespace dapple
