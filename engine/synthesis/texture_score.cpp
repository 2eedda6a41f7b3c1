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
#include "swatch/texel_reader.h"
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
constexpr std::size_t kGrain = 16;              // evaluation points
constexpr std::size_t kSearchGrain = 128;       // windows that are searched for together
constexpr std::size_t kPerfectShare = 4;  // of so many windows one is also fitted as a perfect one
// Of so many points one has a window of the coarsest scale: these are the dearest, and overlap
// most.
constexpr std::size_t kCoarsestShare = 2;
constexpr float kTolerance = 20 * std::numbers::pi_v<float> / 180;  // of the oriented figures
constexpr double kLeastThreshold = 0.3, kThresholdFactor = 1.5;
constexpr double kSlicedFloor = 0.045, kSlicedRange = 0.25;
constexpr double kThinned = 0.8;         // spacing aimed at where points are denser, pixels
constexpr double kPrefilterFrom = 1.05;  // pixels a point
constexpr float kUnfit = std::numeric_limits<float>::quiet_NaN();
constexpr int kFirstIterations = 3, kLastIterations = 8;

// A window that is searched for in the swatch.
struct Query {
  Window window;
  std::size_t point;
  bool perfect;
};

// One of the measure's six (free or oriented, three scales) and its results by evaluation point.
struct Judge {
  std::unique_ptr<PatchGrid> grid;
  std::unique_ptr<PatchCoder> coder;
  bool oriented = false;
  std::uint64_t number = 0;
  std::vector<std::vector<Query>> queries;       // a chunk of points each
  std::vector<float> residual, perfectResidual;  // NaN where not fitted
  std::vector<PatchCode> codes, perfectCodes, secondCodes;
  std::vector<std::uint8_t> evaluated;

  const ScoreImage& image() const { return grid->image(); }
};

// Everything that the evaluation of a point reads.
struct Context {
  const ScoreInput& input;
  const ScoreOptions& options;
  // What a perfect mapping would read: the swatch, and the same as if it tiled, for the scales at
  // which it is too small for a window.
  const TexelReader &perfect, &wrapped;
  std::vector<Index> centres;
  double ratio = 1;  // steps at the finest scale, pixels

  // Local units around a centre that the windows of a scale need.
  float reach(std::size_t scale) const {
    return static_cast<float>((kReach + kMargin) * ratio * kScales[scale] * input.unit);
  }
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
  // Windows around every point of a small scan would tell the same again and again.
  const std::size_t count = std::min((n + 1) / 2, options.evaluationPoints);
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

Window actualWindow(const Context& context, const WindowSampler& sampler) {
  std::vector<Float4> colours;
  colours.reserve(sampler.samples().size());
  for (const WindowSampler::Sample& sample : sampler.samples())
    colours.push_back(toFloat4(context.input.colours[sample.id]));
  return sampler.window(colours);
}

// The same points as a perfect mapping would colour them.
Window perfectWindow(const Context& context, const WindowSampler& sampler, bool wraps,
                     const Placement& placement) {
  const TexelReader& reader = wraps ? context.wrapped : context.perfect;
  const vec2 size(context.input.swatch.width, context.input.swatch.height);
  const float perUnit = 1 / context.input.unit;
  std::vector<Float4> colours;
  colours.reserve(sampler.samples().size());
  for (const WindowSampler::Sample& sample : sampler.samples()) {
    const vec2 p = sample.position * perUnit;
    const vec2 at = placement.centre + p.x * placement.right + p.y * placement.up;
    vec2 place(at.x - 0.5f, size.y - at.y - 0.5f);
    if (!wraps) place = glm::clamp(place, vec2(0), size - 1.0f);
    colours.push_back(reader.read(place.x, place.y));
  }
  return sampler.window(colours);
}

// Distance of a window to the nearest one of the swatch: all starts a few steps, the two best on.
float bestFit(const PatchGrid& grid, const Window& window, PatchStarts& starts) {
  const ScoreImage& image = grid.image();
  std::array<std::pair<float, int>, kPatchStarts> ranks;
  for (int s = 0; s < kPatchStarts; ++s)
    ranks[s] = {image.refine(window, grid.limit(), kFirstIterations, starts[s]), s};
  std::partial_sort(ranks.begin(), ranks.begin() + 2, ranks.end());
  float best = ranks[0].first;
  for (int r = 0; r < 2; ++r)
    best = std::min(best,
                    image.refine(window, grid.limit(), kLastIterations, starts[ranks[r].second]));
  return best;
}

void gatherWindows(const Context& context, std::span<const FlatPoint> flat, std::size_t e,
                   Judge& judge) {
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
  judge.codes[e] = judge.coder->encode(actual);
  judge.perfectCodes[e] = judge.coder->encode(first);
  judge.secondCodes[e] = judge.coder->encode(perfect(1));
  std::vector<Query>& queries = judge.queries[e / kGrain];
  queries.push_back({actual, e, false});
  if (e % kPerfectShare == 0) queries.push_back({first, e, true});
}

void gather(const Context& context, std::vector<Judge>& judges, Monitor& monitor) {
  const auto body = [&](std::size_t begin, std::size_t end) {
    TangentPatch patch(context.input.points, context.input.neighborhoods, kNeighbours);
    for (std::size_t e = begin; e < end; ++e) {
      monitor.checkpoint();
      const Index centre = context.centres[e];
      const bool all = e % kCoarsestShare == 0;
      const auto flat =
          patch.grow(centre, frameAt(context.input, centre), context.reach(all ? 2 : 1));
      for (std::size_t j = 0; j < judges.size(); ++j)
        if (all || j % kScales.size() < 2) gatherWindows(context, flat, e, judges[j]);
    }
  };
  parallelFor(monitor, context.centres.size(), kGrain, body, true);
}

// Finds the residuals of all windows of a judge. The swatch's own windows need some memory, so they
// are there for one judge at a time.
void fit(Judge& judge, std::size_t points, Monitor& monitor) {
  const ScorePatches patches(*judge.grid, *judge.coder, monitor);
  std::vector<const Query*> queries;
  for (const auto& chunk : judge.queries)
    for (const Query& query : chunk) queries.push_back(&query);
  parallelFor(monitor, queries.size(), kSearchGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<PatchCode> codes;
    for (std::size_t q = begin; q < end; ++q) {
      const Query& query = *queries[q];
      codes.push_back((query.perfect ? judge.perfectCodes : judge.codes)[query.point]);
    }
    std::vector<PatchStarts> starts = patches.search(codes, monitor);
    for (std::size_t q = begin; q < end; ++q) {
      monitor.checkpoint();
      const Query& query = *queries[q];
      (query.perfect ? judge.perfectResidual : judge.residual)[query.point] =
          bestFit(*judge.grid, query.window, starts[q - begin]);
    }
  });
  judge.queries.clear();
  judge.queries.shrink_to_fit();
  monitor.advance(points);
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
      judge.grid = std::make_unique<PatchGrid>(*image, limit, context.options.seed);
      judge.coder = std::make_unique<PatchCoder>(*judge.grid, monitor);
      const std::size_t count = context.centres.size();
      judge.queries.resize((count + kGrain - 1) / kGrain);
      judge.residual.assign(count, kUnfit);
      judge.perfectResidual.assign(count, kUnfit);
      judge.codes.resize(count);
      judge.perfectCodes.resize(count);
      judge.secondCodes.resize(count);
      judge.evaluated = std::vector<std::uint8_t>(count);
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
  const TexelReader perfectReader(prefiltered, 0), wrappedReader(wrapped, 0);
  const Context context{
      input, options, perfectReader, wrappedReader, chooseCentres(input.points.size(), options),
      ratio};
  std::vector<std::unique_ptr<ScoreImage>> images;
  for (double scale : kScales)
    images.push_back(std::make_unique<ScoreImage>(input.swatch, ratio * scale));
  std::vector<Judge> judges = makeJudges(context, images, monitor);

  const std::size_t count = context.centres.size();
  monitor.begin(Stage::Score, count * (1 + judges.size()));
  gather(context, judges, monitor);
  for (Judge& judge : judges) fit(judge, count, monitor);

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
