// [Zhang] Fast Hybrid Approach for Texturing Point Models, section 3: point parameterization.
//
// Departures:
// - Appendix A is used as corrected in tangent_transfer.h.
// - Weights are u / max(L, u/1000): distances in swatch pixels, so that the un-normalised maximum
// in
//   D_pos is dimensionless, and the same shape has the same D in millimetres and in metres.
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
#include <optional>

#include "base/bucket_queue.h"
#include "base/errors.h"
#include "base/hash_rng.h"
#include "points/normals.h"
#include "synthesis/tangent_transfer.h"

namespace dapple {
namespace {

constexpr float kPositionWeight = 2, kOrientationWeight = 3;  // of D
constexpr std::size_t kCheckpointEvery = 512;                 // points
enum HashStream : std::uint64_t { kSeedOrder = 101, kPlacement = 102 };

// What one patch point says about a neighbour.
struct Contribution {
  vec2 q;
  vec3 n, t;
  float weight;
  Index patch;
};

struct Flattened {
  vec2 q{0};
  TangentFrame frame;
  float distortion = 0;
};

// Step 4: the contribution of patch point P, flattened at qP, to a point `step` away.
std::optional<Contribution> contribute(const TangentFrame& frame, vec2 qP, const vec3& step,
                                       float unit) {
  const float length = glm::length(step);
  const float weight = unit / std::max(length, unit * 1e-3f);
  if (!(length > 0)) return Contribution{qP, frame.n, frame.t, weight, kNone};  // a twin of P
  const Transfer transfer = transferAcross(frame, step, length);
  if (!transfer.valid) return std::nullopt;
  return Contribution{qP + transfer.offset / unit, transfer.n, transfer.t, weight, kNone};
}

// Steps 5 and 6: the weighted mean of all contributions, and how much they disagree.
Flattened average(const std::vector<Contribution>& contributions) {
  vec2 q(0);
  vec3 n(0), t(0);
  float weights = 0;
  for (const Contribution& c : contributions) {
    q += c.weight * c.q;
    n += c.weight * c.n;
    t += c.weight * c.t;
    weights += c.weight;
  }
  Flattened out{.q = q / weights, .frame = orthonormalFrame(n, t)};
  float positionSum = 0, positionMost = 0, orientationSum = 0, orientationMost = 0;
  for (const Contribution& c : contributions) {
    const float apart = c.weight * glm::length(c.q - out.q);
    const vec3 s = glm::cross(c.t, c.n);
    const float turned = c.weight * (2 - glm::dot(s, out.frame.s) - glm::dot(c.t, out.frame.t));
    positionSum += apart;
    orientationSum += turned;
    positionMost = std::max(positionMost, apart);
    orientationMost = std::max(orientationMost, turned);
  }
  out.distortion = kOrientationWeight * (orientationSum / weights + orientationMost) +
                   kPositionWeight * (positionSum / weights + positionMost);
  return out;
}

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

class Grower {
 public:
  Grower(const SynthesisInput& input, const PatchOptions& options, SourceMap& map, Monitor& monitor)
      : input_(input),
        options_(options),
        map_(map),
        monitor_(monitor),
        reverse_(reverseNeighborhoods(input.neighborhoods)),
        room_(input.swatch, options.sizeLimit),
        queue_(input.neighborhoods.k) {
    const std::size_t n = input.points.size();
    if (options.smooth) smoothed_ = smoothedPositions(input.points, input.neighborhoods, monitor);
    map_.domain.assign(n, vec2(0));
    key_.assign(n, 0);
    refusedBy_.assign(n, kNone);
    contributions_.reserve(input.neighborhoods.k);
  }

  PatchStatistics run() {
    for (const Index start : seedOrder())
      if (map_.state[start] == PointState::Free) growFrom(start);
    if (statistics_.patches > 0)
      statistics_.meanDistortion = distortionSum_ / static_cast<double>(decidedPatch_);
    return statistics_;
  }

 private:
  const std::vector<vec3>& positions() const {
    return options_.smooth ? smoothed_ : input_.points.positions;
  }

  std::vector<Index> seedOrder() const {
    std::vector<Index> order(input_.points.size());
    std::iota(order.begin(), order.end(), Index{0});
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[hashBelow(i, options_.seed, kSeedOrder, i)]);
    return order;
  }

  void growFrom(Index start) {
    const Index patch = static_cast<Index>(statistics_.patches);
    if (touchesPatch(start)) return markGap(start);
    ++statistics_.patches;
    room_.open(options_.seed, patch);
    const std::size_t first = grown_.size();
    const vec3 n = input_.points.normals[start];
    accept(start, patch, Flattened{.frame = orthonormalFrame(n, input_.frames[start].t)});
    for (BucketQueue::Entry next = queue_.pop(); next.id != kNone; next = queue_.pop())
      if (map_.state[next.id] == PointState::Free && key_[next.id] == next.key &&
          refusedBy_[next.id] != patch)
        decide(next.id, patch);
    place(first, room_.close());
  }

  bool touchesPatch(Index i) const {
    for (const Index j : input_.neighborhoods.of(i))
      if (map_.state[j] == PointState::Patch &&
          glm::dot(input_.points.normals[i], input_.points.normals[j]) > 0)
        return true;
    return false;
  }

  // Step 3: contributors from this patch only, else a gap. Steps 4 to 7.
  void decide(Index i, Index patch) {
    contributions_.clear();
    const vec3 normal = input_.points.normals[i], position = positions()[i];
    for (const Index j : input_.neighborhoods.of(i)) {
      if (map_.state[j] != PointState::Patch) continue;
      if (!(glm::dot(normal, input_.points.normals[j]) > 0)) continue;
      if (map_.patch[j] != patch) return markGap(i);
      const auto c =
          contribute(map_.frame[j], map_.domain[j], position - positions()[j], input_.unit);
      if (c) contributions_.push_back(*c);
    }
    // Reached only from the side or across a thin sheet: left for another patch.
    if (contributions_.empty()) return;
    const Flattened flat = average(contributions_);
    if (!(flat.distortion <= options_.distortion)) return markGap(i);  // NaN is a gap too
    if (!room_.take(flat.q)) {
      refusedBy_[i] = patch;
      return;
    }
    accept(i, patch, flat);
  }

  void accept(Index i, Index patch, const Flattened& flat) {
    map_.state[i] = PointState::Patch;
    map_.patch[i] = patch;
    map_.domain[i] = flat.q;
    map_.frame[i] = flat.frame;
    map_.error[i] = flat.distortion;
    map_.order[i] = static_cast<Index>(decided_);
    grown_.push_back(i);
    distortionSum_ += flat.distortion;
    ++decidedPatch_;
    statistics_.maxDistortion =
        std::max(statistics_.maxDistortion, static_cast<double>(flat.distortion));
    for (const Index j : reverse_.of(i)) {
      ++key_[j];
      if (map_.state[j] == PointState::Free && refusedBy_[j] != patch) queue_.push(key_[j], j);
    }
    countDecided();
  }

  void markGap(Index i) {
    map_.state[i] = PointState::Gap;
    ++statistics_.gapPoints;
    countDecided();
  }

  void countDecided() {
    if (++decided_ % kCheckpointEvery != 0) return;
    monitor_.advance(kCheckpointEvery);
    if (monitor_.wantsPreview()) monitor_.publish({map_.colour, map_.state});
  }

  // Step 8.
  void place(std::size_t first, vec2 offset) {
    map_.placement.push_back(offset);
    for (std::size_t g = first; g < grown_.size(); ++g) {
      const Index i = grown_[g];
      map_.texel[i] = wrapTexel(input_.swatch, map_.domain[i] + offset);
      map_.colour[i] = sampleSwatch(input_.swatch, map_.texel[i]);
    }
  }

  const SynthesisInput& input_;
  const PatchOptions& options_;
  SourceMap& map_;
  Monitor& monitor_;
  const ReverseNeighborhoods reverse_;
  std::vector<vec3> smoothed_;
  PatchRoom room_;
  BucketQueue queue_;
  std::vector<Index> key_;        // patch points, of any patch, among the k nearest
  std::vector<Index> refusedBy_;  // the last patch that had no room for the point
  std::vector<Index> grown_;      // patch points, patch after patch
  std::vector<Contribution> contributions_;
  std::size_t decided_ = 0, decidedPatch_ = 0;
  double distortionSum_ = 0;
  PatchStatistics statistics_;
};

// Step 9: gap points in the queue's order; each blends what its neighbours' patches say and then
// counts as a point of its dominant patch.
class GapBlender {
 public:
  GapBlender(const SynthesisInput& input, SourceMap& map, Monitor& monitor)
      : input_(input), map_(map), monitor_(monitor), queue_(input.neighborhoods.k) {}

  void run() {
    const std::size_t n = input_.points.size();
    terms_.resize(n);
    key_.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      if (map_.state[i] != PointState::Gap) continue;
      for (const Index j : input_.neighborhoods.of(i)) key_[i] += coloured(j) ? 1 : 0;
      queue_.push(key_[i], static_cast<Index>(i));
    }
    std::size_t done = 0;
    const ReverseNeighborhoods reverse = reverseNeighborhoods(input_.neighborhoods);
    for (BucketQueue::Entry next = queue_.pop(); next.id != kNone; next = queue_.pop()) {
      if (coloured(next.id) || key_[next.id] != next.key) continue;
      blend(next.id);
      for (const Index j : reverse.of(next.id)) {
        ++key_[j];
        if (!coloured(j)) queue_.push(key_[j], j);
      }
      if (++done % kCheckpointEvery == 0) monitor_.checkpoint();
    }
    writeTerms();
  }

 private:
  bool coloured(Index i) const { return map_.patch[i] != kNone; }

  void blend(Index i) {
    gather(i);
    if (contributions_.empty()) return;
    float weights = 0;
    for (const Contribution& c : contributions_) weights += c.weight;
    const Index dominant = dominantPatch();
    for (const Contribution& c : contributions_)
      terms_[i].push_back(
          {wrapTexel(input_.swatch, c.q + map_.placement[c.patch]), c.patch, c.weight / weights});
    std::erase_if(contributions_, [&](const Contribution& c) { return c.patch != dominant; });
    const Flattened flat = average(contributions_);
    map_.domain[i] = flat.q;
    map_.texel[i] = wrapTexel(input_.swatch, flat.q + map_.placement[dominant]);
    map_.frame[i] = flat.frame;
    map_.patch[i] = dominant;
    map_.error[i] = flat.distortion;
  }

  void gather(Index i) {
    contributions_.clear();
    const vec3 normal = input_.points.normals[i], position = input_.points.positions[i];
    for (const Index j : input_.neighborhoods.of(i)) {
      if (!coloured(j) || !(glm::dot(normal, input_.points.normals[j]) > 0)) continue;
      auto c = contribute(map_.frame[j], map_.domain[j], position - input_.points.positions[j],
                          input_.unit);
      // Too steep to carry anything: better the neighbour's own texel than no colour at all.
      if (!c) c = Contribution{map_.domain[j], map_.frame[j].n, map_.frame[j].t, 1e-3f, kNone};
      c->patch = map_.patch[j];
      contributions_.push_back(*c);
    }
  }

  Index dominantPatch() const {
    Index best = kNone;
    float most = -1;
    for (const Contribution& c : contributions_) {
      float sum = 0;
      for (const Contribution& other : contributions_)
        if (other.patch == c.patch) sum += other.weight;
      if (sum > most || (sum == most && c.patch < best)) most = sum, best = c.patch;
    }
    return best;
  }

  void writeTerms() {
    map_.blendOffset.assign(1, 0);
    map_.blend.clear();
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      map_.blend.insert(map_.blend.end(), terms_[i].begin(), terms_[i].end());
      map_.blendOffset.push_back(static_cast<Index>(map_.blend.size()));
      if (!terms_[i].empty()) map_.colour[i] = mappedColour(map_, input_.swatch, i);
    }
  }

  const SynthesisInput& input_;
  SourceMap& map_;
  Monitor& monitor_;
  BucketQueue queue_;
  std::vector<Index> key_;
  std::vector<Contribution> contributions_;
  std::vector<std::vector<BlendTerm>> terms_;
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
