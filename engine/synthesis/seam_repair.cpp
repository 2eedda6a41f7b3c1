// Methods: section 4, "Decision for the product's hybrid". F without and with, on the bunny of 85
// 000 points: hybrid 0.600 and 0.623 (22 swatches), 0.663 and 0.678 where patches run straight on
// (8), grid 0.426 and 0.474 (19), match 0.32 and 0.41, tiling 0.50 and 0.53 (3 each). Of 5 swatches
// with hybrid one pass over the second level gives 0.555, four give 0.566: that level does the
// most.
#include "synthesis/seam_repair.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/errors.h"
#include "synthesis/coordinate_relaxation.h"
#include "synthesis/place_levels.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 2048;
constexpr std::size_t kLinks = 8;  // of a point: to its nearest neighbours
constexpr float kBreak = 0.8f;     // pixels that a place is off by where a seam is
constexpr float kMostWidth = 64;
constexpr int kMostLevels = 8;
constexpr int kRounds = 16;  // in which patches are carried on from point to point

// Where all points of a map lie, and which of their links are broken.
class PlaceLinks {
 public:
  // Kept by reference.
  PlaceLinks(const SynthesisInput& input, const std::vector<vec2>& texel)
      : input_(input),
        texel_(texel),
        ways_(input),
        count_(std::min(kLinks, input.neighborhoods.k)) {}

  std::span<const Index> of(Index i) const { return input_.neighborhoods.of(i).first(count_); }

  // By how much j's place is not where that of i goes on; nothing where they look away from each
  // other.
  std::optional<vec2> misfit(Index i, Index j) const {
    const SiteWays::Offset offset = ways_.between(i, j);
    if (!offset.seen) return std::nullopt;
    if (offset.quarters != 0) return vec2(kTurned);
    vec2 d = texel_[j] - texel_[i] - offset.pixels;
    if (!input_.swatch.tileable) return d;
    const vec2 size(input_.swatch.width, input_.swatch.height);
    return d - size * glm::round(d / size);
  }

  static bool isBreak(vec2 misfit) { return !(glm::dot(misfit, misfit) <= kBreak * kBreak); }

 private:
  static constexpr float kTurned = 1e6f;

  const SynthesisInput& input_;
  const std::vector<vec2>& texel_;
  SiteWays ways_;
  std::size_t count_;
};

class SeamRepair {
 public:
  SeamRepair(const SynthesisInput& input, const RepairOptions& options, const SourceMap& map,
             Monitor& monitor)
      : in_(input), options_(options), map_(map), monitor_(monitor), domain_(input.swatch) {}

  RepairStatistics run() {
    findBands();
    statistics_.open = static_cast<std::size_t>(std::count(open_.begin(), open_.end(), 1));
    if (statistics_.open == 0) return statistics_;
    findLevels();
    relax();
    return statistics_;
  }

  void write(SourceMap& map) {
    if (statistics_.open == 0) return;
    endBlends(map);
    map.texel = std::move(texel_);
    for (std::size_t m = 0; m < moved_.size(); ++m) {
      if (!domains_.empty()) map.domain[moved_[m]] = domains_[m];
      map.patch[moved_[m]] = patches_[m];
    }
    for (std::size_t i = 0; i < open_.size(); ++i) {
      if (!open_[i]) continue;
      map.colour[i] = colourOf(i, map.texel[i]);
      if (!map.level.empty()) map.level[i] = levelAt(i);
    }
  }

 private:
  void findLevels() {
    if (!options_.level) return;
    level_ = localSpacing(in_.neighborhoods, in_.points.positions);
    for (std::size_t i = 0; i < level_.size(); ++i)
      level_[i] = options_.level(level_[i], in_.unitAt(i));
  }

  float levelAt(std::size_t i) const { return level_.empty() ? 0 : level_[i]; }
  vec3 colourOf(std::size_t i, vec2 texel) const {
    return sampleSwatch(in_.swatch, texel, levelAt(i));
  }

  bool isBlended(std::size_t i) const {
    return !map_.blendOffset.empty() && map_.blendOffset[i] < map_.blendOffset[i + 1];
  }

  bool atSeam(const PlaceLinks& links, Index i) const {
    if (isBlended(i)) return true;
    return std::any_of(links.of(i).begin(), links.of(i).end(), [&](Index j) {
      // Seams between kept points have been mended.
      if (in_.isKept(i) && in_.isKept(j)) return false;
      const auto misfit = links.misfit(i, j);
      return misfit && PlaceLinks::isBreak(*misfit);
    });
  }

  // Points near a seam and not kept, along the surface.
  void findBands() {
    const std::size_t n = in_.points.size();
    const PlaceLinks links(in_, map_.texel);
    open_.assign(n, 0);
    parallelFor(monitor_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) open_[i] = atSeam(links, static_cast<Index>(i));
    });
    std::vector<Index> reached;
    for (Index i = 0; i < n; ++i)
      if (open_[i]) reached.push_back(i);
    statistics_.seams = reached.size();
    std::vector<float> distance(reached.size(), 0);
    for (std::size_t r = 0; r < reached.size(); ++r) {
      if (r % kGrain == 0) monitor_.checkpoint();
      const Index i = reached[r];
      for (const Index j : links.of(i)) {
        const float step = distanceBetween(in_.points.positions[i], in_.points.positions[j]);
        const float far = distance[r] + step / in_.unitAt(i);
        const bool sameSide = glm::dot(in_.points.normals[i], in_.points.normals[j]) > 0;
        if (far > options_.width || open_[j] || !sameSide) continue;
        open_[j] = 1;
        reached.push_back(j), distance.push_back(far);
      }
    }
    for (Index i = 0; i < n; ++i)
      if (in_.isKept(i)) open_[i] = 0;
  }

  // A place on the swatch's border is as good as one beside it.
  Place insidePlace(vec2 texel) const {
    const Place place = domain_.wrapped(placeOf(texel));
    return {std::clamp(place.x, 0, domain_.width() - 1),
            std::clamp(place.y, 0, domain_.height() - 1)};
  }

  PlaceTask task() {
    PlaceTask task{.start = std::vector<Place>(open_.size())};
    parallelFor(monitor_, open_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        task.start[i] = insidePlace(map_.texel[i]);
        // What lies where coordinates cannot, as beside a hole, stays.
        if (open_[i] && !domain_.contains(task.start[i])) open_[i] = 0;
      }
    });
    task.open = open_;
    return task;
  }

  void relax() {
    const std::vector<SurfaceLevel> surface = thinSurface(in_, options_.levels, monitor_);
    PlaceTask asked = task();
    const std::vector<Place> start = asked.start;
    PlaceLevels levels(in_, surface, std::move(asked));
    for (std::size_t l = surface.size(); l-- > 0;) {
      levels.enter(l, monitor_);
      const auto show = [&] {
        if (monitor_.wantsPreview()) preview(levels);
      };
      if (surface[l].level >= 0)
        levels.relax(passesOver(surface[l].level, false, options_.passes), show, nullptr, monitor_);
      monitor_.advance(pointsOfStep(open_.size(), surface.size() - 1 - l, surface.size()));
    }
    texel_ = map_.texel;
    for (Index i = 0; i < open_.size(); ++i) {
      if (!open_[i] || levels.places()[i] == start[i]) continue;
      texel_[i] = texelOf(levels.places()[i]);
      moved_.push_back(i);
    }
    statistics_.moved = moved_.size();
    carryPatches();
  }

  void preview(const PlaceLevels& levels) {
    std::vector<vec3> colours = map_.colour;
    const auto show = [&](std::size_t first, std::span<const Place> places) {
      for (std::size_t r = 0; r < places.size(); ++r)
        if (const std::size_t i = first + r; open_[i]) colours[i] = colourOf(i, texelOf(places[r]));
    };
    levels.visitAll(show, monitor_);
    monitor_.publish({colours, map_.state});
  }

  bool hasDomain(Index patch) const { return patch < map_.placement.size(); }

  // The texel in the domain of a patch, where the swatch tiles as near as possible to `expected`.
  vec2 domainOf(Index i, Index patch, vec2 expected) const {
    const vec2 q = texel_[i] - map_.placement[patch];
    if (!in_.swatch.tileable) return q;
    const vec2 size(in_.swatch.width, in_.swatch.height);
    return q + size * glm::round((expected - q) / size);
  }

  // Gives moved points the patch of the nearest neighbour that they continue, round by round; those
  // that continue none keep theirs.
  void carryPatches() {
    patches_.resize(moved_.size());
    for (std::size_t m = 0; m < moved_.size(); ++m) patches_[m] = map_.patch[moved_[m]];
    if (map_.placement.empty() || map_.domain.empty()) return;
    const PlaceLinks links(in_, texel_);
    std::vector<vec2> domain = map_.domain;
    std::vector<Index> patch = map_.patch;
    std::vector<Index> waiting;
    for (const Index i : moved_) {
      if (hasDomain(patch[i])) domain[i] = domainOf(i, patch[i], domain[i]);
      waiting.push_back(i);
    }
    std::vector<std::uint8_t> known(open_.size(), 1);
    for (const Index i : moved_) known[i] = 0;
    for (int round = 0; round < kRounds && !waiting.empty(); ++round) {
      std::vector<Index> settled, left;
      for (const Index i : waiting) {
        const Index from = continuedBy(links, known, patch, i);
        if (from == kNone) {
          left.push_back(i);
          continue;
        }
        settled.push_back(i);
        patch[i] = patch[from];
        domain[i] = domainOf(i, patch[i], domain[from]);
      }
      for (const Index i : settled) known[i] = 1;
      monitor_.checkpoint();
      if (settled.empty()) break;
      waiting = std::move(left);
    }
    domains_.resize(moved_.size());
    for (std::size_t m = 0; m < moved_.size(); ++m)
      patches_[m] = patch[moved_[m]], domains_[m] = domain[moved_[m]];
  }

  Index continuedBy(const PlaceLinks& links, const std::vector<std::uint8_t>& known,
                    const std::vector<Index>& patch, Index i) const {
    for (const Index j : links.of(i)) {
      if (!known[j] || !hasDomain(patch[j])) continue;
      const auto misfit = links.misfit(i, j);
      if (misfit && !PlaceLinks::isBreak(*misfit)) return j;
    }
    return kNone;
  }

  void endBlends(SourceMap& map) const {
    if (map.blendOffset.empty()) return;
    std::vector<Index> offset(1, 0);
    std::vector<BlendTerm> terms;
    for (std::size_t i = 0; i < open_.size(); ++i) {
      if (!open_[i])
        terms.insert(terms.end(), map.blend.begin() + map.blendOffset[i],
                     map.blend.begin() + map.blendOffset[i + 1]);
      offset.push_back(static_cast<Index>(terms.size()));
    }
    if (terms.empty()) offset.clear();
    map.blend = std::move(terms), map.blendOffset = std::move(offset);
  }

  const SynthesisInput& in_;
  const RepairOptions& options_;
  const SourceMap& map_;
  Monitor& monitor_;
  PlaceDomain domain_;
  std::vector<std::uint8_t> open_;
  std::vector<float> level_;  // n, that colours are read at; empty: 0
  std::vector<vec2> texel_;   // n, afterwards
  std::vector<Index> moved_;
  std::vector<Index> patches_;  // of those moved
  std::vector<vec2> domains_;   // of those moved; empty: there are none
  RepairStatistics statistics_;
};

void validate(const RepairOptions& options) {
  if (!(options.width >= 0 && options.width <= kMostWidth))
    throw InvalidInput(
        fmt::format("repair: {} is outside 0 to {} pixels", options.width, kMostWidth));
  if (options.levels < 1 || options.levels > kMostLevels)
    throw InvalidInput(
        fmt::format("levels of the repair: {} is outside 1 to {}", options.levels, kMostLevels));
}

}  // namespace

RepairStatistics repairSeams(const SynthesisInput& input, const RepairOptions& options,
                             SourceMap& map, Monitor& monitor) {
  validate(options);
  DAPPLE_CHECK(map.texel.size(), ==, input.points.size());
  DAPPLE_CHECK(map.frame.size(), ==, input.points.size());
  if (PlaceDomain(input.swatch).empty()) return {};
  const SynthesisInput framed{.points = input.points,
                              .neighborhoods = input.neighborhoods,
                              .swatch = input.swatch,
                              .frames = map.frame,
                              .unit = input.unit,
                              .scale = input.scale,
                              .chart = input.chart,
                              .kept = input.kept};
  SeamRepair repair(framed, options, map, monitor);
  const RepairStatistics statistics = repair.run();
  repair.write(map);
  return statistics;
}

}  // namespace dapple
