// Scans from files and back, whatever the format.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/monitor.h"
#include "io/record_table.h"
#include "points/point_set.h"
#include "points/surface_mesh.h"

namespace dapple {

struct LoadOptions {
  std::size_t samples = 0;  // > 0: area-uniform samples of a mesh in place of its vertices
  std::uint64_t seed = 1;   // of the samples
};

// A loaded scan. `points` holds what can be worked with: finite, distinct, Morton ordered; `record`
// leads back to the file's own order, in which everything is saved.
struct Scan {
  std::string path;
  std::string format;               // "ply", "obj", "xyz"
  PointSet points;                  // n
  SurfaceMesh mesh;                 // over points; empty for a bare point cloud. Triangles with a
                                    // vertex that was set aside are left out here (not on saving)
  RecordTable table;                // element "vertex" with N >= n records
  std::vector<std::size_t> record;  // n: the record of each point
  std::vector<Index> pointOf;       // N: the point of each record; a duplicate's is its twin's,
                                    // a non-finite record's is kNone
  std::size_t duplicates = 0;       // records with the position of an earlier one, once in local
                                    // coordinates (float: apart by less than 1e-7 of the extent)
  std::size_t nonFinite = 0;        // records with a NaN or infinite coordinate
};

// Reads PLY (ascii, little and big endian), OBJ or XYZ, by content first and extension second.
// points.normals stays empty when the file has none for most points, also when it has a mesh.
// Throws IoError, InvalidInput (no finite point; samples of something that is no mesh), Cancelled.
Scan loadScan(const std::filesystem::path& path, const LoadOptions& options, Monitor& monitor);

// Writes the table as PLY: binary little endian, or ascii with shortest round-trip numbers. Goes to
// a temporary file beside `path`, synced and renamed over it at the end: whatever happens, there is
// the old file or the new one. Throws IoError, Cancelled.
void savePly(const std::filesystem::path& path, const RecordTable& table, bool ascii,
             Monitor& monitor);

// A point column (n, in the order of scan.points) laid out by record (N); records without a point
// get `missing`.
template <class T>
std::vector<T> byRecord(const Scan& scan, const std::vector<T>& column, T missing) {
  std::vector<T> out(scan.pointOf.size(), missing);
  for (std::size_t r = 0; r < out.size(); ++r)
    if (scan.pointOf[r] != kNone) out[r] = column[scan.pointOf[r]];
  return out;
}

}  // namespace dapple
