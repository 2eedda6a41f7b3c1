#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "app/cli/cli.h"
#include "app/cli/picture.h"
#include "app/cli/report.h"
#include "app/render/camera.h"
#include "base/errors.h"
#include "document/automatic_options.h"
#include "document/channels.h"
#include "document/corner_texture.h"
#include "document/export_format.h"
#include "document/options_table.h"
#include "document/strokes_file.h"
#include "document/textured_scan.h"
#include "io/image_io.h"
#include "swatch/material_files.h"

namespace dapple {
namespace {

struct TextureArguments {
  std::string scan, swatch, strokes, report, picture, view = "front", size = "1280x720",
                                                      show = "colour";
  DrawingArguments drawing;
  LoadOptions load;
  ExportScan exported;
  std::vector<std::string> channels;
  bool zUp = false, score = false;
};

void addFileOptions(CLI::App& app, TextureArguments& a) {
  app.add_option("scan", a.scan, "point cloud or mesh: PLY, OBJ, XYZ")->required();
  app.add_option(
         "--swatch", a.swatch,
         "sample image, 2 to 16384 pixels a side, or the folder of one material, whose maps "
         "are then written by point as by --channel auto")
      ->required();
  addStrokesOption(app, a.strokes);
  addExportOptions(app, a.exported);
  app.add_option("--samples", a.load.samples,
                 "spread this many points evenly over a mesh in place of its vertices");
  app.add_option(
         "--channel", a.channels,
         "KIND=IMAGE: a further image of the swatch, of the same size, to be written by "
         "point; roughness, height, metallic, ao, normal (OpenGL's) or normal-dx "
         "(DirectX's); can be repeated. auto: those beside the swatch by the usual names; none: "
         "not even those of a folder")
      ->allow_extra_args(false);
  app.add_option("--report", a.report, "write figures and score as JSON");
  app.add_flag("--score", a.score, "measure and print the score (with --report always)");
  app.add_option("--picture", a.picture, "also draw the result into this image");
  app.add_option("--view", a.view, "of the picture: " + viewDirectionNames("|"))
      ->capture_default_str();
  app.add_option("--size", a.size, "of the picture, WIDTHxHEIGHT")->capture_default_str();
  app.add_option("--show", a.show, "in the picture: " + viewNames("|"))->capture_default_str();
  app.add_flag("--z-up", a.zUp, "the scan's z axis points up: for the picture, and --up 0,0,1");
  addDrawingOptions(app, a.drawing);
}

PictureOptions pictureOptions(const TextureArguments& a) {
  PictureOptions options{.view = a.view,
                         .zUp = a.zUp,
                         .background = parseColour(a.drawing.background),
                         .show = viewNamed(a.show),
                         .renderer = a.drawing.renderer,
                         .texels = a.drawing.texels};
  if (!a.drawing.shading.empty()) options.shading = shadingNamed(a.drawing.shading);
  parseSize(a.size, options);
  checkPicture(options);
  return options;
}

Image pictureOf(const PreparedScan& prepared, const TexturedPoints& textured, const Swatch& swatch,
                const PictureOptions& options, Workers& workers) {
  const std::vector<Index> regions = readRegions(prepared.scan).value_or(std::vector<Index>{});
  const ViewColumns columns{.colours = textured.map.colour,
                            .normals = prepared.scan.points.normals,
                            .state = textured.map.state,
                            .patch = textured.map.patch,
                            .error = textured.map.error,
                            .order = textured.map.order,
                            .region = regions,
                            .texel = textured.map.texel,
                            .swatchSize = {swatch.width, swatch.height}};
  return drawPicture({.points = prepared.scan.points,
                      .neighborhoods = prepared.neighborhoods,
                      .columns = columns,
                      .map = &textured.map,
                      .swatch = &swatch},
                     options, workers);
}

void printChoice(const AutomaticOptions& automatic, const TextureOptions& given) {
  fmt::print("auto: {}\n", choiceText(automatic.options, given));
  for (const std::string& reason : automatic.reasons) fmt::print("  {}\n", reason);
  for (const std::string& warning : automatic.warnings) fmt::print("warning: {}\n", warning);
}

void printSummary(const TextureArguments& a, const PreparedScan& prepared,
                  const TexturedPoints& textured, const std::optional<TextureScore>& score) {
  const Scan& scan = prepared.scan;
  fmt::print("{} points textured at {:.0f} k points/s", scan.points.size(),
             pointsPerSecond(prepared, textured) / 1e3);
  if (textured.statistics.patches > 0)
    fmt::print("; {} patches, {:.1f} % gaps", textured.statistics.patches,
               textured.statistics.gapShare * 100);
  if (score) fmt::print("; score F {:.2f}", score->F);
  fmt::print("\n");
  if (prepared.normalsMade)
    fmt::print("no normals in the scan: {}\n",
               scan.mesh.triangles.empty() ? "estimated" : "made from its triangles");
  if (scan.duplicates > 0 || scan.nonFinite > 0)
    fmt::print("set aside: {} duplicate and {} non-finite points\n", scan.duplicates,
               scan.nonFinite);
  for (const std::string& path : {a.exported.path, a.picture, a.report})
    if (!path.empty()) fmt::print("{}\n", path);
}

SwatchReference referenceOf(const TextureArguments& a) {
  SwatchReference reference{.path = swatchFile(a.swatch).string()};
  ChannelPaths named, beside;
  if (reference.path != a.swatch) beside = findChannels(reference.path);
  for (const std::string& text : a.channels) {
    if (text == "auto" || text == "none") {
      beside = text == "auto" ? findChannels(reference.path) : ChannelPaths{};
      continue;
    }
    const std::size_t equals = text.find('=');
    if (equals == text.npos || equals + 1 == text.size())
      throw InvalidInput(
          fmt::format("--channel: '{}' is not allowed; give KIND=IMAGE, auto or none", text));
    std::string kind = text.substr(0, equals);
    named.greenDown |= kind == "normal-dx";
    if (kind == "normal-dx") kind = "normal";
    named[channelNamed(kind)] = text.substr(equals + 1);
  }
  reference.channels = beside;
  if (!named[Channel::Normal].empty()) reference.channels.greenDown = named.greenDown;
  for (std::size_t c = 0; c < kChannels; ++c)
    if (!named.paths[c].empty()) reference.channels.paths[c] = named.paths[c];
  return reference;
}

RecordTable tableOf(const TextureArguments& a, const PreparedScan& prepared, const SourceMap& map,
                    const ResultSource& source, Monitor& monitor) {
  RecordTable table = texturedTable(prepared.scan, map, a.exported.options);
  if (source.maps)
    addChannels(table, prepared.scan,
                channelsOf(map, source, prepared.scan.points.normals, monitor));
  if (!a.exported.options.corners || exportFormat(a.exported.path) == ScanFormat::Xyz) return table;
  if (!prepared.scan.table.find("face")) return table;  // results would copy the whole map
  ResultSource mapped = source;
  mapped.unit = map.unit;
  const Results results = resultsOf(map, mapped);
  const CornerTexture corners = cornersOf(results, prepared.scan, monitor);
  addCorners(table, corners, textureFiles(corners, results, a.exported.path));
  return table;
}

// So that nothing is refused only after the work.
void checkOutputs(const TextureArguments& a) {
  for (const std::string& path : {a.exported.path, a.picture, a.report}) checkWritable(path);
  exportFormat(a.exported.path);
  if (!a.picture.empty()) checkImageName(a.picture);
}

TextureScore scoreOf(const PreparedScan& prepared, const TexturedPoints& textured,
                     const Swatch& swatch, FieldMethod field, Monitor& monitor) {
  return scorePoints(prepared,
                     {.colours = textured.map.colour,
                      .swatch = swatch,
                      .unit = textured.map.unit,
                      .map = &textured.map,
                      // Against random directions there is nothing to measure.
                      .frames = field == FieldMethod::Random ? nullptr : &textured.frames,
                      .scale = textured.map.scale},
                     monitor);
}

void runTexture(const TextureArguments& a, const CommonOptions& common, Monitor& monitor) {
  TextureOptions given = common.table;
  if (a.zUp && given.up == TextureOptions{}.up) given.up = vec3(0, 0, 1);
  validate(given);
  const PictureOptions picture = pictureOptions(a);
  checkOutputs(a);
  ResultSource source{.reference = referenceOf(a)};
  const std::string& file = source.reference.path;
  const Image image = readImage(file);
  source.maps = readMaps(source.reference, image, [](const auto& path) { return readImage(path); });
  const auto made =
      std::make_shared<const Swatch>(makeSwatch(image, given.tileable, stackLevels(given), file));
  source.swatch = made;
  const Swatch& swatch = *made;
  const PreparedScan prepared = prepareScan(a.scan, a.load, given.neighbours, {}, monitor);
  const std::vector<Stroke> strokes =
      strokesFrom(a.strokes, prepared.scan.points, prepared.neighborhoods, monitor);
  std::optional<SwatchAnalysis> analysis;
  if (given.method == Method::Auto)
    analysis = analyse(*comparedSwatch(made, source.maps.get(), given), monitor);
  const AutomaticOptions automatic =
      chosenOptions(given, {.swatch = analysis.value_or(SwatchAnalysis{}),
                            .points = prepared.scan.points.size(),
                            .strokes = !strokes.empty(),
                            .kept = common.given});
  const TextureOptions& options = automatic.options;
  const TexturedPoints textured = texturePoints(
      prepared, *comparedSwatch(made, source.maps.get(), options), strokes, options, monitor);
  std::optional<TextureScore> score;
  if (a.score || !a.report.empty())
    score = scoreOf(prepared, textured, swatch, options.field, monitor);
  const auto saving = std::chrono::steady_clock::now();
  exportTable(a.exported.path, tableOf(a, prepared, textured.map, source, monitor),
              a.exported.ascii, monitor);
  const std::chrono::duration<double> saved = std::chrono::steady_clock::now() - saving;
  if (!a.picture.empty()) {
    monitor.begin(Stage::Render, 0);
    writeImage(a.picture, pictureOf(prepared, textured, swatch, picture, monitor.workers()));
  }
  if (!a.report.empty())
    writeTextFile(a.report, reportJson({.prepared = prepared,
                                        .textured = textured,
                                        .automatic = automatic,
                                        .analysis = analysis,
                                        .threads = monitor.workers().threads(),
                                        .saveSeconds = saved.count(),
                                        .score = score})
                                    .dump(2) +
                                "\n");
  if (!common.quiet && analysis) printChoice(automatic, given);
  if (!common.quiet) printSummary(a, prepared, textured, score);
}

}  // namespace

Subcommand addTextureCommand(CLI::App& app, CommonOptions& common) {
  CLI::App* sub = app.add_subcommand("texture", "Colour every point of a scan from a swatch.");
  auto arguments = std::make_shared<TextureArguments>();
  addFileOptions(*sub, *arguments);
  for (const OptionRow& row : optionsTable())
    if (row.name != "threads") addTableOption(*sub, row.name, common);
  addCommonOptions(*sub, common);
  return {sub, &common,
          [arguments, &common](Monitor& monitor) { runTexture(*arguments, common, monitor); }};
}

}  // namespace dapple
