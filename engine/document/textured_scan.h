// A synthesis as columns of the scan's own file, and back.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "io/point_io.h"
#include "regions/orientation_field.h"
#include "synthesis/source_map.h"

namespace dapple {

struct ExportOptions {
  bool sourceMap = false;    // also swatch, texel, frame, scale, level, patch, state, error, order
  bool keepColours = false;  // the scan's own colours stay, as original_red ...
  bool channels = true;      // also the material channels that the swatches have (channels.h)
  bool corners = true;       // also where in the swatch a mesh's corners lie (corner_texture.h)
};

// Of a file with a source map and blended borders: the texels that border points mix (export.h).
inline constexpr std::string_view kBorderElement = "dapple_blend";

// scan.table with the result's colours (red green blue, 8 bits) and the unit in a comment. Records
// that were set aside are black when they have no position, else coloured as their twin.
// `source` (n): what the swatch column says of each point; empty: 0.
RecordTable texturedTable(const Scan& scan, const SourceMap& map, const ExportOptions& options,
                          std::span<const std::uint16_t> source = {});

// scan.table with the directions as the frame of a source map has them (frame_sx ... frame_tz) and,
// where the field has one, its scale.
RecordTable orientedTable(const Scan& scan, const OrientationField& field);

// What a file that texturedTable() wrote says of the scale: local units per swatch pixel.
std::optional<float> readUnit(const Scan& scan);

// The source map of a file that was written with one.
std::optional<SourceMap> readSourceMap(const Scan& scan);

// The vertex property "region" (an integer; below 0: in no region, kNone) by point.
std::optional<std::vector<Index>> readRegions(const Scan& scan);

}  // namespace dapple
