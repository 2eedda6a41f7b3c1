#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/cli/cli.h"
#include "app/cli/report.h"
#include "document/channels.h"
#include "document/texture_job.h"
#include "io/image_io.h"
#include "points/connected_parts.h"
#include "swatch/material_files.h"

namespace dapple {
namespace {

constexpr int kNeighbours = 16;
constexpr float kLinkSpacings = 4;  // points further apart are not of one component

struct InfoArguments {
  std::string scan;
  bool json = false;
};

// Scanned things are between a few millimetres and a few hundred metres across; formats have no
// unit, so that this can only be a guess from the size.
const char* unitGuess(double diagonal) {
  if (diagonal < 0.02) return "unknown (very small)";
  if (diagonal < 30) return "metres";
  if (diagonal < 10000) return "millimetres";
  return "unknown (very large)";
}

nlohmann::ordered_json describe(const PreparedScan& prepared) {
  const Scan& scan = prepared.scan;
  const PointSet& points = scan.points;
  dvec3 low(std::numeric_limits<double>::max()), high(-low);
  for (const vec3& p : points.positions) {
    const dvec3 model = points.origin + points.modelUnits * dvec3(p);
    low = glm::min(low, model), high = glm::max(high, model);
  }
  const auto parts =
      connectedParts(prepared.neighborhoods, points.positions, kLinkSpacings * prepared.spacing);
  return {{"file", scan.path},
          {"format", scan.format},
          {"records", scan.pointOf.size()},
          {"points", points.size()},
          {"triangles", scan.mesh.triangles.size()},
          {"bounds", {{"low", {low.x, low.y, low.z}}, {"high", {high.x, high.y, high.z}}}},
          {"diagonal", glm::length(high - low)},
          {"unit_guess", unitGuess(glm::length(high - low))},
          {"spacing", prepared.spacing * points.modelUnits},
          {"normals", !prepared.normalsMade},
          {"colour", !points.colours.empty()},
          {"components", parts.count},
          {"duplicates", scan.duplicates},
          {"non_finite", scan.nonFinite}};
}

// What `--method auto` goes by: of the folder of a material its heights as well.
nlohmann::ordered_json describeSwatch(const std::string& path, Monitor& monitor) {
  SwatchReference reference{.path = swatchFile(path).string()};
  if (reference.path != path) reference.channels = findChannels(reference.path);
  const Image image = readImage(reference.path);
  const auto maps = readMaps(reference, image, [](const auto& file) { return readImage(file); });
  const auto swatch =
      std::make_shared<const Swatch>(makeSwatch(image, Tileable::Auto, 1, reference.path));
  nlohmann::ordered_json info{{"file", path}, {"width", swatch->width}, {"height", swatch->height}};
  info.update(analysisJson(analyse(*comparedSwatch(swatch, maps.get(), {}), monitor)));
  return info;
}

void runInfo(const InfoArguments& a, Monitor& monitor) {
  const nlohmann::ordered_json info =
      isImageFile(a.scan) || std::filesystem::is_directory(a.scan)
          ? describeSwatch(a.scan, monitor)
          : describe(prepareScan(a.scan, {}, kNeighbours, {}, monitor));
  if (a.json) {
    fmt::print("{}\n", info.dump(2));
    return;
  }
  for (const auto& [key, value] : info.items())
    fmt::print("{:<12}{}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
}

}  // namespace

Subcommand addInfoCommand(CLI::App& app, CommonOptions& common) {
  CLI::App* sub = app.add_subcommand("info", "Describe a scan, or a swatch.");
  auto a = std::make_shared<InfoArguments>();
  sub->add_option("scan", a->scan, "point cloud or mesh: PLY, OBJ, XYZ; or an image")->required();
  sub->add_flag("--json", a->json, "print JSON");
  addCommonOptions(*sub, common);
  return {sub, &common, [a](Monitor& monitor) { runInfo(*a, monitor); }};
}

}  // namespace dapple
