#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "app/cli/cli.h"
#include "app/cli/report.h"
#include "base/errors.h"
#include "document/export_format.h"
#include "document/strokes_file.h"
#include "document/texture_job.h"
#include "document/textured_scan.h"
#include "regions/singularities.h"

namespace dapple {
namespace {

constexpr float kClearSpacings = 5;  // around singularities, where directions have to turn

struct FieldArguments {
  std::string scan, strokes, output;
  bool ascii = false, zUp = false;
};

void printField(const PreparedScan& prepared, const std::vector<TangentFrame>& frames,
                FieldSymmetry symmetry, Monitor& monitor) {
  const PointSet& points = prepared.scan.points;
  const std::vector<Singularity> found =
      singularities(points, prepared.neighborhoods, frames, symmetry, monitor);
  int sum = 0;
  for (const Singularity& s : found) sum += s.index;
  const double kinked =
      kinkedShare(points, prepared.neighborhoods, frames, symmetry,
                  {.singularities = found, .clearance = kClearSpacings * prepared.spacing});
  fmt::print("{} points; {} singularities, their indices sum to {:g}; {:.2f} % of links kinked\n",
             points.size(), found.size(), static_cast<double>(sum) / foldsOf(symmetry),
             kinked * 100);
}

void runField(const FieldArguments& a, const CommonOptions& common, Monitor& monitor) {
  TextureOptions options = common.table;
  if (a.zUp && options.up == TextureOptions{}.up) options.up = vec3(0, 0, 1);
  validate(options);
  checkWritable(a.output);
  if (exportFormat(a.output) != ScanFormat::Ply)
    throw InvalidInput(fmt::format(
        "{}: only PLY files hold directions; give a name that ends with .ply", a.output));
  const PreparedScan prepared = prepareScan(a.scan, {}, options.neighbours, {}, monitor);
  const PointSet& points = prepared.scan.points;
  const std::vector<Stroke> strokes =
      strokesFrom(a.strokes, points, prepared.neighborhoods, monitor);
  monitor.begin(Stage::Synthesis, 0);
  const OrientationField field =
      directionsOf(points, prepared.neighborhoods, strokes, options, monitor);
  exportTable(a.output, orientedTable(prepared.scan, field), a.ascii, monitor);
  if (common.quiet) return;
  printField(prepared, field.frames, options.symmetry, monitor);
  fmt::print("{}\n", a.output);
}

}  // namespace

Subcommand addFieldCommand(CLI::App& app, CommonOptions& common) {
  CLI::App* sub = app.add_subcommand(
      "field", "Write the directions that a swatch would follow on a scan, and say how smooth.");
  auto a = std::make_shared<FieldArguments>();
  sub->add_option("scan", a->scan, "point cloud or mesh: PLY, OBJ, XYZ")->required();
  addStrokesOption(*sub, a->strokes);
  sub->add_option("-o,--output", a->output, "scan with the directions as columns to write: .ply")
      ->required();
  sub->add_flag("--ascii", a->ascii, "write the PLY as text");
  sub->add_flag("--z-up", a->zUp, "the scan's z axis points up: --up 0,0,1");
  for (const char* name : {"field", "symmetry", "creases", "up", "neighbours", "seed"})
    addTableOption(*sub, name, common);
  addCommonOptions(*sub, common);
  return {sub, &common, [a, &common](Monitor& monitor) { runField(*a, common, monitor); }};
}

}  // namespace dapple
