// Points as the engine works on them: finite, distinct, in Morton order, in local coordinates.
#pragma once

#include <vector>

#include "base/monitor.h"
#include "base/types.h"

namespace dapple {

// Structure of arrays; all columns that are not empty have size() elements.
struct PointSet {
  std::vector<vec3> positions;  // n, local units
  std::vector<vec3> normals;    // n, unit length, outward; empty until known
  std::vector<vec3> colours;    // n, the scan's own, 0..1; empty when it has none

  // model coordinates = origin + modelUnits * local. modelUnits is a power of two that brings the
  // scan's largest extent into [1, 2), so that millimetres and metres give the same local bits
  // (up to the rounding of the file's own numbers) and coordinates far from 0 keep their precision.
  dvec3 origin{0};
  double modelUnits = 1;

  std::size_t size() const { return positions.size(); }
};

// Right-handed orthonormal axes on the surface: s x t = n. s runs along the swatch's rows to the
// right, t up its columns (image row = -t).
struct TangentFrame {
  vec3 s{1, 0, 0}, t{0, 1, 0}, n{0, 0, 1};
};

// The cell of each point (n) along the Morton (Z) curve of a grid of 2^21 cubes a side over their
// bounds. Positions are finite.
std::vector<std::uint64_t> mortonCodes(const std::vector<vec3>& positions, Monitor& monitor);

// Ids of the points in the order of their codes; ties by id.
std::vector<Index> orderByCode(const std::vector<std::uint64_t>& codes, Monitor& monitor);

// Both at once, on one thread and without a way to stop it.
std::vector<Index> mortonOrder(const std::vector<vec3>& positions);

}  // namespace dapple
