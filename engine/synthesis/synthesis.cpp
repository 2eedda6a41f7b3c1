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

std::size_t passesOf(const TextureOptions& options) {
  switch (options.method) {
    case Method::Hybrid:
      return hybridPasses(options.gaps);
    case Method::Grid:
      return gridPasses(gridOptions(options));
    default:
      return 1;
  }
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

SynthesisResult synthesize(const SynthesisInput& given, const TextureOptions& options,
                           Monitor& monitor) {
  SynthesisInput input = given;
  // Random directions are no field: each patch takes the one where it starts.
  input.follow = options.follow && options.field != FieldMethod::Random;
  input.symmetry = foldsOf(options.symmetry);
  const std::size_t n = input.points.size();
  monitor.begin(Stage::Synthesis, n, passesOf(options));
  SynthesisResult result{.map = input.kept ? *input.kept : emptySourceMap(n, input.unit)};
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
  const auto matched = std::count(map.state.begin(), map.state.end(), PointState::Matched);
  result.statistics.matchedShare = static_cast<double>(matched) / static_cast<double>(n);
  return result;
}

}  // namespace dapple
