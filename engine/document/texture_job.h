// From files to a textured scan: the steps that the command line and the editor share.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "io/point_io.h"
#include "points/neighborhoods.h"
#include "regions/orientation_field.h"
#include "swatch/material_maps.h"
#include "synthesis/synthesis.h"
#include "synthesis/texture_score.h"

namespace dapple {

struct StageSeconds {
  double load = 0, neighbours = 0, normals = 0, synthesis = 0, save = 0;
};

// A scan with all that its syntheses share.
struct PreparedScan {
  Scan scan;  // points.normals are there
  Neighborhoods neighborhoods;
  float spacing = 0;         // mean point spacing, local units
  bool normalsMade = false;  // the file had none
  StageSeconds seconds;      // load, neighbours, normals
};

using TakePoints = std::function<void(const PointSet&)>;

// Loads, finds `neighbours` of every point, makes missing normals (of the mesh where there is one,
// else fitted and oriented). `loaded`, if any, is called as soon as the file is read. Throws
// IoError, InvalidInput, Cancelled.
PreparedScan prepareScan(const std::filesystem::path& path, const LoadOptions& options,
                         int neighbours, const TakePoints& loaded, Monitor& monitor);

// The part of them that a field of directions is found by.
FieldOptions fieldOptionsOf(const TextureOptions& options);

// The directions that a synthesis with these options follows. Throws InvalidInput, Cancelled.
OrientationField directionsOf(const PointSet& points, const Neighborhoods& neighborhoods,
                              std::span<const Stroke> strokes, const TextureOptions& options,
                              Monitor& monitor);

// The heights that a synthesis with these options compares places by, beside the colours; null:
// none.
const std::vector<float>* heightsCompared(const MaterialMaps* maps, const TextureOptions& options);
// The swatch for it, with them as its relief; the same one when there are none.
std::shared_ptr<const Swatch> comparedSwatch(std::shared_ptr<const Swatch> swatch,
                                             const MaterialMaps* maps,
                                             const TextureOptions& options);

struct TexturedPoints {
  SourceMap map;
  SynthesisStatistics statistics;
  std::vector<TangentFrame> frames;  // that the synthesis was asked to follow
  double seconds = 0;
};

// Synthesizes a colour for every point. Throws InvalidInput, Cancelled.
TexturedPoints texturePoints(const PreparedScan& prepared, const Swatch& swatch,
                             std::span<const Stroke> strokes, const TextureOptions& options,
                             Monitor& monitor);

// Levels of the swatch's stack that texturePoints() may read with these options.
int stackLevels(const TextureOptions& options);

struct ScoreRequest {
  const std::vector<vec3>& colours;  // n
  const Swatch& swatch;
  float unit = 0;  // local units per swatch pixel
  const SourceMap* map = nullptr;
  const std::vector<TangentFrame>* frames = nullptr;  // directions for the oriented figures
  std::span<const float> scale = {};                  // n, times the unit; empty: 1 everywhere
};
// The measure of a result (methods: section 8). Throws InvalidInput, Cancelled.
TextureScore scorePoints(const PreparedScan& prepared, const ScoreRequest& request,
                         Monitor& monitor);

}  // namespace dapple
