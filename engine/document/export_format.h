// The formats that a textured scan is exported to, and what each of them cannot hold.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "document/textured_scan.h"

namespace dapple {

enum class ScanFormat { Ply, Obj, Xyz };

// By the extension: .ply (or none, or a device), .obj, .xyz and .txt. Throws IoError for others.
ScanFormat exportFormat(const std::filesystem::path& path);

// Writes the table in the format that the name asks for; `ascii` is for PLY. Whole or not at all,
// as savePly(); of OBJ with texture coordinates a .mtl file, too. Throws IoError, Cancelled.
void exportTable(const std::filesystem::path& path, const RecordTable& table, bool ascii,
                 Monitor& monitor);

// A line for everything that was opened or made and will not be in the file. `channels`: the
// swatches have material channels.
std::vector<std::string> exportLosses(ScanFormat format, const Scan& scan,
                                      const ExportOptions& options, bool channels);

}  // namespace dapple
