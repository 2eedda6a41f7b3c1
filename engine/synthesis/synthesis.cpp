#include "synthesis/synthesis.h"

#include <algorithm>

#include "base/errors.h"
#include "synthesis/baselines.h"
#include "synthesis/coordinate_synthesis.h"
#include "synthesis/grid_matching.h"
#include "synthesis/hybrid_synthesis.h"
#include "synthesis/neighborhood_matching.h"
#include "synthesis/patch_parameterization.h"
#include "synthesis/pattern_mapping.h"
#include "synthesis/seam_repair.h"
#include "synthesis/surface_sites.h"
#include "synthesis/tiling_synthesis.h"

namespace dapple {
namespace {

PatchOptions patchOptions(const TextureOptions& options) {
  return {.distortion = static_cast<float>(options.distortion),
          .sizeLimit = static_cast<float>(options.sizeLimit),
          .seed = options.seed};
}

MatchingOptions matchingOptions(const TextureOptions& options) {
  return {.coherent = options.coherent, .levels = options.levels, .seed = options.seed};
}

GridOptions gridOptions(const TextureOptions& options) {
  return {.size = options.grid,
          .assign = options.assign,
          .coherent = options.coherent,
          .seams = options.gridSeams,
          .neighbours = options.gridNeighbours,
          .seed = options.seed};
}

// The others have no seams, or no places.
bool repairs(const TextureOptions& options) {
  switch (options.method) {
    case Method::Hybrid:
    case Method::Patches:
    case Method::Grid:
    case Method::Match:
    case Method::Mapping:
    case Method::Tiling:
      return options.repair > 0;
    default:
      return false;
  }
}

// Lays points out where smoothing takes them to lie; the others do so where they are.
bool charts(const TextureOptions& options) {
  return options.method == Method::Hybrid || options.method == Method::Patches ||
         options.method == Method::Grid || options.method == Method::Mapping;
}

// Null: the swatch itself is shown, whatever the spacing.
LevelRule levelRule(Method method) {
  switch (method) {
    case Method::Match:
    case Method::Grid:
    case Method::Mapping:
      return filterLevel;
    case Method::Coordinates:
    case Method::Tiling:
      return siteLevel;
    default:
      return nullptr;
  }
}

RepairOptions repairOptions(const TextureOptions& options) {
  return {.width = static_cast<float>(options.repair), .level = levelRule(options.method)};
}

// Sets the levels that the colours were read at, where there are others than 0.
void noteLevels(const SynthesisInput& input, const TextureOptions& options, SourceMap& map) {
  map.level.clear();
  const bool matchesGaps = options.method == Method::Hybrid && options.gaps == GapFill::Match;
  const LevelRule rule = matchesGaps ? filterLevel : levelRule(options.method);
  if (!rule) return;
  std::vector<float> level = localSpacing(input.neighborhoods, input.points.positions);
  for (std::size_t i = 0; i < level.size(); ++i) {
    const bool read = !matchesGaps || map.state[i] == PointState::Matched;
    level[i] = read ? rule(level[i], input.unitAt(i)) : 0;
  }
  if (std::any_of(level.begin(), level.end(), [](float l) { return l > 0; }))
    map.level = std::move(level);
}

std::size_t passesOf(const TextureOptions& options) {
  const std::size_t more = repairs(options) ? 1 : 0;
  switch (options.method) {
    case Method::Hybrid:
      return hybridPasses(options.gaps) + more;
    case Method::Grid:
      return gridPasses(gridOptions(options)) + more;
    default:
      return 1 + more;
  }
}

// Coordinates take the memory for the columns only once they are found.
SourceMap startingMap(const SynthesisInput& input, Method method) {
  if (input.kept) return *input.kept;
  if (method == Method::Coordinates) return {.unit = input.unit};
  return emptySourceMap(input.points.size(), input.unit);
}

void note(const PatchStatistics& patches, std::size_t points, SynthesisStatistics& statistics) {
  statistics.patches = patches.patches;
  statistics.gapShare = static_cast<double>(patches.gapPoints) / static_cast<double>(points);
  statistics.meanDistortion = patches.meanDistortion;
  statistics.maxDistortion = patches.maxDistortion;
}

void note(const MappingStatistics& mapping, std::size_t points, SynthesisStatistics& statistics) {
  statistics.patches = mapping.clusters;
  statistics.forcedShare = static_cast<double>(mapping.forcedPoints) / static_cast<double>(points);
  statistics.matchedBorderError = mapping.matchedError;
  statistics.borderError = mapping.borderError;
}

}  // namespace

bool keepsPoints(const TextureOptions& options) {
  return options.method == Method::Hybrid || options.method == Method::Coordinates ||
         options.method == Method::Patches || options.method == Method::Match ||
         options.method == Method::Mapping;
}

float shownLevel(Method method, float spacing, float unit) {
  const LevelRule rule = levelRule(method);
  return rule ? rule(spacing, unit) : 0;
}

SynthesisResult synthesize(const SynthesisInput& given, const TextureOptions& options,
                           Monitor& monitor) {
  SynthesisInput asked = given;
  // Random directions are no field: each patch takes the one where it starts.
  asked.follow = options.follow && options.field != FieldMethod::Random;
  asked.symmetry = foldsOf(options.symmetry);
  const ChartedInput charted(asked, repairs(options) && charts(options), monitor);
  const SynthesisInput& input = charted.get();
  const std::size_t n = input.points.size();
  monitor.begin(Stage::Synthesis, n, passesOf(options));
  SynthesisResult result{.map = startingMap(input, options.method)};
  result.map.scale.assign(input.scale.begin(), input.scale.end());
  SourceMap& map = result.map;
  DAPPLE_CHECK(options.method == Method::Auto, ==, false);
  switch (options.method) {
    case Method::Auto:
      break;
    case Method::Hybrid: {
      const HybridOptions hybrid{.patches = patchOptions(options),
                                 .gaps = options.gaps,
                                 .expand = options.expand,
                                 .matching = matchingOptions(options)};
      note(synthesizeHybrid(input, hybrid, map, monitor).patches, n, result.statistics);
      break;
    }
    case Method::Patches:
      note(growPatches(input, patchOptions(options), map, monitor), n, result.statistics);
      blendGaps(input, map, monitor);
      break;
    case Method::Match:
      if (!input.kept) map.frame = input.frames;
      matchNeighborhoods(input, matchingOptions(options), map, monitor);
      break;
    case Method::Grid:
      result.statistics.patches = matchGrid(input, gridOptions(options), map, monitor).matches;
      break;
    case Method::Coordinates:
      synthesizeCoordinates(input, {.quality = options.passes, .seed = options.seed}, map, monitor);
      break;
    case Method::Tiling:
      synthesizeTiling(input, {.seed = options.seed}, map, monitor);
      break;
    case Method::Mapping:
      note(mapPattern(input, {.seed = options.seed}, map, monitor), n, result.statistics);
      break;
    case Method::Triplanar:
      projectTriplanar(input, map, monitor);
      break;
    case Method::Random:
      scatterTexels(input, options.seed, map, monitor);
      break;
  }
  noteLevels(input, options, map);
  if (repairs(options)) repairSeams(input, repairOptions(options), map, monitor);
  const auto matched = std::count(map.state.begin(), map.state.end(), PointState::Matched);
  result.statistics.matchedShare = static_cast<double>(matched) / static_cast<double>(n);
  return result;
}

}  // namespace dapple
