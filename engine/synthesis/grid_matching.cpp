// [Zeng] Texture Synthesis from Samples for Point-Sampled Geometry: single-point and multi-point
// assignment. grid_neighborhood.cpp and surface_order.cpp list the departures inside the square and
// in the order.
//
// Departures (methods: section 5; by the first three F of N = 21, multi, without cuts, the mean of
// three swatches on 85,000 points of bunny.ply, grows from 0.14 to 0.32):
// - colours are compared where the points of the nodes lie, not at the nodes, and the best place is
//   refined between pixels: a square that is to go on into the next one fits without rounding;
// - coherent: places that continue what the square shows already are tried too, and kept unless the
//   search finds a much better one. Few, large pieces of the swatch matter more than the last
//   difference of colours;
// - multi: all open points inside the square are assigned; to leave those that no node has hit
//   makes crumbs and 2.7 times as many matches. Each takes the colour at its own offset from the
//   centre, not at its node's: the result is a map of coordinates, and a square is copied exactly;
// - squares that are out of each other's reach are matched at the same time. Only points that
//   follow each other in the order are, so that the result is that of one after the other.
#include "synthesis/grid_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "base/errors.h"
#include "base/scratch_pool.h"
#include "points/tangent_frames.h"
#include "swatch/swatch_search.h"
#include "swatch/texel_reader.h"
#include "synthesis/grid_neighborhood.h"
#include "synthesis/grid_seams.h"
#include "synthesis/place_refinement.h"
#include "synthesis/spacing_reads.h"
#include "synthesis/surface_order.h"

namespace dapple {
namespace {

constexpr int kLeastSize = 3, kMostSize = 31, kMostNeighbours = 4096;
constexpr int kPhases = 2;         // of the search; with 4 the score is the same
constexpr std::size_t kBatch = 8;  // squares matched at the same time
constexpr float kMergePixels = 0.3f;
// Differences per term that the search's 7-bit colours do not tell from none.
constexpr float kUnseen = 3 * (0.5f / 127) * (0.5f / 127);
constexpr float kCoherenceBonus = 3;  // times the error that a coherent place may have
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint64_t kPlaceStream = 402;

bool cutsSeams(const GridOptions& options) {
  return options.seams && options.assign == GridAssign::Multi;
}

// What one match found.
struct Paste {
  vec2 texel{0};                  // of the centre
  float error = 0;                // root mean square colour difference, 0..1
  std::vector<GridPoint> points;  // that take their colours from it, the centre first
};

float largestUnit(const SynthesisInput& input) {
  if (input.scale.empty()) return input.unit;
  return input.unit * *std::max_element(input.scale.begin(), input.scale.end());
}

class GridMatcher {
 public:
  GridMatcher(const SynthesisInput& input, const GridOptions& options, SourceMap& map,
              Monitor& monitor)
      : input_(input),
        options_(options),
        map_(map),
        monitor_(monitor),
        level_(meanReadLevel(input)),
        search_(searchOf(input.swatch, level_, kPhases)),
        reader_(input.swatch, level_),
        apart_(2 * GridNeighborhood::reachOf(options.size, largestUnit(input))),
        known_(input.points.size()),
        scratch_([this] { return std::make_unique<Scratch>(input_, options_); }) {}

  GridStatistics run();

 private:
  struct Scratch {
    Scratch(const SynthesisInput& input, const GridOptions& options)
        : grid(input, options.size, options.neighbours) {}
    GridNeighborhood grid;
    std::vector<SearchTerm> terms;
    WantedTexels wanted;  // the terms once more
    std::vector<vec2> tried;
  };

  void nextBatch();
  Paste match(Index centre, Scratch& scratch) const;
  void addTerms(Scratch& scratch) const;
  struct Place {
    vec2 place{0};            // texel - 0.5
    float error = kInfinity;  // sum over terms; infinite: none
  };
  Place searched(const Scratch& scratch) const;
  Place continued(Scratch& scratch) const;
  Place nearlyFitting(Scratch& scratch) const;
  float errorAt(vec2 place, float bound, const Scratch& scratch) const;
  void findPlace(Index centre, Scratch& scratch, Paste& paste) const;
  vec2 randomPlace(Index centre) const;
  void takePoints(const Scratch& scratch, Paste& paste) const;
  void apply(const Paste& paste);

  const SynthesisInput& input_;
  const GridOptions& options_;
  SourceMap& map_;
  Monitor& monitor_;
  const int level_;  // of the swatch's stack: pixels as wide as points are apart
  const std::shared_ptr<const SwatchSearch> search_;
  const TexelReader reader_;
  const float apart_;  // squares whose centres are further apart share nothing
  std::vector<std::uint8_t> known_;
  std::vector<Index> order_;  // in which points are matched unless they were pasted
  std::size_t next_ = 0;      // in order_
  std::vector<Index> batch_;
  std::vector<Index> centres_;  // by match
  Index coloured_ = 0;
  ScratchPool<Scratch> scratch_;
};

// The next open points, as many as are out of each other's reach.
void GridMatcher::nextBatch() {
  const std::vector<vec3>& positions = *input_.chart;
  batch_.clear();
  for (; next_ < order_.size() && batch_.size() < kBatch; ++next_) {
    const Index i = order_[next_];
    if (known_[i]) continue;
    const bool reaches = std::any_of(batch_.begin(), batch_.end(), [&](Index j) {
      return distanceBetween(positions[i], positions[j]) <= apart_;
    });
    if (reaches) return;
    batch_.push_back(i);
  }
}

// The points of nodes that have a colour.
void GridMatcher::addTerms(Scratch& scratch) const {
  scratch.terms.clear();
  scratch.wanted.clear();
  for (const Index p : scratch.grid.nodes()) {
    if (p == kNone) continue;
    const GridPoint& point = scratch.grid.points()[p];
    if (!known_[point.id]) continue;
    const vec3 colour = map_.colour[point.id];
    const float relief = reader_.relief(map_.texel[point.id] - 0.5f);
    scratch.terms.push_back({point.offset, colour, 0, relief});
    scratch.wanted.add(point.offset, toFloat4(colour, relief));
  }
}

float GridMatcher::errorAt(vec2 place, float bound, const Scratch& scratch) const {
  if (!reader_.inside(place.x, place.y)) return kInfinity;
  return reader_.differences(place, {scratch.wanted, 0, scratch.wanted.size()}, bound);
}

// The best of all places.
GridMatcher::Place GridMatcher::searched(const Scratch& scratch) const {
  Place best;
  const SearchResult found = search_->search(scratch.terms);
  if (!found.found) return best;
  best.place = found.texel - 0.5f;
  const auto errorOf = [&](vec2 at, float bound) { return errorAt(at, bound, scratch); };
  best.error = errorOf(best.place, kInfinity);
  refinePlace(errorOf, best.place, best.error);
  return best;
}

// The best of those where the centre would continue a known point of the square.
GridMatcher::Place GridMatcher::continued(Scratch& scratch) const {
  Place best;
  scratch.tried.clear();
  for (const GridPoint& point : scratch.grid.points()) {
    if (!known_[point.id]) continue;
    const vec2 place = reader_.wrap(map_.texel[point.id] - 0.5f - point.offset);
    const bool tried = std::any_of(scratch.tried.begin(), scratch.tried.end(), [&](vec2 other) {
      const vec2 d = glm::abs(other - place);
      return std::max(d.x, d.y) < kMergePixels;
    });
    if (tried) continue;
    scratch.tried.push_back(place);
    const float error = errorAt(place, best.error, scratch);
    if (error < best.error) best = {place, error};
  }
  return best;
}

// A swatch that does not tile may have no place for the whole square: then the terms further out
// do without.
GridMatcher::Place GridMatcher::nearlyFitting(Scratch& scratch) const {
  for (int half = options_.size / 4; !scratch.terms.empty(); half /= 2) {
    std::erase_if(scratch.terms, [&](const SearchTerm& term) {
      return std::max(std::abs(term.offset.x), std::abs(term.offset.y)) > static_cast<float>(half);
    });
    scratch.wanted.clear();
    for (const SearchTerm& term : scratch.terms)
      scratch.wanted.add(term.offset, toFloat4(term.colour, term.relief));
    if (scratch.terms.empty()) break;
    const Place found = searched(scratch);
    if (found.error < kInfinity || half == 0) return found;
  }
  return {};
}

// Some place in the swatch, one with room for the square around it where there is any.
vec2 GridMatcher::randomPlace(Index centre) const {
  const vec2 texel = randomTexel(input_.swatch, options_.seed, centre, kPlaceStream);
  if (input_.swatch.tileable) return texel;
  const vec2 size(input_.swatch.width, input_.swatch.height);
  const vec2 margin =
      glm::min(vec2(static_cast<float>(options_.size) / 2), glm::floor(size / 2.f) + 0.5f);
  const vec2 roomy = glm::clamp(texel, margin, glm::max(margin, size - margin));
  return usableTexel(input_.swatch, roomy) ? roomy : texel;
}

void GridMatcher::findPlace(Index centre, Scratch& scratch, Paste& paste) const {
  Place best;
  if (!scratch.terms.empty()) {
    best = searched(scratch);
    if (options_.coherent) {
      const Place coherent = continued(scratch);
      const float unseen = kUnseen * static_cast<float>(scratch.terms.size());
      if (coherent.error <= std::max(kCoherenceBonus * best.error, unseen)) best = coherent;
    }
    if (best.error == kInfinity) best = nearlyFitting(scratch);
  }
  if (best.error == kInfinity) {
    paste.texel = randomPlace(centre);
    return;
  }
  paste.texel = wrapTexel(input_.swatch, best.place + 0.5f);
  paste.error = std::sqrt(best.error / (3 * static_cast<float>(scratch.terms.size())));
}

// The open points of the square, unless the swatch ends before.
void GridMatcher::takePoints(const Scratch& scratch, Paste& paste) const {
  const auto points = scratch.grid.points();
  paste.points.push_back(points[0]);
  if (options_.assign == GridAssign::Single) return;
  for (const GridPoint& point : points.subspan(1)) {
    if (known_[point.id] || !scratch.grid.covers(point)) continue;
    const vec2 texel = wrapTexel(input_.swatch, paste.texel + point.offset);
    if (usableTexel(input_.swatch, texel)) paste.points.push_back(point);
  }
}

Paste GridMatcher::match(Index centre, Scratch& scratch) const {
  monitor_.checkpoint();
  Paste paste;
  scratch.grid.gather(centre);
  addTerms(scratch);
  findPlace(centre, scratch, paste);
  takePoints(scratch, paste);
  return paste;
}

void GridMatcher::apply(const Paste& paste) {
  const auto patch = static_cast<Index>(centres_.size());
  const Index centre = paste.points.front().id;
  const TangentFrame& frame = input_.frames[centre];
  centres_.push_back(centre);
  map_.placement.push_back(paste.texel);
  for (const GridPoint& point : paste.points) {
    const Index i = point.id;
    const vec3 normal = input_.points.normals[i];
    known_[i] = 1;
    map_.patch[i] = patch;
    map_.domain[i] = point.offset;
    map_.texel[i] = wrapTexel(input_.swatch, paste.texel + point.offset);
    map_.frame[i] = orthonormalFrame(normal, transported(frame.t, frame.n, normal));
    map_.colour[i] = sampleSwatch(input_.swatch, map_.texel[i], static_cast<float>(level_));
    map_.state[i] = PointState::Matched;
    map_.error[i] = paste.error;
    map_.order[i] = coloured_++;
  }
}

GridStatistics GridMatcher::run() {
  const std::size_t n = input_.points.size();
  order_ =
      surfaceOrder(input_.points, input_.neighborhoods, input_.starts, options_.seed, monitor_);
  map_.domain.assign(n, vec2(0));
  map_.placement.clear();
  std::vector<Paste> pastes;
  GridStatistics statistics;
  double squares = 0;
  for (nextBatch(); !batch_.empty(); nextBatch()) {
    pastes.resize(batch_.size());
    const auto matchOne = [&](std::size_t b) {
      scratch_.use([&](Scratch& scratch) { pastes[b] = match(batch_[b], scratch); });
    };
    if (batch_.size() == 1)
      matchOne(0);
    else
      monitor_.workers().run(batch_.size(), matchOne);
    const Index before = coloured_;
    for (const Paste& paste : pastes) {
      apply(paste);
      squares += static_cast<double>(paste.error) * static_cast<double>(paste.error);
    }
    monitor_.advance(coloured_ - before);
    if (monitor_.wantsPreview()) monitor_.publish({map_.colour, map_.state});
  }
  statistics.matches = centres_.size();
  statistics.meanError = std::sqrt(squares / static_cast<double>(centres_.size()));
  if (cutsSeams(options_))
    statistics.seams = cutSquares(input_, centres_, options_.size, map_, monitor_);
  readBySpacing(input_, map_, monitor_);
  return statistics;
}

void validate(const SynthesisInput& input, const GridOptions& options, const SourceMap& map) {
  if (options.size < kLeastSize || options.size > kMostSize || options.size % 2 == 0)
    throw InvalidInput(fmt::format("grid: {} is not an odd number from {} to {}", options.size,
                                   kLeastSize, kMostSize));
  if (options.neighbours < 0 || options.neighbours > kMostNeighbours)
    throw InvalidInput(
        fmt::format("grid neighbours: {} is outside 0 to {}", options.neighbours, kMostNeighbours));
  DAPPLE_CHECK(input.unit, >, 0);
  DAPPLE_CHECK(input.neighborhoods.size(), ==, input.points.size());
  DAPPLE_CHECK(input.frames.size(), ==, input.points.size());
  DAPPLE_CHECK(map.state.size(), ==, input.points.size());
}

}  // namespace

std::size_t gridPasses(const GridOptions& options) {
  return cutsSeams(options) ? 1 + kSeamPasses : 1;
}

GridStatistics matchGrid(const SynthesisInput& input, const GridOptions& options, SourceMap& map,
                         Monitor& monitor) {
  validate(input, options, map);
  const ChartedInput charted(input, true, monitor);
  return GridMatcher(charted.get(), options, map, monitor).run();
}

}  // namespace dapple
