// What an orientation field is solved on: the points' links, finest first, then the same by
// clusters of four, clusters of clusters, ... (methods: section 1.3).
//
// The links of a level are those of the level below, merged, not neighbours found anew: what does
// not hang together at the finest level (another sheet, the other side of a crease) never does.
#pragma once

#include <span>
#include <vector>

#include "points/point_graph.h"
#include "regions/field_options.h"

namespace dapple {

// Normals that look further apart (cosine) are of another sheet.
inline constexpr float kFacing = -0.2f;

// Directions as N-th powers of complex numbers (tangent_numbers.h).
struct FieldLevel {
  PointGraph graph;
  std::vector<vec2> turn;     // by link: carries the neighbour's direction here, times its weight
  std::vector<vec2> pull;     // n_l: towards `up`, with its weight
  std::vector<Index> parent;  // n_l, ids of the next level; empty at the last
  std::vector<vec2> fromParent;  // n_l: carries the parent's direction here, length 1

  std::size_t size() const { return graph.size(); }
};

// Where pulls point to, and how strong they are.
struct FieldCompass {
  vec3 up{0, 1, 0};  // unit length
  float reach = 1;   // local units
  int folds = 1;
};

struct FieldLevels {
  std::vector<FieldLevel> levels;
  std::vector<Index> part;  // by node of the last level: nodes of one part hang together
  FieldCompass compass;
};

// At most `depth` levels; fewer when there would be less than 16 nodes or they do not get fewer.
// Without turns and pulls of the finest, which take as much memory as all the rest and are not
// needed before its turn comes: connectFinest(). Throws Cancelled.
FieldLevels clusterField(const PointSet& points, const Neighborhoods& neighborhoods,
                         const FieldOptions& options, int depth, Monitor& monitor);

// `points` are those of clusterField(). Throws Cancelled, then nothing has changed.
void connectFinest(const PointSet& points, FieldLevels& field, Monitor& monitor);

// Both.
FieldLevels buildFieldLevels(const PointSet& points, const Neighborhoods& neighborhoods,
                             const FieldOptions& options, int depth, Monitor& monitor);

// Cosine of the angle between normals beyond which directions do not pass.
float facingOf(Creases creases);

// Levels by whether their nodes belong to a part without any of the `fixed` nodes of the last
// level. Empty vectors when there is no such part.
std::vector<std::vector<std::uint8_t>> freeParts(const FieldLevels& field,
                                                 std::span<const Index> fixed);

}  // namespace dapple
