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
#include "synthesis/score_direction.h"
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
// Departure: 0.3 in the study, under which most mirrored windows of round shapes went as good.
constexpr double kLeastThreshold = 0.25, kThresholdFactor = 1.5;
constexpr double kLeastDetail = 0.85;  // of a perfect mapping's, that goes without a penalty
constexpr double kSlicedFloor = 0.045, kSlicedRange = 0.25;
constexpr double kSlicedWindows = 1500;  // that the floor is for
constexpr double kThinned = 0.8;         // spacing aimed at where points are denser, pixels
constexpr double kPrefilterFrom = 1.05;  // pixels a point
constexpr float kUnfit = std::numeric_limits<float>::quiet_NaN();
constexpr int kFirstIterations = 3, kLastIterations = 8;
constexpr std::size_t kLinks = 6;
constexpr int kRounds = 2;
constexpr double kWellFit = 0.1;  // contrasts: a residual that no other placement much improves

// A window that is searched for in the swatch, around evaluation point `point`.
struct Query {
  Window window;
  std::size_t point;
};

// Another evaluation point near one: where it lies, and its frame's angle there, as seen from the
// first, along whose frame the way leads.
struct Link {
  std::size_t point;
  vec2 position;
  float angle;
};

// One of the measure's six (free or oriented, three scales) and its results by evaluation point.
struct Judge {
  std::unique_ptr<PatchGrid> grid;
  std::unique_ptr<PatchCoder> coder;
  bool oriented = false;
  std::uint64_t number = 0;
  std::vector<std::vector<Query>> queries;       // a chunk of points each
  std::vector<float> residual, perfectResidual;  // NaN where not fitted
  std::vector<Placement> found;                  // where the residual was reached
  std::vector<PatchCode> codes, perfectCodes, secondCodes;
  std::vector<float> detail, perfectDetail;
  std::vector<StructureTensor> tensor, perfectTensor;  // oriented only
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
  double ratio = 1;                        // steps at the finest scale, pixels
  std::vector<std::vector<Link>> links{};  // an evaluation point each

  // Local units around a centre that the windows of a scale need.
  float reach(std::size_t scale, Index centre) const {
    return static_cast<float>((kReach + kMargin) * ratio * kScales[scale] * input.unitAt(centre));
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
Window perfectWindow(const Context& context, const WindowSampler& sampler, float unit, bool wraps,
                     const Placement& placement) {
  const TexelReader& reader = wraps ? context.wrapped : context.perfect;
  const vec2 size(context.input.swatch.width, context.input.swatch.height);
  const float perUnit = 1 / unit;
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

// Any orientation is as good as any other in the free measure, so none is preferred.
float turnOf(const Context& context, const Judge& judge, std::size_t e) {
  if (judge.oriented) return 0;
  return 2 * std::numbers::pi_v<float> *
         hashUniform(hashBits(context.options.seed, judge.number, 17), e, 1);
}

struct Fit {
  float residual = std::numeric_limits<float>::infinity();
  Placement placement;
};

// The nearest window of the swatch from any of the starts: all a few steps, the two best on.
Fit bestFit(const PatchGrid& grid, const Window& window, std::span<Placement> starts) {
  const ScoreImage& image = grid.image();
  std::vector<std::pair<float, std::size_t>> ranks(starts.size());
  for (std::size_t s = 0; s < starts.size(); ++s)
    ranks[s] = {image.refine(window, grid.limit(), kFirstIterations, starts[s]), s};
  const std::size_t kept = std::min<std::size_t>(2, starts.size());
  std::partial_sort(ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(kept), ranks.end());
  Fit best;
  for (std::size_t r = 0; r < kept; ++r) {
    Placement& placement = starts[ranks[r].second];
    const float residual = image.refine(window, grid.limit(), kLastIterations, placement);
    if (residual < best.residual) best = {residual, placement};
  }
  return best;
}

void gatherWindows(const Context& context, std::span<const FlatPoint> flat, std::size_t e,
                   Judge& judge) {
  const ScoreImage& image = judge.image();
  const std::uint64_t seed = hashBits(context.options.seed, judge.number, 17);
  WindowSampler sampler;
  const float unit = context.input.unitAt(context.centres[e]);
  sampler.place(flat, image.step() * unit, turnOf(context, judge, e));
  if (!sampler.complete()) return;
  const TurnLimit upright{judge.oriented ? 0.0f : 4.0f};
  const Window actual = actualWindow(context, sampler);
  const auto truth = [&](std::uint64_t draw) {
    return image.randomPlacement(upright, seed, 2 * e + draw);
  };
  Placement placement = truth(0);
  const Window first = perfectWindow(context, sampler, unit, image.wraps(), placement);
  const Window second = perfectWindow(context, sampler, unit, image.wraps(), truth(1));
  judge.evaluated[e] = 1;
  judge.codes[e] = judge.coder->encode(actual);
  judge.perfectCodes[e] = judge.coder->encode(first);
  judge.secondCodes[e] = judge.coder->encode(second);
  if (judge.oriented)
    judge.tensor[e] = structureTensor(actual), judge.perfectTensor[e] = structureTensor(first);
  judge.detail[e] = windowDetail(actual);
  judge.perfectDetail[e] = 0.5f * (windowDetail(first) + windowDetail(second));
  judge.queries[e / kGrain].push_back({actual, e});
  if (e % kPerfectShare == 0)
    judge.perfectResidual[e] =
        bestFit(*judge.grid, first, std::span<Placement>(&placement, 1)).residual;
}

// Those of the points that are evaluation points themselves; the nearest few.
std::vector<Link> linksOf(const Context& context, const TangentPatch& patch,
                          std::span<const FlatPoint> flat) {
  std::vector<Link> links;
  for (std::size_t i = 1; i < flat.size() && links.size() < kLinks; ++i) {
    const auto at = std::lower_bound(context.centres.begin(), context.centres.end(), flat[i].id);
    if (at == context.centres.end() || *at != flat[i].id) continue;
    const TangentFrame carried = patch.carriedFrame(i), own = frameAt(context.input, flat[i].id);
    links.push_back({static_cast<std::size_t>(at - context.centres.begin()), flat[i].position,
                     std::atan2(glm::dot(own.s, carried.t), glm::dot(own.s, carried.s))});
  }
  return links;
}

void gather(Context& context, std::vector<Judge>& judges, Monitor& monitor) {
  const auto body = [&](std::size_t begin, std::size_t end) {
    TangentPatch patch(context.input.points, context.input.neighborhoods, kNeighbours);
    for (std::size_t e = begin; e < end; ++e) {
      monitor.checkpoint();
      const Index centre = context.centres[e];
      const bool all = e % kCoarsestShare == 0;
      const auto flat =
          patch.grow(centre, frameAt(context.input, centre), context.reach(all ? 2 : 1, centre));
      context.links[e] = linksOf(context, patch, flat);
      for (std::size_t j = 0; j < judges.size(); ++j)
        if (all || j % kScales.size() < 2) gatherWindows(context, flat, e, judges[j]);
    }
  };
  parallelFor(monitor, context.centres.size(), kGrain, body, true);
}

// Where a window would lie if the swatch went on from the windows near by.
std::vector<Placement> continued(const Context& context, const Judge& judge, std::size_t e) {
  std::vector<Placement> starts;
  const float turn = turnOf(context, judge, e);
  for (const Link& link : context.links[e]) {
    // Not what is worse off itself.
    if (!(judge.residual[link.point] < judge.residual[e])) continue;
    const Placement& from = judge.found[link.point];
    const float angle = link.angle + turnOf(context, judge, link.point) - turn;
    const float c = std::cos(angle), s = std::sin(angle);
    Placement start;
    start.right = c * from.right - s * from.up;
    start.up = s * from.right + c * from.up;
    const vec2 p = link.position / context.input.unitAt(context.centres[e]);
    const vec2 way(std::cos(turn) * p.x + std::sin(turn) * p.y,
                   std::cos(turn) * p.y - std::sin(turn) * p.x);
    start.centre = from.centre - way.x * start.right - way.y * start.up;
    starts.push_back(start);
  }
  return starts;
}

// A window that the search missed, or found only nearly, is often where its neighbours' ones lead.
void fitOn(const Context& context, Judge& judge, std::span<const Query* const> queries,
           Monitor& monitor) {
  std::vector<Fit> fits(queries.size());
  const float enough = static_cast<float>(kWellFit * judge.image().contrast());
  parallelFor(monitor, queries.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      if (judge.residual[queries[q]->point] <= enough) continue;
      std::vector<Placement> starts = continued(context, judge, queries[q]->point);
      fits[q] = bestFit(*judge.grid, queries[q]->window, starts);
    }
  });
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const std::size_t e = queries[q]->point;
    if (!(fits[q].residual < judge.residual[e])) continue;
    judge.residual[e] = fits[q].residual;
    judge.found[e] = fits[q].placement;
  }
}

// Finds the residuals of all windows of a judge. The swatch's own windows need some memory, so they
// are there for one judge at a time.
void fit(const Context& context, Judge& judge, Monitor& monitor) {
  const ScorePatches patches(*judge.grid, *judge.coder, monitor);
  std::vector<const Query*> queries;
  for (const auto& chunk : judge.queries)
    for (const Query& query : chunk) queries.push_back(&query);
  parallelFor(monitor, queries.size(), kSearchGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<PatchCode> codes;
    for (std::size_t q = begin; q < end; ++q) codes.push_back(judge.codes[queries[q]->point]);
    std::vector<PatchStarts> starts = patches.search(codes, monitor);
    for (std::size_t q = begin; q < end; ++q) {
      monitor.checkpoint();
      const Fit best = bestFit(*judge.grid, queries[q]->window, starts[q - begin]);
      judge.residual[queries[q]->point] = best.residual;
      judge.found[queries[q]->point] = best.placement;
    }
  });
  for (int round = 0; round < kRounds; ++round) fitOn(context, judge, queries, monitor);
  judge.queries.clear();
  judge.queries.shrink_to_fit();
  monitor.advance(context.centres.size());
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
  double sum = 0, detail = 0, perfectDetail = 0;
  for (std::size_t e = 0; e < judge.evaluated.size(); ++e) {
    if (!judge.evaluated[e]) continue;
    detail += judge.detail[e];
    perfectDetail += judge.perfectDetail[e];
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
  score.detail = perfectDetail > 0 ? std::sqrt(detail / perfectDetail) : 1;
  // Two perfect samples against each other vary by 2 / n, one against a reference of both by 3 /
  // 2n.
  score.slicedNoise = std::sqrt(0.75) * slicedDistance(secondCodes, perfectCodes, seed);
  std::vector<PatchCode> reference = perfectCodes;
  reference.insert(reference.end(), secondCodes.begin(), secondCodes.end());
  score.sliced = slicedDistance(codes, reference, seed);
  return score;
}

double figureOfMerit(const std::array<ScaleScore, 3>& scales) {
  const ScaleScore& score = scales[1];
  // Departure: the floor rises with the noise, as the threshold of the defects does. One pair of
  // mappings alone tells the noise badly, so it also rises as chance would have it.
  const double chance =
      std::sqrt(std::max(1.0, kSlicedWindows / static_cast<double>(score.windows)));
  const double floor = std::max(kSlicedFloor * chance, score.slicedNoise);
  const double likeness = std::max(0.0, 1 - std::max(0.0, score.sliced - floor) / kSlicedRange);
  // Departure: blur leaves the windows of step 2 nearly as they are, but not those of step 1.
  const double sharpness = std::min(1.0, scales[0].detail / kLeastDetail);
  return (1 - score.defects) * likeness * sharpness;
}

// Every so many-th point of a scan that is much denser than the swatch: one at random of each run
// along the Morton curve, so that they stay evenly spread.
struct Thinned {
  PointSet points;
  Neighborhoods neighborhoods;
  std::vector<vec3> colours, directions;
  std::vector<float> scale;

  ScoreInput input(const ScoreInput& full) const {
    return {points,
            neighborhoods,
            colours,
            full.swatch,
            full.unit,
            nullptr,
            full.directions ? &directions : nullptr,
            scale};
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
    if (!full.scale.empty()) thinned.scale.push_back(full.scale[i]);
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
      judge.found.resize(count);
      judge.detail.resize(count);
      judge.perfectDetail.resize(count);
      judge.codes.resize(count);
      judge.perfectCodes.resize(count);
      judge.secondCodes.resize(count);
      judge.evaluated = std::vector<std::uint8_t>(count);
      if (oriented) judge.tensor.resize(count), judge.perfectTensor.resize(count);
      judges.push_back(std::move(judge));
    }
  }
  return judges;
}

// The window figures: `spacing` is that of input.points.
TextureScore scoreWindows(const ScoreInput& input, const ScoreOptions& options, double spacing,
                          Monitor& monitor) {
  const double ratio = std::max(1.0, spacing / meanUnit(input.unit, input.scale));
  // Where one point stands for several pixels, a perfect mapping reads them all.
  Swatch prefiltered = input.swatch;
  prefiltered.stack.resize(1);
  if (ratio > kPrefilterFrom) prefiltered.stack[0] = blurSwatch(input.swatch, 0.5 * ratio);
  Swatch wrapped = prefiltered;
  wrapped.tileable = true;
  const TexelReader perfectReader(prefiltered, 0), wrappedReader(wrapped, 0);
  Context context{
      input, options, perfectReader, wrappedReader, chooseCentres(input.points.size(), options),
      ratio};
  std::vector<std::unique_ptr<ScoreImage>> images;
  for (double scale : kScales)
    images.push_back(std::make_unique<ScoreImage>(input.swatch, ratio * scale));
  std::vector<Judge> judges = makeJudges(context, images, monitor);

  const std::size_t count = context.centres.size();
  context.links.resize(count);
  monitor.begin(Stage::Score, count * (1 + judges.size()));
  gather(context, judges, monitor);
  for (Judge& judge : judges) fit(context, judge, monitor);

  TextureScore score;
  for (std::size_t s = 0; s < kScales.size(); ++s)
    score.free[s] = summarise(judges[s], options.seed);
  if (score.free[1].windows < kLeastWindows)
    throw InvalidInput(fmt::format(
        "score: only {} windows of {:.0f} pixels fit on the surface, but {} are needed. Choose a "
        "smaller scale or a larger surface",
        score.free[1].windows, kWindowSide * score.free[1].step, kLeastWindows));
  score.F = figureOfMerit(score.free);
  if (input.directions) {
    score.oriented.emplace();
    for (std::size_t s = 0; s < kScales.size(); ++s)
      (*score.oriented)[s] = summarise(judges[kScales.size() + s], options.seed);
    score.orientedF = figureOfMerit(*score.oriented);
    const Judge& judge = judges[kScales.size()];
    score.direction = directionError(judge.tensor, judge.perfectTensor);
  }
  return score;
}

}  // namespace

TextureScore scoreTexture(const ScoreInput& input, const ScoreOptions& options, Monitor& monitor) {
  checkInput(input, options);
  const double spacing = meanSpacing(input.neighborhoods, input.points.positions);
  const auto run =
      static_cast<std::size_t>(std::pow(kThinned * meanUnit(input.unit, input.scale) / spacing, 2));
  TextureScore score;
  if (run >= 2 && input.points.size() / run >= kLeastPoints) {
    const Thinned thinned = thin(input, run, options.seed, monitor);
    score = scoreWindows(thinned.input(input), options,
                         meanSpacing(thinned.neighborhoods, thinned.points.positions), monitor);
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
