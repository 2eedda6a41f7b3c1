#include "document/texture_job.h"

#include <algorithm>
#include <chrono>

#include "base/errors.h"
#include "document/automatic_options.h"
#include "document/options_table.h"
#include "points/normals.h"
#include "swatch/swatch_relief.h"

namespace dapple {
namespace {

constexpr std::size_t kNormalNeighbours = 16;
constexpr std::size_t kScoreNeighbours = 16;
constexpr int kFilterLevels = 4;  // of the swatch's stack, for points sparser than its pixels

class Stopwatch {
 public:
  // Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Vertices that no triangle touches take the mean of their neighbours' normals.
void fillMissing(const Neighborhoods& neighborhoods, std::vector<vec3>& normals) {
  const std::vector<vec3> known = normals;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (known[i] != vec3(0)) continue;
    vec3 sum(0);
    for (const Index j : neighborhoods.of(i)) sum += known[j];
    const float length = glm::length(sum);
    normals[i] = length > 0 ? sum / length : vec3(0, 0, 1);
  }
}

void makeNormals(Scan& scan, const Neighborhoods& neighborhoods, Monitor& monitor) {
  PointSet& points = scan.points;
  if (!scan.mesh.triangles.empty()) {
    points.normals = vertexNormals(points.positions, scan.mesh);
    const auto missing =
        static_cast<std::size_t>(std::count(points.normals.begin(), points.normals.end(), vec3(0)));
    if (missing < points.size() / 2) return fillMissing(neighborhoods, points.normals);
  }
  points.normals = estimateNormals(points.positions, neighborhoods, kNormalNeighbours, monitor);
  orientNormals(points.positions, neighborhoods, points.normals, monitor);
}

// Only here the file is known, and why its points are fewer than its records.
void checkEnough(const Scan& scan, int neighbours) {
  const std::size_t points = scan.points.size(), least = static_cast<std::size_t>(neighbours) + 1;
  if (points >= least) return;
  throw InvalidInput(fmt::format(
      "{}: {} of its {} points are finite and distinct, but {} neighbours need at least {}. Give a "
      "scan of more points, or fewer neighbours.",
      scan.path, points, scan.pointOf.size(), neighbours, least));
}

}  // namespace

PreparedScan prepareScan(const std::filesystem::path& path, const LoadOptions& options,
                         int neighbours, const TakePoints& loaded, Monitor& monitor) {
  Stopwatch watch;
  PreparedScan out;
  out.scan = loadScan(path, options, monitor);
  out.seconds.load = watch.lap();
  checkEnough(out.scan, neighbours);
  if (loaded) loaded(out.scan.points);
  out.neighborhoods =
      buildNeighborhoods(out.scan.points.positions, static_cast<std::size_t>(neighbours), monitor);
  out.spacing = static_cast<float>(meanSpacing(out.neighborhoods, out.scan.points.positions));
  out.seconds.neighbours = watch.lap();
  monitor.begin(Stage::Normals, out.scan.points.size());
  out.normalsMade = out.scan.points.normals.empty();
  if (out.normalsMade) makeNormals(out.scan, out.neighborhoods, monitor);
  out.seconds.normals = watch.lap();
  return out;
}

FieldOptions fieldOptionsOf(const TextureOptions& options) {
  return {.method = options.field,
          .symmetry = options.symmetry,
          .creases = options.creases,
          .up = options.up,
          .seed = options.seed};
}

OrientationField directionsOf(const PointSet& points, const Neighborhoods& neighborhoods,
                              std::span<const Stroke> strokes, const TextureOptions& options,
                              Monitor& monitor) {
  return orientPoints(points, neighborhoods, strokes, fieldOptionsOf(options), monitor);
}

const std::vector<float>* heightsCompared(const MaterialMaps* maps, const TextureOptions& options) {
  if (!maps || !maps->has(Channel::Height) || options.heightWeight <= 0) return nullptr;
  if (!findOption("height-weight")->countsIn(options)) return nullptr;
  return &maps->scalar[static_cast<std::size_t>(Channel::Height)];
}

std::shared_ptr<const Swatch> comparedSwatch(std::shared_ptr<const Swatch> swatch,
                                             const MaterialMaps* maps,
                                             const TextureOptions& options) {
  const std::vector<float>* heights = heightsCompared(maps, options);
  if (!heights) return swatch;
  return std::make_shared<const Swatch>(withRelief(*swatch, *heights, options.heightWeight));
}

TexturedPoints texturePoints(const PreparedScan& prepared, const Swatch& swatch,
                             std::span<const Stroke> strokes, const TextureOptions& options,
                             Monitor& monitor) {
  validate(options);
  Stopwatch watch;
  const PointSet& points = prepared.scan.points;
  TexturedPoints out;
  OrientationField field = directionsOf(points, prepared.neighborhoods, strokes, options, monitor);
  const float unit = prepared.spacing * static_cast<float>(options.scale);
  const std::vector<Index> starts = startsOf(strokes);
  const SynthesisInput input{.points = points,
                             .neighborhoods = prepared.neighborhoods,
                             .swatch = swatch,
                             .frames = field.frames,
                             .unit = unit,
                             .scale = field.scale,
                             .starts = starts};
  SynthesisResult result = synthesize(input, options, monitor);
  out.map = std::move(result.map);
  out.statistics = result.statistics;
  out.frames = std::move(field.frames);
  out.seconds = watch.lap();
  return out;
}

int stackLevels(const TextureOptions& options) {
  const bool chosen = options.method == Method::Auto && options.gaps == GapFill::Match;
  return std::max({options.levels, kFilterLevels, chosen ? kMostAutomaticLevels : 0});
}

TextureScore scorePoints(const PreparedScan& prepared, const ScoreRequest& request,
                         Monitor& monitor) {
  const PointSet& points = prepared.scan.points;
  Neighborhoods more;
  if (prepared.neighborhoods.k < kScoreNeighbours)
    more = buildNeighborhoods(points.positions, kScoreNeighbours, monitor);
  std::vector<vec3> directions;
  if (request.frames)
    for (const TangentFrame& frame : *request.frames) directions.push_back(frame.t);
  monitor.begin(Stage::Score, 0);
  return scoreTexture({.points = points,
                       .neighborhoods = more.k > 0 ? more : prepared.neighborhoods,
                       .colours = request.colours,
                       .swatch = request.swatch,
                       .unit = request.unit,
                       .map = request.map,
                       .directions = request.frames ? &directions : nullptr,
                       .scale = request.scale},
                      {}, monitor);
}

}  // namespace dapple
