#include "document/export.h"

#include "base/errors.h"
#include "document/channels.h"
#include "document/corner_texture.h"
#include "document/export_format.h"

namespace dapple {
namespace {

// All texels of border points, their own included.
Element borderElement(const Document& document) {
  const Scan& scan = document.scan->prepared.scan;
  std::vector<std::int32_t> vertex, swatch;
  std::array<std::vector<float>, 7> numbers;
  std::vector<SourceTerm> terms;
  for (const Index point : document.results.border->points) {
    gatherTerms(document.results, point, terms);
    for (const SourceTerm& term : terms) {
      vertex.push_back(static_cast<std::int32_t>(scan.record[point]));
      swatch.push_back(term.source);
      const float values[] = {term.texel.x, term.texel.y, term.up.x, term.up.y,
                              term.up.z,    term.weight,  term.level};
      for (std::size_t c = 0; c < numbers.size(); ++c) numbers[c].push_back(values[c]);
    }
  }
  constexpr std::array kNames{"texel_x", "texel_y", "up_x", "up_y", "up_z", "weight", "level"};
  Element element{.name = std::string(kBorderElement), .count = vertex.size()};
  setColumn(element, "vertex", vertex);
  setColumn(element, "swatch", swatch);
  for (std::size_t c = 0; c < numbers.size(); ++c) setColumn(element, kNames[c], numbers[c]);
  return element;
}

}  // namespace

void exportScan(const Document& document, const ExportScan& command, Monitor& monitor) {
  const ScanFormat format = exportFormat(command.path);
  const SourceMap map = wholeMap(document);
  const Scan& scan = document.scan->prepared.scan;
  RecordTable table = texturedTable(scan, map, command.options, *document.results.source);
  if (command.options.channels) addChannels(table, scan, channelsOf(document, monitor));
  if (command.options.sourceMap && document.results.border)
    table.elements.push_back(borderElement(document));
  if (command.options.corners && format != ScanFormat::Xyz) {
    const CornerTexture corners = cornersOf(document.results, scan, monitor);
    addCorners(table, corners, textureFiles(corners, document.results, command.path));
  }
  for (std::size_t s = 0; s < document.results.sources.size(); ++s)
    table.comments.push_back(
        fmt::format("dapple swatch {} {}", s, document.results.sources[s]->reference.path));
  monitor.begin(Stage::Save, document.size());
  exportTable(command.path, table, command.ascii, monitor);
}

}  // namespace dapple
