// Windows of the surface are flattened (points/tangent_patch), resampled to 8 x 8 colours, and
// looked for in the swatch. The same windows, with the same points, are also filled by a perfect
// mapping; what the perfect ones fail to reach is the measure's own noise, and the distribution of
// the actual ones is compared with theirs; a second perfect mapping tells how much two equally good
// ones differ by chance. (The methods' study used a separate plane of points for
// this; the windows' own points have the scan's density and irregularity wherever it varies.)
#include "synthesis/texture_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "points/tangent_patch.h"
#include "swatch/gaussian_blur.h"
#include "synthesis/score_patches.h"
#include "synthesis/score_seams.h"
#include "synthesis/sliced_distance.h"

namespace dapple {
namespace {

constexpr std::size_t kNeighbours = 14;
constexpr std::size_t kLeastPoints = 200;
constexpr std::size_t kLeastWindows = 20;
constexpr std::array<double, 3> kScales = {1, 2, 4};
// Points inside a turned window and under the Gaussians of its corners, and a margin to grow in.
constexpr float kReach = 5.7f, kMargin = 0.3f;  // steps
constexpr std::size_t kGrain = 16;              // evaluation points that are searched together
constexpr std::size_t kPerfectShare = 4;  // of so many windows one is also fitted as a perfect one
constexpr float kTolerance = 20 * std::numbers::pi_v<float> / 180;  // of the oriented figures
constexpr double kLeastThreshold = 0.3, kThresholdFactor = 1.5;
constexpr double kSlicedFloor = 0.045, kSlicedRange = 0.25;
constexpr double kThinned = 0.8;         // spacing aimed at where points are denser, pixels
constexpr double kPrefilterFrom = 1.05;  // pixels a point
constexpr float kUnfit = std::numeric_limits<float>::quiet_NaN();
constexpr int kFirstIterations = 3, kLastIterations = 8;

// One of the measure's six (free or oriented, three scales) and its results by evaluation point.
struct Judge {
  std::unique_ptr<ScorePatches> patches;
  bool oriented = false;
  std::uint64_t number = 0;
  std::vector<float> residual, perfectResidual;  // NaN where not fitted
  std::vector<PatchCode> codes, perfectCodes, secondCodes;
  std::vector<std::uint8_t> evaluated;

  const ScoreImage& image() const { return patches->image(); }
};

// Everything that the evaluation of a point reads.
struct Context {
  const ScoreInput& input;
  const ScoreOptions& options;
  // What a perfect mapping would read: the swatch, and the same as if it tiled, for the scales at
  // which it is too small for a window.
  const Swatch &perfect, &wrapped;
  std::vector<Index> centres;
  float radius = 0;  // of a flattened surrounding, local units
};

void checkInput(const ScoreInput& input, const ScoreOptions& options) {
  const std::size_t n = input.points.size();
  DAPPLE_CHECK(input.points.normals.size(), ==, n);
  DAPPLE_CHECK(input.colours.size(), ==, n);
  DAPPLE_CHECK(input.neighborhoods.size(), ==, n);
  if (n < kLeastPoints)
    throw InvalidInput(fmt::format(
        "score: {} points, but at least {} are needed. Score a denser scan", n, kLeastPoints));
  if (input.neighborhoods.k < kNeighbours)
    throw InvalidInput(fmt::format("score: {} neighbours a point, but at least {} are needed",
                                   input.neighborhoods.k, kNeighbours));
  if (!(input.unit > 0) || !std::isfinite(input.unit))
    throw InvalidInput(fmt::format(
        "score: a swatch pixel is {} long, but must be longer than 0. Give the scale", input.unit));
  if (options.evaluationPoints < 50 || options.evaluationPoints > 100000)
    throw InvalidInput(fmt::format("score: {} evaluation points are outside 50 to 100000",
                                   options.evaluationPoints));
}

// The ids with the smallest hashes: a seeded sample without repetition.
std::vector<Index> chooseCentres(std::size_t n, const ScoreOptions& options) {
  std::vector<std::pair<std::uint64_t, Index>> keys(n);
  for (std::size_t i = 0; i < n; ++i) keys[i] = {hashBits(options.seed, i), static_cast<Index>(i)};
  const std::size_t count = std::min(n, options.evaluationPoints);
  std::nth_element(keys.begin(), keys.begin() + (count - 1), keys.end());
  std::vector<Index> centres;
  for (std::size_t i = 0; i < count; ++i) centres.push_back(keys[i].second);
  std::sort(centres.begin(), centres.end());  // neighbours in memory one after the other
  return centres;
}

// Axes at a centre: t along its direction where there is one.
TangentFrame frameAt(const ScoreInput& input, Index i) {
  const vec3 n = input.points.normals[i];
  vec3 t(0);
  if (input.directions) t = (*input.directions)[i];
  t -= glm::dot(t, n) * n;
  if (!(glm::length(t) > 1e-6f)) {
    const vec3 axis = std::abs(n.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
    t = axis - glm::dot(axis, n) * n;
  }
  t = glm::normalize(t);
  return {glm::cross(t, n), t, n};
}

Float4 weighable(vec3 colour) {
  return Float4{colour.x, colour.y, colour.z, 0};
}

Window actualWindow(const Context& context, const WindowSampler& sampler) {
  std::vector<Float4> colours;
  for (const WindowSampler::Sample& sample : sampler.samples())
    colours.push_back(weighable(context.input.colours[sample.id]));
  return sampler.window(colours);
}

// The same points as a perfect mapping would colour them.
Window perfectWindow(const Context& context, const WindowSampler& sampler, bool wraps,
                     const Placement& placement) {
  const Swatch& swatch = wraps ? context.wrapped : context.perfect;
  const float height = static_cast<float>(swatch.height);
  std::vector<Float4> colours;
  for (const WindowSampler::Sample& sample : sampler.samples()) {
    const vec2 p = sample.position / context.input.unit;
    const vec2 at = placement.centre + p.x * placement.right + p.y * placement.up;
    colours.push_back(weighable(sampleSwatch(swatch, {at.x, height - at.y})));
  }
  return sampler.window(colours);
}

// Distance of a window to the nearest one of the swatch: all starts a few steps, the two best on.
float bestFit(const ScorePatches& patches, const Window& window, PatchStarts starts) {
  const ScoreImage& image = patches.image();
  std::array<std::pair<float, int>, kPatchStarts> ranks;
  for (int s = 0; s < kPatchStarts; ++s)
    ranks[s] = {image.refine(window, patches.limit(), kFirstIterations, starts[s]), s};
  std::partial_sort(ranks.begin(), ranks.begin() + 2, ranks.end());
  float best = ranks[0].first;
  for (int r = 0; r < 2; ++r)
    best = std::min(
        best, image.refine(window, patches.limit(), kLastIterations, starts[ranks[r].second]));
  return best;
}

// A window that waits to be searched for, and where its residual goes.
struct Query {
  Window window;
  float* residual;
};

void gatherWindows(const Context& context, std::span<const FlatPoint> flat, std::size_t e,
                   Judge& judge, std::vector<Query>& queries) {
  const ScoreImage& image = judge.image();
  const std::uint64_t seed = hashBits(context.options.seed, judge.number, 17);
  // Any orientation is as good as any other in the free measure, so none is preferred.
  const float turn =
      judge.oriented ? 0.0f : 2 * std::numbers::pi_v<float> * hashUniform(seed, e, 1);
  WindowSampler sampler;
  sampler.place(flat, image.step() * context.input.unit, turn);
  if (!sampler.complete()) return;
  const TurnLimit upright{judge.oriented ? 0.0f : 4.0f};
  const Window actual = actualWindow(context, sampler);
  const auto perfect = [&](std::uint64_t draw) {
    return perfectWindow(context, sampler, image.wraps(),
                         image.randomPlacement(upright, seed, 2 * e + draw));
  };
  const Window first = perfect(0);
  judge.evaluated[e] = 1;
  judge.codes[e] = judge.patches->encode(actual);
  judge.perfectCodes[e] = judge.patches->encode(first);
  judge.secondCodes[e] = judge.patches->encode(perfect(1));
  queries.push_back({actual, &judge.residual[e]});
  if (e % kPerfectShare == 0) queries.push_back({first, &judge.perfectResidual[e]});
}

void evaluate(const Context& context, std::size_t begin, std::size_t end,
              std::vector<Judge>& judges, Monitor& monitor) {
  TangentPatch patch(context.input.points, context.input.neighborhoods, kNeighbours);
  std::vector<std::vector<Query>> queries(judges.size());
  for (std::size_t e = begin; e < end; ++e) {
    monitor.checkpoint();
    const Index centre = context.centres[e];
    const auto flat = patch.grow(centre, frameAt(context.input, centre), context.radius);
    for (std::size_t j = 0; j < judges.size(); ++j)
      gatherWindows(context, flat, e, judges[j], queries[j]);
  }
  for (std::size_t j = 0; j < judges.size(); ++j) {
    monitor.checkpoint();
    std::vector<PatchCode> codes;
    for (const Query& query : queries[j]) codes.push_back(judges[j].patches->encode(query.window));
    const std::vector<PatchStarts> starts = judges[j].patches->search(codes);
    for (std::size_t q = 0; q < codes.size(); ++q)
      *queries[j][q].residual = bestFit(*judges[j].patches, queries[j][q].window, starts[q]);
  }
}

double percentile95(std::vector<double> values) {
  if (values.empty()) return 0;
  const std::size_t rank = (values.size() - 1) * 95 / 100;
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[rank];
}

ScaleScore summarise(const Judge& judge, std::uint64_t seed) {
  // A swatch of one colour has no contrast to compare with: then any difference counts in full.
  const double sigma = std::max(judge.image().contrast(), 1e-3);
  std::vector<double> residuals, perfect;
  std::vector<PatchCode> codes, perfectCodes, secondCodes;
  double sum = 0;
  for (std::size_t e = 0; e < judge.evaluated.size(); ++e) {
    if (!judge.evaluated[e]) continue;
    residuals.push_back(judge.residual[e] / sigma);
    sum += residuals.back();
    codes.push_back(judge.codes[e]);
    perfectCodes.push_back(judge.perfectCodes[e]);
    secondCodes.push_back(judge.secondCodes[e]);
    if (!std::isnan(judge.perfectResidual[e])) perfect.push_back(judge.perfectResidual[e] / sigma);
  }
  ScaleScore score{.step = judge.image().step()};
  score.windows = residuals.size();
  if (residuals.empty()) return score;
  const double count = static_cast<double>(residuals.size());
  score.residual = sum / count;
  score.residual95 = percentile95(residuals);
  for (double r : perfect) score.residualFloor += r / static_cast<double>(perfect.size());
  score.threshold = std::max(kLeastThreshold, kThresholdFactor * percentile95(perfect));
  for (double r : residuals) score.defects += r > score.threshold;
  score.defects /= count;
  // Two perfect samples against each other vary by 2 / n, one against a reference of both by 3 /
  // 2n.
  score.slicedNoise = std::sqrt(0.75) * slicedDistance(secondCodes, perfectCodes, seed);
  std::vector<PatchCode> reference = perfectCodes;
  reference.insert(reference.end(), secondCodes.begin(), secondCodes.end());
  score.sliced = slicedDistance(codes, reference, seed);
  return score;
}

double figureOfMerit(const ScaleScore& score) {
  // Departure: the floor rises with the noise, as the threshold of the defects does.
  const double floor = std::max(kSlicedFloor, score.slicedNoise);
  return (1 - score.defects) *
         std::max(0.0, 1 - std::max(0.0, score.sliced - floor) / kSlicedRange);
}

// Every so many-th point of a scan that is much denser than the swatch: one at random of each run
// along the Morton curve, so that they stay evenly spread.
struct Thinned {
  PointSet points;
  Neighborhoods neighborhoods;
  std::vector<vec3> colours, directions;

  ScoreInput input(const ScoreInput& full) const {
    return {points,
            neighborhoods,
            colours,
            full.swatch,
            full.unit,
            nullptr,
            full.directions ? &directions : nullptr};
  }
};

Thinned thin(const ScoreInput& full, std::size_t run, std::uint64_t seed, Monitor& monitor) {
  Thinned thinned;
  for (std::size_t begin = 0; begin + run <= full.points.size(); begin += run) {
    const std::size_t i = begin + hashBelow(run, seed, begin, 5);
    thinned.points.positions.push_back(full.points.positions[i]);
    thinned.points.normals.push_back(full.points.normals[i]);
    thinned.colours.push_back(full.colours[i]);
    if (full.directions) thinned.directions.push_back((*full.directions)[i]);
  }
  thinned.neighborhoods = buildNeighborhoods(thinned.points.positions, kNeighbours, monitor);
  return thinned;
}

std::vector<Judge> makeJudges(const Context& context,
                              const std::vector<std::unique_ptr<ScoreImage>>& images,
                              Monitor& monitor) {
  std::vector<Judge> judges;
  for (bool oriented : {false, true}) {
    if (oriented && !context.input.directions) continue;
    for (const auto& image : images) {
      Judge judge{.oriented = oriented, .number = judges.size()};
      const TurnLimit limit = oriented ? TurnLimit{kTolerance} : TurnLimit{};
      judge.patches = std::make_unique<ScorePatches>(*image, limit, context.options.seed, monitor);
      const std::size_t count = context.centres.size();
      judge.residual.assign(count, kUnfit);
      judge.perfectResidual.assign(count, kUnfit);
      judge.codes.resize(count);
      judge.perfectCodes.resize(count);
      judge.secondCodes.resize(count);
      judge.evaluated.assign(count, 0);
      judges.push_back(std::move(judge));
    }
  }
  return judges;
}

// The window figures: `spacing` is that of input.points.
TextureScore scoreWindows(const ScoreInput& input, const ScoreOptions& options, double spacing,
                          Monitor& monitor) {
  const double ratio = std::max(1.0, spacing / input.unit);
  // Where one point stands for several pixels, a perfect mapping reads them all.
  Swatch prefiltered = input.swatch;
  prefiltered.stack.resize(1);
  if (ratio > kPrefilterFrom) prefiltered.stack[0] = blurSwatch(input.swatch, 0.5 * ratio);
  Swatch wrapped = prefiltered;
  wrapped.tileable = true;
  Context context{input, options, prefiltered, wrapped,
                  chooseCentres(input.points.size(), options)};
  context.radius = static_cast<float>((kReach + kMargin) * ratio * kScales.back() * input.unit);
  std::vector<std::unique_ptr<ScoreImage>> images;
  for (double scale : kScales)
    images.push_back(std::make_unique<ScoreImage>(input.swatch, ratio * scale));
  std::vector<Judge> judges = makeJudges(context, images, monitor);

  monitor.begin(Stage::Score, context.centres.size());
  parallelFor(
      monitor, context.centres.size(), kGrain,
      [&](std::size_t begin, std::size_t end) { evaluate(context, begin, end, judges, monitor); },
      true);

  TextureScore score;
  for (std::size_t s = 0; s < kScales.size(); ++s)
    score.free[s] = summarise(judges[s], options.seed);
  if (score.free[1].windows < kLeastWindows)
    throw InvalidInput(fmt::format(
        "score: only {} windows of {:.0f} pixels fit on the surface, but {} are needed. Choose a "
        "smaller scale or a larger surface",
        score.free[1].windows, kWindowSide * score.free[1].step, kLeastWindows));
  score.F = figureOfMerit(score.free[1]);
  if (input.directions) {
    score.oriented.emplace();
    for (std::size_t s = 0; s < kScales.size(); ++s)
      (*score.oriented)[s] = summarise(judges[kScales.size() + s], options.seed);
    score.orientedF = figureOfMerit((*score.oriented)[1]);
  }
  return score;
}

}  // namespace

TextureScore scoreTexture(const ScoreInput& input, const ScoreOptions& options, Monitor& monitor) {
  checkInput(input, options);
  const double spacing = meanSpacing(input.neighborhoods);
  const auto run = static_cast<std::size_t>(std::pow(kThinned * input.unit / spacing, 2));
  TextureScore score;
  if (run >= 2 && input.points.size() / run >= kLeastPoints) {
    const Thinned thinned = thin(input, run, options.seed, monitor);
    score =
        scoreWindows(thinned.input(input), options, meanSpacing(thinned.neighborhoods), monitor);
  } else {
    score = scoreWindows(input, options, spacing, monitor);
  }
  if (input.map) {
    const SeamFigures figures = seamFigures(input, monitor);
    score.seamError = figures.seamError;
    score.breaks = figures.breaks;
    score.verbatim = figures.verbatim;
    score.gapContrast = figures.gapContrast;
  }
  return score;
}

}  // namespace dapple
