// A document as a file for other programs.
#pragma once

#include "document/commands.h"

namespace dapple {

// The scan's file with the results as columns (textured_scan.h, channels.h). With a source map and
// blended borders there is one element more, "dapple_blend", a record for each texel that a border
// point mixes: vertex (int, its record), swatch (int), texel_x, texel_y, up_x, up_y, up_z, weight
// (float; those of a vertex sum to 1), level (float). Throws InvalidInput, IoError, Cancelled.
void exportScan(const Document& document, const ExportScan& command, Monitor& monitor);

}  // namespace dapple
