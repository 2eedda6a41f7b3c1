// [Zhang] Fast Hybrid Approach for Texturing Point Models, section 3: point parameterization.
//
// Departures (those of Appendix A are in chart_fit.cpp):
// - "Lies next to another patch" is read as: a patch point of another patch is among the k nearest.
//   Only this reading gives the paper's gap width.
// - Positions are moved to the tangent planes of their neighbourhoods first: noise of half a
// spacing
//   makes 4 of 10 points gaps otherwise.
// - A point beside another patch or over the threshold is a gap at once; a point that a full patch
//   has no room for stays free and waits for the next patch.
#include "synthesis/patch_parameterization.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "points/bucket_queue.h"
#include "points/normals.h"
#include "synthesis/chart_fit.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 512;  // points
enum HashStream : std::uint64_t { kSeedOrder = 101, kPlacement = 102 };

// Where the patch that grows may lie in the swatch.
class PatchRoom {
 public:
  PatchRoom(const Swatch& swatch, float sizeLimit) : swatch_(swatch) {
    limit_ = sizeLimit * vec2(swatch.width, swatch.height);
  }

  // A new patch, its seed at q = 0.
  void open(std::uint64_t seed, Index patch) {
    low_ = high_ = vec2(0);
    offset_ = {hashUniform(seed, kPlacement, patch, 0) * static_cast<float>(swatch_.width),
               hashUniform(seed, kPlacement, patch, 1) * static_cast<float>(swatch_.height)};
    if (swatch_.hasHoles) offset_ = opaqueStart(seed, patch);
  }

  // True, and the room is taken, when the patch may grow to q.
  bool take(vec2 q) {
    if (swatch_.tileable) return true;
    const vec2 low = glm::min(low_, q), high = glm::max(high_, q);
    if (high.x - low.x > limit_.x || high.y - low.y > limit_.y) return false;
    if (swatch_.hasHoles && !usableTexel(swatch_, q + offset_)) return false;
    low_ = low, high_ = high;
    return true;
  }

  // A guess at close() while the patch grows, exact when it can be.
  vec2 openOffset() const {
    if (swatch_.tileable || swatch_.hasHoles) return offset_;
    return 0.5f * vec2(swatch_.width, swatch_.height);
  }

  // Once grown: how far the patch's domain lies from swatch coordinates.
  vec2 close() {
    if (swatch_.tileable || swatch_.hasHoles) return offset_;
    const vec2 size(swatch_.width, swatch_.height);
    const vec2 slack = size - 1.f - (high_ - low_);  // centres of border pixels are the limit
    const vec2 margin = glm::min(vec2(kBorderMargin), slack * 0.5f);
    return 0.5f - low_ + margin + offset_ / size * (slack - 2.f * margin);
  }

 private:
  // Kept from the swatch's border where there is room: blending reaches a little beyond a patch.
  static constexpr float kBorderMargin = 3;
  static constexpr int kTries = 16, kWindow = 8;

  // Of some random opaque texels the one with most opaque ones around.
  vec2 opaqueStart(std::uint64_t seed, Index patch) const {
    vec2 best(0.5f);
    int most = -1;
    for (std::uint64_t attempt = 0; attempt < 64 * kTries && (most < 0 || attempt < kTries);
         ++attempt) {
      const int x = static_cast<int>(hashBelow(static_cast<std::uint64_t>(swatch_.width), seed,
                                               kPlacement, patch, 2 * attempt + 2));
      const int y = static_cast<int>(hashBelow(static_cast<std::uint64_t>(swatch_.height), seed,
                                               kPlacement, patch, 2 * attempt + 3));
      const int around = opaqueAround(x, y);
      if (around > most) most = around, best = vec2(x, y) + 0.5f;
    }
    return best;
  }

  // Opaque texels near (x, y); -1 when it is not opaque itself.
  int opaqueAround(int x, int y) const {
    auto opaque = [&](int px, int py) {
      if (px < 0 || py < 0 || px >= swatch_.width || py >= swatch_.height) return false;
      return swatch_.opaque[static_cast<std::size_t>(py) * static_cast<std::size_t>(swatch_.width) +
                            static_cast<std::size_t>(px)] != 0;
    };
    if (!opaque(x, y)) return -1;
    int count = 0;
    for (int dy = -kWindow; dy <= kWindow; ++dy)
      for (int dx = -kWindow; dx <= kWindow; ++dx) count += opaque(x + dx, y + dy) ? 1 : 0;
    return count;
  }

  const Swatch& swatch_;
  vec2 limit_, offset_{0}, low_{0}, high_{0};
};

// Every point as a chart sees it, on no patch yet, at its smoothed or own position.
std::vector<ChartSite> chartSites(const SynthesisInput& input, const std::vector<vec3>& positions) {
  std::vector<ChartSite> sites(input.points.size());
  for (std::size_t i = 0; i < sites.size(); ++i)
    sites[i].position = positions[i], sites[i].normal = input.points.normals[i],
    sites[i].scale = input.scaleAt(i);
  return sites;
}

class Grower {
 public:
  Grower(const SynthesisInput& input, const PatchOptions& options, SourceMap& map, Monitor& monitor)
      : input_(input),
        options_(options),
        map_(map),
        monitor_(monitor),
        reverse_(reverseNeighborhoods(input.neighborhoods, monitor)),
        sites_(chartSites(input, input.chart ? *input.chart
                                 : options.smooth
                                     ? smoothedPositions(input.points, input.neighborhoods, monitor)
                                     : input.points.positions)),
        room_(input.swatch, options.sizeLimit),
        fit_(input.neighborhoods.k, input.unit) {
    const std::size_t n = input.points.size();
    map_.domain.resize(n, vec2(0));
    fronts_.resize(n);
    contributors_.resize(input.neighborhoods.k);
    for (Index i = 0; i < n; ++i)
      if (input.isKept(i)) keep(i);
  }

  PatchStatistics run() {
    for (const Index start : seedOrder())
      if (map_.state[start] == PointState::Free) growFrom(start);
    if (!grown_.empty())
      statistics_.meanDistortion = distortionSum_ / static_cast<double>(grown_.size());
    return statistics_;
  }

 private:
  std::vector<Index> seedOrder() const {
    std::vector<Index> order(input_.points.size());
    std::iota(order.begin(), order.end(), Index{0});
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[hashBelow(i, options_.seed, kSeedOrder, i)]);
    return order;
  }

  bool sameSide(Index i, Index j) const { return glm::dot(sites_[i].normal, sites_[j].normal) > 0; }

  void growFrom(Index start) {
    const Index patch = static_cast<Index>(map_.placement.size());
    if (touchesPatch(start)) return markGap(start);
    ++statistics_.patches;
    room_.open(options_.seed, patch);
    const std::size_t first = grown_.size();
    accept(start, patch, {.frame = orthonormalFrame(sites_[start].normal, input_.frames[start].t)});
    for (KeyBuckets::Entry next = queue_.pop(); next.id != kNone; next = queue_.pop()) {
      const Front& front = fronts_[next.id];
      if (front.key == next.key && waits(front, patch)) decide(next.id, patch);
    }
    place(first, room_.close());
  }

  // True when i faces the side of a patch point among its neighbours that is not of `patch`.
  bool touchesPatch(Index i, Index patch = kNone) const {
    for (const Index j : input_.neighborhoods.of(i))
      if (sites_[j].patch != kNone && sites_[j].patch != patch && sameSide(i, j)) return true;
    return false;
  }

  // Step 3: contributors from this patch only, else a gap. Then steps 4 to 7.
  void decide(Index i, Index patch) {
    // Which neighbours are patch points cannot be foreseen: no branch may depend on it.
    std::size_t count = 0;
    bool others = false;
    for (const Index j : input_.neighborhoods.of(i)) {
      const Index of = fronts_[j].patch;
      contributors_[count] = j;
      count += of != kNone ? 1 : 0;
      others |= of != kNone && of != patch;
    }
    if (others && touchesPatch(i, patch)) return markGap(i);
    fit_.begin(sites_[i].position, input_, i);
    for (std::size_t c = 0; c < count; ++c) {
      const Index j = contributors_[c];
      if (sites_[j].patch == patch && sameSide(i, j)) fit_.add(sites_[j]);
    }
    fit_.finish();
    // Reached only from the side or across a thin sheet: left for another patch.
    if (fit_.size() == 0) return;
    const ChartPoint fitted = fit_.average();
    if (!(fitted.distortion <= options_.distortion)) return markGap(i);  // NaN is a gap too
    if (room_.take(fitted.q))
      accept(i, patch, fitted);
    else
      fronts_[i].refusedBy = patch;
  }

  // What a point is to its neighbours once it is on a patch.
  void join(Index i, Index patch, vec2 q, const TangentFrame& frame) {
    sites_[i].patch = patch;
    sites_[i].q = q;
    sites_[i].n = frame.n;
    sites_[i].t = frame.t;
    fronts_[i].patch = patch;
    fronts_[i].decided = true;
  }

  void keep(Index i) {
    join(i, map_.patch[i], map_.domain[i], map_.frame[i]);
    for (const Index j : reverse_.of(i)) ++fronts_[j].key;
    ++decided_;
  }

  void accept(Index i, Index patch, const ChartPoint& fitted) {
    join(i, patch, fitted.q, fitted.frame);
    map_.state[i] = PointState::Patch;
    map_.patch[i] = patch;
    map_.domain[i] = fitted.q;
    map_.frame[i] = fitted.frame;
    map_.error[i] = fitted.distortion;
    map_.order[i] = static_cast<Index>(decided_);
    grown_.push_back(i);
    distortionSum_ += fitted.distortion;
    statistics_.maxDistortion =
        std::max(statistics_.maxDistortion, static_cast<double>(fitted.distortion));
    raised_.resize(std::max(raised_.size(), reverse_.of(i).size()));
    std::size_t count = 0;
    for (const Index j : reverse_.of(i)) {
      Front& front = fronts_[j];
      ++front.key;
      raised_[count] = j;
      count += waits(front, patch) ? 1 : 0;
    }
    for (std::size_t r = 0; r < count; ++r) queue_.push(fronts_[raised_[r]].key, raised_[r]);
    countDecided();
  }

  void markGap(Index i) {
    fronts_[i].decided = true;
    map_.state[i] = PointState::Gap;
    ++statistics_.gapPoints;
    countDecided();
  }

  void countDecided() {
    if (++decided_ % kCheckpointEvery != 0) return;
    monitor_.advance(kCheckpointEvery);
    if (monitor_.wantsPreview()) preview();
  }

  // The patch at hand has no place in the swatch yet: shown where it probably will be.
  void preview() {
    for (shown_ = std::max(shown_, placed_); shown_ < grown_.size(); ++shown_) {
      const Index i = grown_[shown_];
      map_.colour[i] = sampleSwatch(input_.swatch, map_.domain[i] + room_.openOffset());
    }
    monitor_.publish({map_.colour, map_.state});
  }

  // Step 8.
  void place(std::size_t first, vec2 offset) {
    map_.placement.push_back(offset);
    for (std::size_t g = first; g < grown_.size(); ++g) placePoint(map_, input_.swatch, grown_[g]);
    placed_ = grown_.size();
  }

  // All that the queue asks of a point, small enough to stay in the cache.
  struct Front {
    Index refusedBy = kNone;  // the last patch that had no room for the point
    Index patch = kNone;      // as in its site
    std::uint16_t key = 0;    // patch points, of any patch, among the k nearest
    bool decided = false;
  };
  static bool waits(const Front& front, Index patch) {
    return !front.decided & (front.refusedBy != patch);
  }

  const SynthesisInput& input_;
  const PatchOptions& options_;
  SourceMap& map_;
  Monitor& monitor_;
  const ReverseNeighborhoods reverse_;
  std::vector<ChartSite> sites_;
  PatchRoom room_;
  KeyBuckets queue_;
  ChartFit fit_;
  std::vector<Front> fronts_;
  std::vector<Index> contributors_, raised_;  // of the point at hand
  std::vector<Index> grown_;                  // patch points, patch after patch
  std::size_t decided_ = 0;
  std::size_t placed_ = 0, shown_ = 0;  // of grown_: in the swatch, in the last preview
  double distortionSum_ = 0;
  PatchStatistics statistics_;
};

// Step 9: gap points in the queue's order; each blends what its neighbours' patches say and then
// counts as a point of its dominant patch.
class GapBlender {
 public:
  GapBlender(const SynthesisInput& input, SourceMap& map, Monitor& monitor)
      : input_(input),
        map_(map),
        monitor_(monitor),
        sites_(chartSites(input, input.points.positions)),
        fit_(input.neighborhoods.k, input.unit) {
    for (std::size_t i = 0; i < sites_.size(); ++i)
      if (map.state[i] == PointState::Patch)
        sites_[i].q = map.domain[i], sites_[i].n = map.frame[i].n, sites_[i].t = map.frame[i].t,
        sites_[i].patch = map.patch[i];
  }

  void run() {
    const std::size_t n = input_.points.size();
    first_.assign(n, 0);
    count_.assign(n, 0);
    key_.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      if (map_.state[i] != PointState::Gap) continue;
      for (const Index j : input_.neighborhoods.of(i)) key_[i] += coloured(j) ? 1 : 0;
      queue_.push(key_[i], static_cast<Index>(i));
    }
    std::size_t done = 0;
    for (KeyBuckets::Entry next = queue_.pop(); next.id != kNone; next = queue_.pop()) {
      if (coloured(next.id) || key_[next.id] != next.key) continue;
      blend(next.id);
      // Gap points that have this one among their k nearest: a list of their own neighbours would
      // do in an even scan; here gaps are few, so that looking both ways is cheap enough.
      for (const Index j : input_.neighborhoods.of(next.id)) {
        if (coloured(j)) continue;
        ++key_[j];
        queue_.push(key_[j], j);
      }
      if (++done % kCheckpointEvery != 0) continue;
      monitor_.checkpoint();
      if (monitor_.wantsPreview()) preview();
    }
    writeTerms();
  }

 private:
  bool coloured(Index i) const { return sites_[i].patch != kNone; }

  void blend(Index i) {
    gather(i);
    if (fit_.size() == 0) return;
    float weights = 0;
    for (std::size_t c = 0; c < fit_.size(); ++c) weights += fit_.weight(c);
    first_[i] = static_cast<Index>(terms_.size());
    count_[i] = static_cast<Index>(fit_.size());
    for (std::size_t c = 0; c < fit_.size(); ++c)
      terms_.push_back({wrapTexel(input_.swatch, fit_.q(c) + map_.placement[fit_.patch(c)]),
                        fit_.patch(c), fit_.weight(c) / weights});
    blended_.push_back(i);
    const Index dominant = fit_.dominantPatch();
    fit_.keepPatch(dominant);
    const ChartPoint fitted = fit_.average();
    sites_[i].patch = dominant;
    sites_[i].q = fitted.q, sites_[i].n = fitted.frame.n, sites_[i].t = fitted.frame.t;
    map_.domain[i] = fitted.q;
    map_.texel[i] = wrapTexel(input_.swatch, fitted.q + map_.placement[dominant]);
    map_.frame[i] = fitted.frame;
    map_.patch[i] = dominant;
    map_.error[i] = fitted.distortion;
  }

  // What is blended so far; writeTerms() makes these colours again.
  void preview() {
    for (; shown_ < blended_.size(); ++shown_) {
      const Index i = blended_[shown_];
      map_.colour[i] = vec3(0);
      for (Index c = 0; c < count_[i]; ++c) {
        const BlendTerm& term = terms_[first_[i] + c];
        map_.colour[i] += term.weight * sampleSwatch(input_.swatch, term.texel);
      }
    }
    monitor_.publish({map_.colour, map_.state});
  }

  void gather(Index i) {
    fit_.begin(sites_[i].position, input_, i);
    for (const Index j : input_.neighborhoods.of(i))
      if (coloured(j) && glm::dot(sites_[i].normal, sites_[j].normal) > 0) fit_.add(sites_[j]);
    fit_.finish();
    if (fit_.size() > 0) return;
    // Everything around is too steep or faces away: better a neighbour's texel than no colour.
    for (const Index j : input_.neighborhoods.of(i)) {
      if (!coloured(j)) continue;
      fit_.begin(sites_[j].position, input_, i);
      fit_.add(sites_[j]);
      fit_.finish();
      return;
    }
  }

  // Terms were met in the queue's order; the map has them by point.
  void writeTerms() {
    map_.blendOffset.assign(1, 0);
    map_.blend.clear();
    map_.blend.reserve(terms_.size());
    for (std::size_t i = 0; i < count_.size(); ++i) {
      for (Index c = 0; c < count_[i]; ++c) map_.blend.push_back(terms_[first_[i] + c]);
      map_.blendOffset.push_back(static_cast<Index>(map_.blend.size()));
      if (count_[i] > 0) map_.colour[i] = mappedColour(map_, input_.swatch, i);
    }
  }

  const SynthesisInput& input_;
  SourceMap& map_;
  Monitor& monitor_;
  std::vector<ChartSite> sites_;
  KeyBuckets queue_;
  ChartFit fit_;
  std::vector<Index> key_, first_, count_;
  std::vector<BlendTerm> terms_;
  std::vector<Index> blended_;  // in the queue's order
  std::size_t shown_ = 0;       // of them, in the last preview
};

void validate(const PatchOptions& options) {
  if (!(options.distortion >= 0))
    throw InvalidInput(fmt::format("distortion is {}; it must be 0 or more", options.distortion));
  if (!(options.sizeLimit > 0 && options.sizeLimit <= 1))
    throw InvalidInput(
        fmt::format("size limit is {}; it must be above 0 and at most 1", options.sizeLimit));
}

}  // namespace

PatchStatistics growPatches(const SynthesisInput& input, const PatchOptions& options,
                            SourceMap& map, Monitor& monitor) {
  validate(options);
  DAPPLE_CHECK(map.state.size(), ==, input.points.size());
  return Grower(input, options, map, monitor).run();
}

void blendGaps(const SynthesisInput& input, SourceMap& map, Monitor& monitor) {
  GapBlender(input, map, monitor).run();
}

}  // namespace dapple
