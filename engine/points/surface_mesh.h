// Triangles over a point list: what a mesh file adds to its vertices.
#pragma once

#include <array>
#include <vector>

#include "base/types.h"

namespace dapple {

struct SurfaceMesh {
  std::vector<std::array<Index, 3>> triangles;  // ids into a list of positions
};

// Area-weighted vertex normals (n, unit length; (0,0,0) where no triangle with an area touches).
std::vector<vec3> vertexNormals(const std::vector<vec3>& positions, const SurfaceMesh& mesh);

struct SurfaceSamples {
  std::vector<dvec3> positions;  // m
  std::vector<vec3> normals;     // m, of the triangle
};

// `count` points spread evenly by area over the triangles, deterministic for a seed: stratified by
// area along the triangle list (each triangle gets its share, rounded up or down), uniform inside
// each triangle. Throws InvalidInput if no triangle has an area.
SurfaceSamples sampleMesh(const std::vector<dvec3>& positions, const SurfaceMesh& mesh,
                          std::size_t count, std::uint64_t seed);

}  // namespace dapple
