#include "app/cli/report.h"

#include <sys/resource.h>

#include "document/options_table.h"
#include "io/output_file.h"

namespace dapple {
namespace {

using Json = nlohmann::ordered_json;

Json optionalNumber(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

std::uint64_t peakMemoryBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

Json optionsJson(const TextureOptions& options) {
  Json json = Json::object();
  for (const OptionRow& row : optionsTable())
    json[std::string(row.name)] = optionText(options, row);
  return json;
}

// Null when the method was named.
Json automaticJson(const ReportInput& input) {
  if (!input.analysis) return {};
  return {{"reasons", input.automatic.reasons},
          {"warnings", input.automatic.warnings},
          {"swatch", analysisJson(*input.analysis)}};
}

}  // namespace

Json analysisJson(const SwatchAnalysis& analysis) {
  return {{"pattern", patternName(analysis.kind())},
          {"tileable", analysis.tileable},
          {"contrast", analysis.contrast},
          {"feature", analysis.feature},
          {"anisotropy", analysis.anisotropy},
          {"grain", analysis.grain},
          {"symmetry", analysis.folds()},
          {"turned",
           {{"180", analysis.turned.half},
            {"90", analysis.turned.quarter},
            {"45", analysis.turned.eighth}}},
          {"regularity", analysis.regularity},
          {"lattice_fit", analysis.latticeFit},
          {"lattice", analysis.lattice},
          {"period", {analysis.period.x, analysis.period.y}}};
}

Json scoreJson(const TextureScore& score) {
  Json json{{"F", score.F},
            {"F_oriented", optionalNumber(score.orientedF)},
            {"c1", score.free[0].residual},
            {"c2", score.free[1].residual},
            {"c4", score.free[2].residual},
            {"defects", score.free[1].defects},
            {"sw", score.free[1].sliced},
            {"seam_error", optionalNumber(score.seamError)},
            {"breaks", optionalNumber(score.breaks)},
            {"verbatim", optionalNumber(score.verbatim)},
            {"gap_contrast", optionalNumber(score.gapContrast)},
            {"direction_error", nullptr}};
  if (const auto& error = score.direction)
    json["direction_error"] = {{"median", error->median},
                               {"p95", error->percentile95},
                               {"perfect_median", error->perfectMedian},
                               {"perfect_p95", error->perfect95}};
  return json;
}

double pointsPerSecond(const PreparedScan& prepared, const TexturedPoints& textured) {
  const double seconds = prepared.seconds.neighbours + prepared.seconds.normals + textured.seconds;
  return seconds > 0 ? static_cast<double>(prepared.scan.points.size()) / seconds : 0;
}

Json reportJson(const ReportInput& input) {
  const PreparedScan& prepared = input.prepared;
  const TexturedPoints& textured = input.textured;
  const double modelUnits = prepared.scan.points.modelUnits;
  const TextureOptions& options = input.automatic.options;
  const OptionRow* method = findOption("method");
  return {
      {"version", DAPPLE_VERSION},
      {"method", optionText(options, *method)},
      {"options", optionsJson(options)},
      {"auto", automaticJson(input)},
      {"seed", options.seed},
      {"threads", input.threads},
      {"points", prepared.scan.points.size()},
      {"duplicates", prepared.scan.duplicates},
      {"non_finite", prepared.scan.nonFinite},
      {"neighbours", prepared.neighborhoods.k},
      {"spacing", prepared.spacing * modelUnits},
      {"unit", textured.map.unit * modelUnits},
      {"seconds",
       {{"load", prepared.seconds.load},
        {"neighbours", prepared.seconds.neighbours},
        {"normals", prepared.seconds.normals},
        {"synthesis", textured.seconds},
        {"save", input.saveSeconds}}},
      {"points_per_second", pointsPerSecond(prepared, textured)},
      {"patches", textured.statistics.patches},
      {"gap_share", textured.statistics.gapShare},
      {"matched_share", textured.statistics.matchedShare},
      {"distortion",
       {{"mean", textured.statistics.meanDistortion}, {"max", textured.statistics.maxDistortion}}},
      {"mapping",
       {{"forced_share", textured.statistics.forcedShare},
        {"matched_border_error", textured.statistics.matchedBorderError},
        {"border_error", textured.statistics.borderError}}},
      {"peak_memory", peakMemoryBytes()},
      {"score", input.score ? scoreJson(*input.score) : Json()}};
}

void checkWritable(const std::string& path) {
  if (path.empty()) return;
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (!std::filesystem::is_other(status)) const OutputFile probe(path);
}

void writeTextFile(const std::string& path, const std::string& text) {
  OutputFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

}  // namespace dapple
