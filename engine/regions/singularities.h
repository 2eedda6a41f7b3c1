// Where a field of directions cannot be smooth.
#pragma once

#include <span>
#include <vector>

#include "regions/orientation_field.h"

namespace dapple {

struct Singularity {
  vec3 position;  // local units
  Index point;    // nearest to it
  int index = 0;  // turns of the direction on a way round it, in N-ths: N for a whole one
};

// Singularities of N-fold directions (frames' t, n), ascending by point. Found by adding up the
// turns of the direction round each point's neighbours; points that see the same one are merged and
// the turns counted again on a ring around them all. None at the rim of a scan, where there is no
// way round. On a closed surface without handles the indices sum to 2 N. Throws Cancelled.
std::vector<Singularity> singularities(const PointSet& points, const Neighborhoods& neighborhoods,
                                       std::span<const TangentFrame> frames, FieldSymmetry symmetry,
                                       Monitor& monitor);

struct KinkBounds {
  std::span<const Singularity> singularities;  // points nearer to one than `clearance` do not count
  float clearance = 0;                         // local units
  float degrees = 20;
};
// Share of the links between points (8 neighbours each) over which N-fold directions turn by more
// than `bounds.degrees`.
double kinkedShare(const PointSet& points, const Neighborhoods& neighborhoods,
                   std::span<const TangentFrame> frames, FieldSymmetry symmetry,
                   const KinkBounds& bounds);

}  // namespace dapple
