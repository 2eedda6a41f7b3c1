// [Zhang] section 4: points are coloured one after the other, the one with most coloured neighbours
// first; 4.1: coarse to fine; 4.2: coherently.
//
// Departures (matching_level.cpp lists those inside one match):
// - the paper colours the coarsest level at random and uses it as it is; here it is filled like any
//   other level, always exhaustively, and visited three times more with all neighbours known.
//   Visits over a random start instead settle on few, flat places: a third of the swatch used
//   instead of half, contrast 0.74 of the swatch's instead of 0.82 (olives on the bunny, 4 levels);
// - coarser levels are visited again after they are filled, for the same reason: a point that was
//   coloured early knew only few neighbours;
// - swatch levels are a stack of full-size images, not a pyramid, so that places need no rescaling
//   and swatches of any size work;
// - exhaustive mode keeps the order of the queue but matches up to kBatch points at once when none
//   is a neighbour of another: threads can share the work and the result does not depend on them.
#include "synthesis/neighborhood_matching.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "base/hashed_order.h"
#include "points/bucket_queue.h"
#include "points/point_hierarchy.h"
#include "synthesis/matching_level.h"

namespace dapple {
namespace {

constexpr int kMaxLevels = 8;
constexpr std::size_t kBatch = 8;  // points matched at once in exhaustive mode
constexpr std::size_t kCarried = 16, kKeyRange = 2;
constexpr std::size_t kCheckEvery = 256;  // points between two looks at the monitor, coherent mode
constexpr std::size_t kClasses = 4;       // of points that are visited again at the same time
constexpr int kCoarsestVisits = 3, kCoarseVisits = 2, kFineVisits = 1;  // after the first
constexpr float kMergePixels = 0.4f;
constexpr float kCoherenceBonus = 4.0f;     // an exhaustive place needs half the error at level 0
constexpr float kSmallestShare = 1.0f / 8;  // spacing of the coarsest level / swatch size

// By point i, the points still to be coloured that have i among their neighbours: those whose keys
// grow when i is coloured.
struct Waiting {
  std::vector<Index> offsets, ids;

  Waiting(const MatchingLevel& level, const Monitor& monitor) {
    const Neighborhoods& near = level.neighborhoods();
    offsets.assign(level.size() + 1, 0);
    const auto forEdges = [&](const auto& visit) {
      for (std::size_t j = 0; j < level.size(); ++j) {
        if (j % kCheckEvery == 0) monitor.checkpoint();
        if (level.sites()[j].known) continue;
        for (Index i : near.of(j)) visit(i, static_cast<Index>(j));
      }
    };
    forEdges([&](Index i, Index) { ++offsets[i + 1]; });
    for (std::size_t i = 0; i < level.size(); ++i) offsets[i + 1] += offsets[i];
    ids.resize(offsets.back());
    std::vector<Index> next(offsets.begin(), offsets.end() - 1);
    forEdges([&](Index i, Index j) { ids[next[i]++] = j; });
  }
  std::span<const Index> of(Index i) const {
    return {ids.data() + offsets[i], offsets[i + 1] - offsets[i]};
  }
};

// Turns visits of points on all levels into points of the model done.
class WorkMeter {
 public:
  WorkMeter(std::size_t visits, std::size_t points, Monitor& monitor)
      : visits_(std::max<std::size_t>(1, visits)), points_(points), monitor_(monitor) {}
  void add(std::size_t visits) {
    done_ += visits;
    const std::size_t target = std::min(points_, done_ * points_ / visits_);
    monitor_.advance(target - reported_);
    reported_ = target;
  }

 private:
  std::size_t visits_, points_, done_ = 0, reported_ = 0;
  Monitor& monitor_;
};

class Matcher {
 public:
  Matcher(const SynthesisInput& input, const MatchingOptions& options, SourceMap& map,
          Monitor& monitor)
      : in_(input), options_(options), map_(map), monitor_(monitor), scratch_(kBatch) {}
  MatchingStatistics run();

 private:
  int levelCount() const;
  int visitsAgain(int l) const;
  MatchRules rulesOf(int l, bool again) const;
  void scaleLevels();
  void markFixed();
  void planWork();
  void addLevel(int l);
  void inheritFixed(int l);
  void colourAtRandom(int l);
  void fill(int l);
  void visitAgain(int l);
  void nextBatch(BucketQueue& queue, int l, std::size_t most);
  void count(int l, Index i, const MatchChoice& choice);
  void preview(int l);
  void write();

  const SynthesisInput& in_;
  const MatchingOptions& options_;
  SourceMap& map_;
  Monitor& monitor_;
  std::vector<HierarchyLevel> hierarchy_;  // empty with one level
  std::vector<std::unique_ptr<MatchingLevel>> levels_;
  std::vector<std::vector<float>> coarseScale_;  // by level from 1 on: as SynthesisInput::scale
  std::vector<std::vector<bool>> fixed_;         // by level: coloured before
  int baseLevel_ = 0;                            // of the swatch's stack at level 0
  std::unique_ptr<WorkMeter> meter_;
  std::vector<float> errors_;  // of level 0
  std::vector<Index> order_;   // of level 0
  MatchingStatistics statistics_;

  std::vector<MatchScratch> scratch_;
  std::vector<Index> batch_, carried_, stamp_;
  std::unique_ptr<HashedOrder> seeds_;
  std::size_t nextSeed_ = 0;
  Index batchNumber_ = 0;
};

int Matcher::levelCount() const {
  if (in_.swatch.tileable) return options_.levels;
  // A neighbourhood must fit into the swatch with room to move.
  const double pixels =
      meanSpacing(in_.neighborhoods, in_.points.positions) / meanUnit(in_.unit, in_.scale);
  const double room = kSmallestShare * std::min(in_.swatch.width, in_.swatch.height);
  int levels = options_.levels;
  while (levels > 1 && std::ldexp(pixels, levels - 1) > room) --levels;
  return levels;
}

int Matcher::visitsAgain(int l) const {
  const int top = static_cast<int>(fixed_.size()) - 1;
  if (options_.asPrinted || top == 0) return 0;
  if (l == top) return kCoarsestVisits;
  return l > 0 ? kCoarseVisits : kFineVisits;
}

MatchRules Matcher::rulesOf(int l, bool again) const {
  if (options_.asPrinted) return {.coherent = false, .exhaustive = true, .subPixel = false};
  const int top = static_cast<int>(fixed_.size()) - 1;
  MatchRules rules;
  rules.exhaustive = !options_.coherent || (l == top && top > 0);
  // Visited again with all neighbours known, a point hardly gains from a search but pays most.
  if (again && l < top) rules.exhaustive = false;
  rules.bonus = 1 + std::ldexp(kCoherenceBonus, -l);
  return rules;
}

// A hierarchy point has the mean scale of its children.
void Matcher::scaleLevels() {
  coarseScale_.resize(std::max<std::size_t>(1, hierarchy_.size()));
  if (in_.scale.empty()) return;
  for (std::size_t l = 1; l < hierarchy_.size(); ++l) {
    const std::span<const float> fine = l == 1 ? in_.scale : coarseScale_[l - 1];
    for (const auto& children : hierarchy_[l].children) {
      float sum = 0, count = 0;
      for (const Index child : children)
        if (child != kNone) sum += fine[child], ++count;
      coarseScale_[l].push_back(sum / count);
    }
  }
}

// A hierarchy point is coloured when all its children are.
void Matcher::markFixed() {
  const std::size_t count = std::max<std::size_t>(1, hierarchy_.size());
  fixed_.resize(count);
  fixed_[0].resize(in_.points.size());
  for (std::size_t i = 0; i < in_.points.size(); ++i) {
    fixed_[0][i] = map_.state[i] != PointState::Free && map_.state[i] != PointState::Gap;
  }
  for (std::size_t l = 1; l < count; ++l) {
    const auto& children = hierarchy_[l].children;
    fixed_[l].resize(children.size());
    for (std::size_t c = 0; c < children.size(); ++c) {
      fixed_[l][c] = std::all_of(children[c].begin(), children[c].end(), [&](Index child) {
        return child == kNone || fixed_[l - 1][child];
      });
    }
  }
}

void Matcher::planWork() {
  std::size_t visits = 0, points = 0;
  for (std::size_t l = 0; l < fixed_.size(); ++l) {
    const auto open =
        static_cast<std::size_t>(std::count(fixed_[l].begin(), fixed_[l].end(), false));
    visits += open * (1 + static_cast<std::size_t>(visitsAgain(static_cast<int>(l))));
    if (l == 0) points = open;
  }
  meter_ = std::make_unique<WorkMeter>(visits, points, monitor_);
}

void Matcher::addLevel(int l) {
  const bool single = hierarchy_.empty();
  const bool top = l + 1 == static_cast<int>(fixed_.size());
  const bool mayFail = !in_.swatch.tileable;
  const bool searching = rulesOf(l, false).exhaustive || mayFail;
  levels_[l] = std::make_unique<MatchingLevel>(
      MatchingLevel::Input{
          .positions = l == 0 ? in_.points.positions : hierarchy_[l].positions,
          .frames = l == 0 ? map_.frame : hierarchy_[l].frames,
          .scale = l == 0 ? in_.scale : std::span<const float>(coarseScale_[l]),
          .neighborhoods = l == 0 ? in_.neighborhoods : hierarchy_[l].neighborhoods,
          .parent =
              single ? std::span<const Index>() : std::span<const Index>(hierarchy_[l].parent),
          .coarse = top ? nullptr : levels_[l + 1].get(),
          .swatch = in_.swatch,
          .stackLevel = baseLevel_ + l,
          .unit = in_.unit,
          .merge = std::ldexp(kMergePixels, l),
          .seed = hashBits(options_.seed, static_cast<std::uint64_t>(l), 3)},
      searching);
}

// Places of the points that were coloured before: on level 0 their own, further up that of a child
// carried to its parent.
void Matcher::inheritFixed(int l) {
  MatchingLevel& level = *levels_[l];
  for (std::size_t i = 0; i < level.size(); ++i) {
    if (!fixed_[l][i]) continue;
    Index child = static_cast<Index>(i);
    for (int down = l; down > 0; --down) child = hierarchy_[down].children[child][0];
    MatchSite& site = level.sites()[i];
    vec2 place = map_.texel[child] - 0.5f;
    if (l > 0) {
      MatchSite from;
      from.position = in_.points.positions[child];
      from.s = map_.frame[child].s;
      from.t = map_.frame[child].t;
      vec2 offset(0);
      const vec2 start = place;
      if (level.offsetBetween(from, site, offset)) place = level.reader().wrap(start + offset);
      if (!level.reader().inside(place.x, place.y)) place = start;
    }
    place = level.reader().wrap(place);
    if (level.reader().inside(place.x, place.y)) level.set(static_cast<Index>(i), place);
    site.place = place;
    site.known = true;
    if (l == 0) site.colour = map_.colour[i];
  }
}

void Matcher::count(int l, Index i, const MatchChoice& choice) {
  statistics_.searches += choice.searched;
  if (l == 0) errors_[i] = choice.error;
}

void Matcher::colourAtRandom(int l) {
  MatchingLevel& level = *levels_[l];
  for (std::size_t i = 0; i < level.size(); ++i) {
    const auto id = static_cast<Index>(i);
    if (!fixed_[l][i]) level.set(id, level.randomPlace(id, 1));
  }
}

// Points of about the same key, none of which is a neighbour of another. Those passed over are the
// first of the next batch.
void Matcher::nextBatch(BucketQueue& queue, int l, std::size_t most) {
  batch_.clear();
  if (most == 1) {
    batch_.push_back(queue.pop());
  } else {
    const Neighborhoods& near = levels_[l]->neighborhoods();
    ++batchNumber_;
    // True, and i is taken, when i and the points of the batch do not see each other.
    const auto take = [&](Index i) {
      const auto around = near.of(i);
      const bool apart =
          stamp_[i] != batchNumber_ && std::none_of(around.begin(), around.end(), [&](Index j) {
            return std::find(batch_.begin(), batch_.end(), j) != batch_.end();
          });
      if (!apart) return false;
      batch_.push_back(i);
      for (Index j : around) stamp_[j] = batchNumber_;
      return true;
    };
    std::erase_if(carried_, [&](Index i) { return batch_.size() < most && take(i); });
    std::size_t least = 0;
    while (batch_.size() < most && carried_.size() < kCarried) {
      const Index i = queue.pop();
      if (i == kNone) break;
      least = std::max(least, queue.lastKey() - std::min(queue.lastKey(), kKeyRange));
      const bool late = queue.lastKey() < least;
      if (late || !take(i)) carried_.push_back(i);
      if (late) break;
    }
  }
  if (!batch_.empty() && batch_.front() != kNone) return;
  Index seed;
  do seed = seeds_->at(nextSeed_++);
  while (queue.retired(seed));
  queue.retire(seed);
  batch_.assign(1, seed);
}

void Matcher::fill(int l) {
  MatchingLevel& level = *levels_[l];
  const MatchRules rules = rulesOf(l, false);
  const Waiting waiting(level, monitor_);
  BucketQueue queue(level.size());
  std::size_t left = 0;
  for (std::size_t i = 0; i < level.size(); ++i) {
    if (level.sites()[i].known)
      queue.retire(static_cast<Index>(i));
    else
      ++left;
  }
  if (left < level.size()) {
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (!level.sites()[i].known) continue;
      queue.raiseAll(waiting.of(static_cast<Index>(i)));
    }
  }
  stamp_.assign(level.size(), 0);
  batchNumber_ = 0;
  carried_.clear();
  nextSeed_ = 0;
  seeds_ = std::make_unique<HashedOrder>(level.size(), hashBits(options_.seed, l, 4));
  std::array<MatchChoice, kBatch> choices;
  std::size_t unreported = 0;
  Index rank = 0;
  while (left > 0) {
    nextBatch(queue, l, rules.exhaustive ? kBatch : 1);
    const auto matchOne = [&](std::size_t b) {
      choices[b] = level.match(batch_[b], rules, scratch_[b]);
    };
    if (batch_.size() == 1)
      matchOne(0);
    else
      monitor_.workers().run(batch_.size(), matchOne);
    for (std::size_t b = 0; b < batch_.size(); ++b) {
      const Index i = batch_[b];
      level.set(i, choices[b].place);
      count(l, i, choices[b]);
      if (l == 0) order_[i] = rank++;
      queue.raiseAll(waiting.of(i));
    }
    left -= batch_.size();
    unreported += batch_.size();
    if (rules.exhaustive || unreported >= kCheckEvery || left == 0) {
      meter_->add(unreported);
      unreported = 0;
      if (monitor_.wantsPreview()) preview(l);
    }
  }
}

// All points again, now that all their neighbours are known: kClasses classes one after the other,
// the points of a class at the same time.
void Matcher::visitAgain(int l) {
  constexpr std::size_t kGrain = 64;
  MatchingLevel& level = *levels_[l];
  const MatchRules rules = rulesOf(l, true);
  std::array<std::vector<Index>, kClasses> classes;
  for (std::size_t i = 0; i < level.size(); ++i) {
    if (fixed_[l][i]) continue;
    classes[hashBelow(kClasses, options_.seed, i, 5)].push_back(static_cast<Index>(i));
  }
  std::vector<MatchChoice> choices;
  for (const std::vector<Index>& members : classes) {
    choices.resize(members.size());
    parallelFor(monitor_, members.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      MatchScratch scratch;
      for (std::size_t m = begin; m < end; ++m) {
        choices[m] = level.match(members[m], rules, scratch);
      }
    });
    for (std::size_t m = 0; m < members.size(); ++m) {
      level.set(members[m], choices[m].place);
      count(l, members[m], choices[m]);
    }
    meter_->add(members.size());
    if (monitor_.wantsPreview()) preview(l);
  }
}

// What is known so far, a point showing its nearest known ancestor.
void Matcher::preview(int l) {
  std::vector<vec3> colours(in_.points.size(), vec3(0));
  std::vector<PointState> states(map_.state);
  const auto show = [&](std::size_t i) {
    Index ancestor = static_cast<Index>(i);
    for (int up = 0;; ++up) {
      if (up >= l && levels_[up]->sites()[ancestor].known) {
        colours[i] = levels_[up]->sites()[ancestor].colour;
        if (!fixed_[0][i] && up == 0) states[i] = PointState::Matched;
        break;
      }
      if (up + 1 >= static_cast<int>(levels_.size())) {
        if (fixed_[0][i]) colours[i] = map_.colour[i];
        break;
      }
      ancestor = hierarchy_[up].parent[ancestor];
    }
    if (fixed_[0][i]) colours[i] = map_.colour[i];
  };
  constexpr std::size_t kGrain = 8192;
  parallelFor(monitor_, colours.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) show(i);
  });
  monitor_.publish({colours, states});
}

void Matcher::write() {
  const std::size_t n = in_.points.size();
  const std::vector<float> spacing = localSpacing(in_.neighborhoods, in_.points.positions);
  std::vector<vec3> colours(n);
  parallelFor(monitor_, n, kCheckEvery, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (fixed_[0][i]) continue;
      colours[i] = sampleSwatch(in_.swatch, levels_[0]->sites()[i].place + 0.5f,
                                filterLevel(spacing[i], in_.unitAt(i)));
    }
  });
  // From here on nothing may stop: the map is changed as a whole or not at all.
  const auto ensure = [n](auto& column, auto value) {
    if (column.size() != n) column.assign(n, value);
  };
  ensure(map_.texel, vec2(0));
  ensure(map_.colour, vec3(0));
  ensure(map_.patch, kNone);
  ensure(map_.error, 0.0f);
  ensure(map_.order, kNone);
  double squares = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (fixed_[0][i]) continue;
    map_.texel[i] = levels_[0]->sites()[i].place + 0.5f;
    map_.colour[i] = colours[i];
    map_.state[i] = PointState::Matched;
    map_.patch[i] = kNone;
    map_.error[i] = std::sqrt(errors_[i]);
    map_.order[i] = order_[i];
    squares += static_cast<double>(errors_[i]);
    ++statistics_.matched;
  }
  if (statistics_.matched > 0) {
    statistics_.meanError = std::sqrt(squares / static_cast<double>(statistics_.matched));
  }
}

MatchingStatistics Matcher::run() {
  const int wanted = levelCount();
  if (wanted > 1) {
    hierarchy_ = buildHierarchy(in_.points, map_.frame, in_.neighborhoods, wanted, monitor_);
    if (hierarchy_.size() == 1) hierarchy_.clear();
  }
  scaleLevels();
  markFixed();
  errors_.assign(in_.points.size(), 0);
  order_.assign(in_.points.size(), kNone);
  const double pixels =
      meanSpacing(in_.neighborhoods, in_.points.positions) / meanUnit(in_.unit, in_.scale);
  baseLevel_ = std::max(0, static_cast<int>(std::lround(std::log2(pixels))));
  const int count = static_cast<int>(fixed_.size());
  statistics_.levels = count;
  levels_.resize(fixed_.size());
  planWork();
  for (int l = count - 1; l >= 0; --l) {
    addLevel(l);
    inheritFixed(l);
    if (l == count - 1 && l > 0 && options_.asPrinted)
      colourAtRandom(l);
    else
      fill(l);
    for (int pass = 0; pass < visitsAgain(l); ++pass) visitAgain(l);
  }
  write();
  return statistics_;
}

void validate(const SynthesisInput& input, const MatchingOptions& options, const SourceMap& map) {
  if (options.levels < 1 || options.levels > kMaxLevels) {
    throw InvalidInput(fmt::format("levels: {} is outside 1 to {}", options.levels, kMaxLevels));
  }
  DAPPLE_CHECK(input.unit, >, 0);
  DAPPLE_CHECK(input.neighborhoods.size(), ==, input.points.size());
  DAPPLE_CHECK(map.frame.size(), ==, input.points.size());
  DAPPLE_CHECK(map.state.size(), ==, input.points.size());
}

}  // namespace

MatchingStatistics matchNeighborhoods(const SynthesisInput& input, const MatchingOptions& options,
                                      SourceMap& map, Monitor& monitor) {
  validate(input, options, map);
  return Matcher(input, options, map, monitor).run();
}

}  // namespace dapple
