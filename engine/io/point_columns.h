// What the columns of a file mean: positions, normals, colours and triangles by their usual names.
#pragma once

#include <string>
#include <vector>

#include "base/monitor.h"
#include "io/record_table.h"
#include "points/surface_mesh.h"

namespace dapple {

// The records of element "vertex" (N), as they are. `path` is for the messages. Throws IoError
// without such an element or without coordinates.
std::vector<dvec3> readPositions(const RecordTable& table, const std::string& path,
                                 Monitor& monitor);

// N unit vectors, (0,0,0) for what is none; empty when the file has no normals.
std::vector<vec3> readNormals(const RecordTable& table, Monitor& monitor);

// N colours within 0..1 from bytes, 16 bits, floats or the constant part of Gaussian splats; empty
// when the file has none.
std::vector<vec3> readColours(const RecordTable& table, Monitor& monitor);

// Triangles of record numbers: the elements "face" (cut into fans) and "tristrips". Throws IoError
// when one leads to no vertex.
SurfaceMesh readTriangles(const RecordTable& table, const std::string& path, Monitor& monitor);

}  // namespace dapple
