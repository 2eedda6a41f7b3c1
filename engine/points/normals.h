// Normals for scans that come without.
#pragma once

#include "base/monitor.h"
#include "points/neighborhoods.h"

namespace dapple {

// Unit normals by the smallest principal axis of the nearest `used` neighbours and the point
// itself; signs are arbitrary. n.
std::vector<vec3> estimateNormals(const std::vector<vec3>& positions,
                                  const Neighborhoods& neighborhoods, std::size_t used,
                                  Monitor& monitor);

// Makes the signs agree along the neighbour graph (minimum spanning tree over 1 - |n.m|; Hoppe et
// al. 1992), each connected part turned outward: its point that reaches furthest along an axis
// looks that way.
void orientNormals(const std::vector<vec3>& positions, const Neighborhoods& neighborhoods,
                   std::vector<vec3>& normals, Monitor& monitor);

// Positions moved to the tangent planes of their neighbourhoods: p - m (p - mean16).m, m the
// normal. Used for parametrization only (methods: section 1.2; real scans fail without it).
std::vector<vec3> smoothedPositions(const PointSet& points, const Neighborhoods& neighborhoods,
                                    Monitor& monitor);

}  // namespace dapple
