// Documents to and from project files (.dapple).
//
// A project is one PLY file, binary little endian: an open format with a tested reader, one file
// that appears whole or not at all, no further library. Its comments hold the settings as JSON, its
// elements the columns: "point" (one record for each point of the scan, in the engine's order),
// "stroke" and "blend". The scan and the swatches stay in their own files, named relative to the
// project and absolutely.
#pragma once

#include "document/apply.h"
#include "document/strokes_file.h"

namespace dapple {

inline constexpr int kProjectVersion = 1;

// Loads, prepares and hashes a scan. Throws IoError, InvalidInput, Cancelled.
OpenedScan openScan(const std::filesystem::path& path, const LoadOptions& load, int neighbours,
                    const TakePoints& loaded, Monitor& monitor);

// Throws InvalidInput (no scan is open), IoError, Cancelled; then the file is as it was.
void saveProject(const Document& document, const std::filesystem::path& path, Monitor& monitor);

// Throws IoError (cannot be read, not a PLY) and InvalidInput: another version, columns that do not
// fit, a scan that is not there or not the same; the message names the file, what is wrong and what
// to do. A swatch that is not there is noted (context.note): its region keeps its name and result.
Document loadProject(const OpenProject& command, const CommandContext& context, Monitor& monitor);

// The strokes of all regions of a project, without opening the rest. Throws IoError; InvalidInput,
// also when its scan has another number of points than `points`; Cancelled.
std::vector<NamedStroke> readProjectStrokes(const std::filesystem::path& path, std::size_t points,
                                            Monitor& monitor);

}  // namespace dapple
