#include <fmt/format.h>

#include <memory>

#include "app/cli/cli.h"
#include "app/cli/report.h"
#include "base/errors.h"
#include "document/strokes_file.h"
#include "document/textured_scan.h"
#include "io/image_io.h"

namespace dapple {
namespace {

constexpr int kNeighbours = 25;

struct ScoreArguments {
  std::string scan, swatch, strokes;
  double unit = 0;
  bool json = false;
};

// The unit from the option, else from the file's comment.
float unitOf(const ScoreArguments& a, const Scan& scan) {
  if (a.unit > 0) return static_cast<float>(a.unit / scan.points.modelUnits);
  if (const auto unit = readUnit(scan)) return *unit;
  throw InvalidInput(fmt::format(
      "{}: no comment 'dapple unit' says how large a swatch pixel is on this scan; give --unit, in "
      "the scan's own units",
      a.scan));
}

void printScore(const TextureScore& score) {
  const nlohmann::ordered_json json = scoreJson(score);
  for (const auto& [key, value] : json.items())
    if (!value.is_null()) fmt::print("{:<13}{:.4f}\n", key, value.get<double>());
}

void runScore(const ScoreArguments& a, const TextureOptions& options, Monitor& monitor) {
  const Swatch swatch = readSwatch(a.swatch, options.tileable, 1);
  const PreparedScan prepared = prepareScan(a.scan, {}, kNeighbours, {}, monitor);
  const PointSet& points = prepared.scan.points;
  if (points.colours.empty())
    throw InvalidInput(
        fmt::format("{}: the points have no colours to score; texture the scan first", a.scan));
  const std::optional<SourceMap> map = readSourceMap(prepared.scan);
  // Against the directions that were asked for, as `texture` does; the patches' own frames would
  // only tell that a patch agrees with itself.
  const std::vector<Stroke> strokes =
      strokesFrom(a.strokes, points, prepared.neighborhoods, monitor);
  const OrientationField asked =
      directionsOf(points, prepared.neighborhoods, strokes, options, monitor);
  const TextureScore score =
      scorePoints(prepared,
                  {.colours = points.colours,
                   .swatch = swatch,
                   .unit = unitOf(a, prepared.scan),
                   .map = map ? &*map : nullptr,
                   .frames = options.field == FieldMethod::Random ? nullptr : &asked.frames,
                   .scale = asked.scale.empty() && map ? map->scale : asked.scale},
                  monitor);
  if (a.json)
    fmt::print("{}\n", scoreJson(score).dump(2));
  else
    printScore(score);
}

}  // namespace

Subcommand addScoreCommand(CLI::App& app, CommonOptions& common) {
  CLI::App* sub = app.add_subcommand(
      "score", "Measure how well a textured scan reproduces its swatch (F: 0 worst, 1 best).");
  auto a = std::make_shared<ScoreArguments>();
  sub->add_option("scan", a->scan, "textured scan")->required();
  sub->add_option("--swatch", a->swatch, "the image that it was textured from")->required();
  addStrokesOption(*sub, a->strokes);
  sub->add_option("--unit", a->unit,
                  "size of a swatch pixel in the scan's units [from the file's comment]")
      ->check(CLI::PositiveNumber);
  for (const char* name : {"tileable", "up", "field", "symmetry", "creases"})
    addTableOption(*sub, name, common);
  sub->add_flag("--json", a->json, "print JSON");
  addCommonOptions(*sub, common);
  return {sub, &common, [a, &common](Monitor& monitor) { runScore(*a, common.table, monitor); }};
}

}  // namespace dapple
