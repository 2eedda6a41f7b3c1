// Strokes in a file of their own, for scripts and for other programs.
//
// JSON: {"format": "dapple-strokes", "version": 1, "strokes": [{"positions": [[x, y, z], ...],
// "weight": 1, "scale": 2, "region": "Roof"}, ...]}. Positions (two or more) are in the scan's own
// units, on the surface or near it; weight (above 0, 1 if left out), scale (above 0) and region may
// be left out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "points/neighborhoods.h"
#include "regions/strokes.h"

namespace dapple {

struct NamedStroke {
  Stroke stroke;
  std::string region;  // empty: none was named
};

// Reads such a file, or the strokes of a Dapple project that was made with this scan. Lines are
// laid onto the surface: points between the given ones are added about a spacing apart, each at its
// nearest point of the scan. Throws IoError; InvalidInput that names the file, the stroke (from 0)
// and what is wrong with it; Cancelled.
std::vector<NamedStroke> readStrokes(const std::filesystem::path& path, const PointSet& points,
                                     const Neighborhoods& neighborhoods, Monitor& monitor);

// Throws IoError.
void writeStrokes(const std::filesystem::path& path, const std::vector<NamedStroke>& strokes,
                  const PointSet& points);

// readStrokes() without the names, for what takes a scan as one region; none for an empty path.
std::vector<Stroke> strokesFrom(const std::filesystem::path& path, const PointSet& points,
                                const Neighborhoods& neighborhoods, Monitor& monitor);

}  // namespace dapple
