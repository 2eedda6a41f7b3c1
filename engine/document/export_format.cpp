#include "document/export_format.h"

#include <algorithm>
#include <array>

#include "base/errors.h"
#include "io/file_names.h"
#include "io/obj.h"
#include "io/output_file.h"
#include "io/xyz.h"

namespace dapple {
namespace {

constexpr std::array<std::string_view, 9> kTextColumns{"x",  "y",   "z",     "nx",  "ny",
                                                       "nz", "red", "green", "blue"};

// Names of the scan's own columns that text cannot take, with commas.
std::string otherColumns(const Scan& scan) {
  std::string names;
  for (const Property& property : scan.table.find("vertex")->properties)
    if (std::find(kTextColumns.begin(), kTextColumns.end(), property.name) == kTextColumns.end())
      names += (names.empty() ? "" : ", ") + property.name;
  return names;
}

// With its materials beside it, which are there first.
void exportObj(const std::filesystem::path& path, const RecordTable& table, OutputFile& file,
               Monitor& monitor) {
  const std::string text = objMaterials(table);
  const std::filesystem::path beside = std::filesystem::path(path).replace_extension(".mtl");
  writeObj(file, table, text.empty() ? std::string() : beside.filename().string(), monitor);
  monitor.checkpoint();
  if (!text.empty()) {
    OutputFile materials(beside);
    materials.write(text.data(), text.size());
    materials.commit();
  }
  file.commit();
}

}  // namespace

ScanFormat exportFormat(const std::filesystem::path& path) {
  const std::string extension = lowerExtension(path);
  std::error_code ignored;
  if (extension.empty() || extension == ".ply" ||
      std::filesystem::is_other(std::filesystem::status(path, ignored)))
    return ScanFormat::Ply;
  if (extension == ".obj") return ScanFormat::Obj;
  if (extension == ".xyz" || extension == ".txt") return ScanFormat::Xyz;
  throw IoError(path.string(), "", fmt::format("a scan cannot be written as \"{}\"", extension),
                "End the name in .ply, .obj or .xyz.");
}

void exportTable(const std::filesystem::path& path, const RecordTable& table, bool ascii,
                 Monitor& monitor) {
  const ScanFormat format = exportFormat(path);
  if (format == ScanFormat::Ply) return savePly(path, table, ascii, monitor);
  const Element* vertices = table.find("vertex");
  monitor.begin(Stage::Save, vertices ? vertices->count : 0);
  OutputFile file(path);
  if (format == ScanFormat::Obj) return exportObj(path, table, file, monitor);
  writeXyz(file, table, monitor);
  monitor.checkpoint();
  file.commit();
}

std::vector<std::string> exportLosses(ScanFormat format, const Scan& scan,
                                      const ExportOptions& options, bool channels) {
  std::vector<std::string> lines;
  if (channels && (!options.channels || format != ScanFormat::Ply))
    lines.push_back("The material channels of the swatches.");
  if (!scan.points.colours.empty() && (!options.keepColours || format != ScanFormat::Ply))
    lines.push_back("The scan's own colours: the new ones take their place.");
  const Element* faces = scan.table.find("face");
  const bool mesh = faces && faces->count > 0;
  if (format == ScanFormat::Ply && mesh && faces->find("texcoord"))
    lines.push_back("The scan's own texture coordinates: the new ones take their place.");
  if (format == ScanFormat::Ply) {
    if (!options.sourceMap) lines.push_back("Where in the swatch each point's colour comes from.");
    return lines;
  }
  lines.push_back("Where in the swatch each point's colour comes from.");
  if (const std::string names = otherColumns(scan); !names.empty())
    lines.push_back("The scan's other columns: " + names + ".");
  if (format == ScanFormat::Xyz && mesh)
    lines.push_back(fmt::format("The mesh: {} faces.", faces->count));
  if (format == ScanFormat::Obj)
    lines.push_back("Programs that know OBJ by its standard alone see no colours.");
  return lines;
}

}  // namespace dapple
