#include "document/region_synthesis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.h"
#include "document/automatic_options.h"
#include "document/border_blend.h"
#include "document/options_table.h"

namespace dapple {
namespace {

constexpr std::size_t kFewestPoints = 9;  // the least that the option table's 8 neighbours need

template <class T>
std::vector<T> gathered(const std::vector<T>& column, std::span<const Index> points) {
  std::vector<T> out(points.size());
  for (std::size_t r = 0; r < points.size(); ++r) out[r] = column[points[r]];
  return out;
}

PointSet takenOut(const PointSet& points, std::span<const Index> ids) {
  PointSet out{.positions = gathered(points.positions, ids),
               .normals = gathered(points.normals, ids),
               .origin = points.origin,
               .modelUnits = points.modelUnits};
  return out;
}

// The first `k` of each point's.
Neighborhoods nearest(const Neighborhoods& all, std::size_t k) {
  Neighborhoods out{.k = k};
  out.ids.reserve(all.size() * k);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto ids = all.of(i).first(k);
    out.ids.insert(out.ids.end(), ids.begin(), ids.end());
  }
  return out;
}

// Strokes over the points that were taken out: what runs outside is cut off.
std::vector<Stroke> strokesWithin(const Column<Stroke>& strokes, std::span<const Index> ids) {
  std::vector<Stroke> out;
  if (!strokes) return out;
  for (const Stroke& stroke : *strokes) {
    if (ids.empty()) {
      out.push_back(stroke);
      continue;
    }
    Stroke piece{.weight = stroke.weight, .scale = stroke.scale};
    const auto endPiece = [&] {
      if (piece.points.size() >= 2) out.push_back(piece);
      piece.points.clear();
      piece.positions.clear();
    };
    for (std::size_t p = 0; p < stroke.points.size(); ++p) {
      const auto at = std::lower_bound(ids.begin(), ids.end(), stroke.points[p]);
      if (at == ids.end() || *at != stroke.points[p]) {
        endPiece();
        continue;
      }
      piece.points.push_back(static_cast<Index>(at - ids.begin()));
      piece.positions.push_back(stroke.positions[p]);
    }
    endPiece();
  }
  return out;
}

void rotate(std::vector<TangentFrame>& frames, double degrees) {
  if (degrees == 0) return;
  const double angle = degrees * std::numbers::pi / 180;
  const float c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  for (TangentFrame& frame : frames) {
    const vec3 right = frame.s, up = frame.t;
    frame.s = c * right + s * up;
    frame.t = c * up - s * right;
  }
}

// With Auto resolved and, for that, the swatch analysed, unless an earlier result has it.
TextureOptions resolvedOptions(const Document& document, const Region& region, std::size_t points,
                               std::shared_ptr<const SwatchAnalysis>& analysis, Monitor& monitor) {
  TextureOptions options = region.options;
  validate(options);
  if (points < kFewestPoints) options.method = Method::Triplanar;
  analysis = knownAnalysis(document, region);
  if (options.method != Method::Auto) return options;
  if (!analysis)
    analysis = std::make_shared<const SwatchAnalysis>(analyse(*region.swatch, monitor));
  return chosenOptions(region, *analysis, points).options;
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
  explicit OpenColumns(const Document& document) {
    const std::size_t n = document.size();
    const Results& old = document.results;
    open(old.source, source, n, kNoSource);
    open(old.texel, texel, n, vec2(0));
    open(old.frame, frame, n, TangentFrame{});
    open(old.state, state, n, PointState::Free);
    open(old.patch, patch, n, kNone);
    open(old.error, error, n, 0.f);
    open(old.order, order, n, kNone);
    colour = shownColours(document);
    border = old.border;
    sources = old.sources;
    touched.assign(n, false);
  }

  void scatter(const RegionResult& result) {
    const SourceMap& map = result.map;
    const std::size_t count = result.points.empty() ? map.colour.size() : result.points.size();
    const auto id = static_cast<std::uint16_t>(sources.size());
    sources.push_back(result.source);
    for (std::size_t r = 0; r < count; ++r) {
      const std::size_t i = result.points.empty() ? r : result.points[r];
      touched[i] = true;
      source[i] = id;
      texel[i] = map.texel[r];
      frame[i] = map.frame[r];
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

}  // namespace

RegionResult synthesizeRegion(const Document& document, const Region& region,
                              const SynthesisWatch& watch, Monitor& monitor) {
  const PreparedScan& prepared = document.scan->prepared;
  RegionResult out;
  out.points = pointsOf(document, region.id);
  const std::size_t m = out.points.size();
  checkReady(region, m);
  std::shared_ptr<const SwatchAnalysis> analysis;
  const TextureOptions options = resolvedOptions(document, region, m, analysis, monitor);
  const std::size_t k = std::min(static_cast<std::size_t>(options.neighbours), m - 1);
  const bool whole = m == document.size();
  if (whole) out.points.clear();
  PointSet own;
  if (!whole) own = takenOut(document.points(), out.points);
  const PointSet& points = whole ? document.points() : own;
  Neighborhoods fewer;
  if (whole && k < prepared.neighborhoods.k)
    fewer = nearest(prepared.neighborhoods, k);
  else if (m >= kFewestPoints && (!whole || k > prepared.neighborhoods.k))
    fewer = buildNeighborhoods(points.positions, k, monitor);
  const bool scans = whole && k == prepared.neighborhoods.k;
  const Neighborhoods& neighborhoods = scans ? prepared.neighborhoods : fewer;
  const std::vector<Stroke> strokes = strokesWithin(region.strokes, out.points);
  const std::vector<Index> starts = startsOf(strokes);
  std::vector<TangentFrame> frames =
      std::move(directionsOf(points, neighborhoods, strokes, options, monitor).frames);
  rotate(frames, region.rotation);
  const auto source = sourceOf(region, prepared.spacing * static_cast<float>(options.scale));
  source->options = options;
  source->analysis = analysis;
  SynthesisResult result = synthesize({.points = points,
                                       .neighborhoods = neighborhoods,
                                       .swatch = *region.swatch,
                                       .frames = frames,
                                       .unit = source->unit,
                                       .starts = starts},
                                      options, monitor);
  source->statistics = result.statistics;
  noteBlends(result.map, out.points, *source);
  out.map = std::move(result.map);
  out.source = source;
  if (watch.ends) watch.ends(out.map);
  return out;
}

std::vector<RegionResult> synthesizeRegions(const Document& document,
                                            const std::vector<RegionId>& regions,
                                            const SynthesisWatch& watch, Monitor& monitor) {
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
    before += points[r].size();
    try {
      results.push_back(synthesizeRegion(document, region, watch, monitor));
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

Document withResults(const Document& document, const std::vector<RegionResult>& results) {
  OpenColumns columns(document);
  for (const RegionResult& result : results) columns.scatter(result);
  Document out = document;
  out.results = columns.close();
  return out;
}

Document withoutResults(const Document& document, std::optional<RegionId> region) {
  Document out = document;
  if (!region || !document.results.source) {
    out.results = {};
    return out;
  }
  OpenColumns columns(document);
  const std::vector<Index> points = pointsOf(document, *region);
  const std::vector<vec3>& own = document.points().colours;
  for (const Index i : points) {
    columns.touched[i] = true;
    columns.source[i] = kNoSource;
    columns.texel[i] = vec2(0);
    columns.frame[i] = {};
    columns.colour[i] = own.empty() ? kBare : own[i];
    columns.state[i] = PointState::Free;
    columns.patch[i] = columns.order[i] = kNone;
    columns.error[i] = 0;
  }
  out.results = columns.close();
  out.results = withoutLostTerms(out);
  return out;
}

}  // namespace dapple
