#include "document/region_synthesis.h"

#include <algorithm>
#include <functional>
#include <iterator>

#include "base/errors.h"
#include "document/automatic_options.h"
#include "document/border_blend.h"
#include "document/changed_points.h"
#include "document/options_table.h"

namespace dapple {
namespace {

// With Auto resolved and, for that, the swatch analysed, unless an earlier result has it.
TextureOptions resolvedOptions(const Document& document, const Region& region,
                               std::shared_ptr<const SwatchAnalysis>& analysis, Monitor& monitor) {
  TextureOptions options = region.options;
  validate(options);
  const std::size_t points = static_cast<std::size_t>(
      std::count(document.labels->begin(), document.labels->end(), region.id));
  if (points < kFewestPoints) options.method = Method::Triplanar;
  analysis = knownAnalysis(document, region);
  if (options.method != Method::Auto) return options;
  if (!analysis)
    analysis = std::make_shared<const SwatchAnalysis>(
        analyse(*comparedSwatch(region.swatch, region.maps.get(), options), monitor));
  return chosenOptions(document, region, *analysis).options;
}

std::shared_ptr<ResultSource> sourceOf(const Region& region, float unit) {
  auto source = std::make_shared<ResultSource>();
  source->region = region.id;
  source->reference = region.reference;
  source->swatch = region.swatch;
  source->maps = region.maps;
  source->options = region.options;
  source->unit = unit;
  return source;
}

void checkReady(const Region& region, std::size_t points) {
  if (region.locked)
    throw InvalidInput(
        fmt::format("region '{}' is locked; unlock it to synthesize it", region.name));
  if (points == 0)
    throw InvalidInput(fmt::format("region '{}' has no points; assign it some first", region.name));
  if (!region.swatch && !region.reference.path.empty())
    throw InvalidInput(fmt::format(
        "the swatch {} of region '{}' was not found; put it back or choose another swatch",
        region.reference.path, region.name));
  if (!region.swatch)
    throw InvalidInput(fmt::format("region '{}' has no swatch; choose one first", region.name));
}

// What was on show when the region's synthesis was stopped.
RegionResult partialResult(const Document& document, const Region& region,
                           const std::vector<Index>& ids, const Preview& shown) {
  RegionResult out;
  for (const Index i : ids)
    if (shown.states[i] == PointState::Patch || shown.states[i] == PointState::Matched)
      out.points.push_back(i);
  const auto source =
      sourceOf(region, document.scan->prepared.spacing * static_cast<float>(region.options.scale));
  source->partial = true;
  out.source = source;
  out.map = emptySourceMap(out.points.size(), source->unit);
  for (std::size_t r = 0; r < out.points.size(); ++r)
    out.map.colour[r] = shown.colours[out.points[r]],
    out.map.state[r] = shown.states[out.points[r]];
  return out;
}

// Copies of the result columns, for n points, that take new values.
struct OpenColumns {
  OpenColumns(const Document& document, Workers& workers) {
    const std::size_t n = document.size();
    const Results& old = document.results;
    // The largest first: they are copied side by side.
    const std::function<void()> copies[] = {
        [&] { open(old.frame, frame, n, TangentFrame{}); },
        [&] { colour = shownColours(document); },
        [&] { open(old.texel, texel, n, vec2(0)); },
        [&] { open(old.patch, patch, n, kNone); },
        [&] { open(old.order, order, n, kNone); },
        [&] { open(old.error, error, n, 0.f); },
        [&] {
          if (old.scale) scale = *old.scale;
          if (old.level) level = *old.level;
        },
        [&] { open(old.source, source, n, kNoSource); },
        [&] { open(old.state, state, n, PointState::Free); },
    };
    workers.run(std::size(copies), [&](std::size_t c) { copies[c](); });
    border = old.border;
    sources = old.sources;
    touched.assign(n, false);
  }

  // Back to what a point has that nothing is synthesized for.
  void clear(std::size_t i, vec3 own) {
    touched[i] = true;
    source[i] = kNoSource;
    texel[i] = vec2(0);
    frame[i] = {};
    if (!scale.empty()) scale[i] = 1;
    if (!level.empty()) level[i] = 0;
    colour[i] = own;
    state[i] = PointState::Free;
    patch[i] = order[i] = kNone;
    error[i] = 0;
  }

  void scatter(const RegionResult& result) {
    const SourceMap& map = result.map;
    const auto id = static_cast<std::uint16_t>(sources.size());
    sources.push_back(result.source);
    if (result.points.empty())
      std::fill(source.begin(), source.end(), id);
    else
      for (const Index i : result.points) source[i] = id;
    if (!map.scale.empty() && scale.empty()) scale.assign(source.size(), 1);
    if (!map.level.empty() && level.empty()) level.assign(source.size(), 0);
    const std::vector<Index>& points = result.changed ? *result.changed : result.points;
    for (std::size_t r = 0; r < map.colour.size(); ++r) {
      const std::size_t i = points.empty() ? r : points[r];
      touched[i] = true;
      texel[i] = map.texel[r];
      frame[i] = map.frame[r];
      if (!scale.empty()) scale[i] = map.scale.empty() ? 1 : map.scale[r];
      if (!level.empty()) level[i] = map.level.empty() ? 0 : map.level[r];
      colour[i] = map.colour[r];
      state[i] = map.state[r];
      patch[i] = map.patch[r];
      error[i] = map.error[r];
      order[i] = map.order[r];
    }
  }

  Results close() {
    Results out;
    out.source = shared(std::move(source));
    out.texel = shared(std::move(texel));
    out.frame = shared(std::move(frame));
    const auto scaled = [](float s) { return s != 1; };
    if (std::any_of(scale.begin(), scale.end(), scaled)) out.scale = shared(std::move(scale));
    const auto filtered = [](float l) { return l != 0; };
    if (std::any_of(level.begin(), level.end(), filtered)) out.level = shared(std::move(level));
    out.colour = shared(std::move(colour));
    out.state = shared(std::move(state));
    out.patch = shared(std::move(patch));
    out.error = shared(std::move(error));
    out.order = shared(std::move(order));
    out.border = untouchedBorder();
    out.sources = std::move(sources);
    dropUnusedSources(out);
    return out;
  }

  std::vector<std::uint16_t> source;
  std::vector<vec2> texel;
  std::vector<TangentFrame> frame;
  std::vector<float> scale;  // empty: 1 everywhere
  std::vector<float> level;  // empty: 0 everywhere
  std::vector<vec3> colour;
  std::vector<PointState> state;
  std::vector<Index> patch, order;
  std::vector<float> error;
  std::shared_ptr<const BorderMix> border;
  std::vector<std::shared_ptr<const ResultSource>> sources;
  std::vector<bool> touched;  // points with new values

 private:
  template <class T>
  static void open(const Column<T>& old, std::vector<T>& column, std::size_t n, T missing) {
    if (old)
      column = *old;
    else
      column.assign(n, missing);
  }

  template <class T>
  static Column<T> shared(std::vector<T> column) {
    return std::make_shared<const std::vector<T>>(std::move(column));
  }

  // What is left of the border: the entries of points that are as they were.
  std::shared_ptr<const BorderMix> untouchedBorder() const {
    if (!border) return nullptr;
    BorderMix left;
    for (std::size_t b = 0; b < border->points.size(); ++b) {
      if (touched[border->points[b]]) continue;
      const std::span<const BorderTerm> terms = border->termsOf(b);
      left.points.push_back(border->points[b]);
      left.own.push_back(border->own[b]);
      left.terms.insert(left.terms.end(), terms.begin(), terms.end());
      left.end.push_back(left.terms.size());
    }
    if (left.points.empty()) return nullptr;
    return std::make_shared<const BorderMix>(std::move(left));
  }
};

// One region's turn among those of a command.
struct Turn {
  std::size_t before = 0, total = 0;  // points
  bool onlyChanged = false;
  std::unique_ptr<RegionField>* field = nullptr;  // RegionsAsked::field
};

class RegionSynthesis {
 public:
  RegionSynthesis(const Document& document, const Region& region, const Turn& turn,
                  const SynthesisWatch& watch, Monitor& monitor)
      : document_(document),
        region_(region),
        turn_(turn),
        watch_(watch),
        monitor_(monitor),
        field_(turn.field ? *turn.field : own_) {
    region_.options = resolvedOptions(document, region, analysis_, monitor);
    compared_ = comparedSwatch(region.swatch, region.maps.get(), region_.options);
  }

  RegionResult run() {
    const auto source =
        sourceOf(region_, document_.scan->prepared.spacing * static_cast<float>(options().scale));
    source->analysis = analysis_;
    enter();
    RegionResult out{.points = part().ids(), .source = source};
    if (turn_.onlyChanged && part().size() >= kFewestPoints)
      if (std::optional<PartResult> some = changed(source->unit)) {
        source->statistics = some->statistics;
        source->blended = std::move(some->blended);
        source->blendEnd = std::move(some->blendEnd);
        source->blend = std::move(some->blend);
        out.map = std::move(some->map);
        out.changed = std::move(some->points);
        return out;
      }
    SynthesisResult result = all(source->unit);
    source->statistics = result.statistics;
    noteBlends(result.map, out.points, *source);
    out.map = std::move(result.map);
    return out;
  }

 private:
  const TextureOptions& options() const { return region_.options; }
  const RegionPoints& part() const { return field_->part(); }

  void enter() {
    if (field_ && field_->fits(document_, region_)) return;
    field_.reset();
    field_ = std::make_unique<RegionField>(document_, region_, monitor_);
  }

  SynthesisResult all(float unit) {
    const OrientationField& field = field_->field(region_, RegionField::Bytes::Exact, monitor_);
    const std::vector<Index> starts = startsOf(part().strokes(region_));
    SynthesisResult result = synthesize({.points = part().points(),
                                         .neighborhoods = part().neighborhoods(),
                                         .swatch = *compared_,
                                         .frames = field.frames,
                                         .unit = unit,
                                         .scale = field.scale,
                                         .starts = starts},
                                        options(), monitor_);
    if (watch_.ends) watch_.ends(result.map);
    return result;
  }

  // What has changed, as points of their own beside those that are kept. Nothing: it is too much.
  std::optional<PartResult> changed(float unit) {
    const OrientationField& field = field_->field(region_, RegionField::Bytes::Near, monitor_);
    const RegionTarget target{region_, part(), field, unit};
    const std::optional<RegionPart> found = changedPart(document_, target, monitor_);
    if (!found) return std::nullopt;
    const RegionPart& changes = *found;
    if (changes.points.empty()) return withPart(document_, target, changes, {}, monitor_);
    if (watch_.begins) {
      std::vector<Index> ids;
      for (const Index r : changes.points) ids.push_back(part().idOf(r));
      watch_.begins(ids, turn_.before, turn_.total);
    }
    const PointSet points = takenOut(part().points(), changes.points);
    const Neighborhoods near =
        buildNeighborhoods(points.positions, part().neighborhoods().k, monitor_);
    const std::vector<TangentFrame> frames = gathered(target.field.frames, changes.points);
    const SynthesisResult made = synthesize({.points = points,
                                             .neighborhoods = near,
                                             .swatch = *compared_,
                                             .frames = frames,
                                             .unit = target.unit,
                                             .scale = changes.map.scale,
                                             .kept = &changes.map},
                                            options(), monitor_);
    if (watch_.ends) watch_.ends(made.map);
    return withPart(document_, target, changes, made.map, monitor_);
  }

  const Document& document_;
  Region region_;  // with its options resolved
  const Turn turn_;
  const SynthesisWatch& watch_;
  Monitor& monitor_;
  std::shared_ptr<const SwatchAnalysis> analysis_;
  std::shared_ptr<const Swatch> compared_;
  std::unique_ptr<RegionField> own_;  // where none is kept
  std::unique_ptr<RegionField>& field_;
};

}  // namespace

std::vector<RegionResult> synthesizeRegions(const Document& document, const RegionsAsked& asked,
                                            const SynthesisWatch& watch, Monitor& monitor) {
  const std::vector<RegionId>& regions = asked.regions;
  std::vector<std::vector<Index>> points;
  std::size_t total = 0, before = 0;
  for (const RegionId id : regions) {
    points.push_back(pointsOf(document, id));
    total += points.back().size();
  }
  std::vector<RegionResult> results;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const Region& region = *findRegion(document, regions[r]);
    checkReady(region, points[r].size());
    if (watch.begins) watch.begins(points[r], before, total);
    const Turn turn{before, total, asked.onlyChanged, asked.field};
    before += points[r].size();
    try {
      results.push_back(RegionSynthesis(document, region, turn, watch, monitor).run());
    } catch (const Cancelled&) {
      if (!watch.keepsDone || !watch.keepsDone()) throw;
      RegionResult partial = partialResult(document, region, points[r], watch.shown());
      if (!partial.points.empty()) results.push_back(std::move(partial));
      if (results.empty()) throw;
      break;
    }
  }
  return results;
}

Document withResults(const Document& document, const std::vector<RegionResult>& results,
                     Workers& workers) {
  OpenColumns columns(document, workers);
  for (const RegionResult& result : results) columns.scatter(result);
  Document out = document;
  out.results = columns.close();
  return out;
}

Document withoutResults(const Document& document, std::optional<RegionId> region,
                        Workers& workers) {
  Document out = document;
  if (!region || !document.results.source) {
    out.results = {};
    return out;
  }
  OpenColumns columns(document, workers);
  const std::vector<Index> points = pointsOf(document, *region);
  const std::vector<vec3>& own = document.points().colours;
  for (const Index i : points) columns.clear(i, own.empty() ? kBare : own[i]);
  out.results = columns.close();
  out.results = withoutLostTerms(out);
  return out;
}

}  // namespace dapple
