// Not in [Zhang], whose patches end where they meet. Growth goes by distance from the patches (a
// Dijkstra search over candidates in place of points), so that every point is laid out by what lies
// between it and the patch, and uses the fit of section 3.2.
#include "synthesis/patch_overlap.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "base/errors.h"
#include "base/scratch_pool.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 1024;     // points
constexpr std::size_t kStepGrain = 128;  // steps
constexpr std::size_t kSteps = 8;        // nearest neighbours that growth steps to
constexpr std::size_t kFitted = 10;      // nearest neighbours that lay a point out
constexpr float kSteepest = 2;           // steps in the domain are at most so many times as long
constexpr std::size_t kMostOfPoint = 6;  // candidates
constexpr std::size_t kFewest = 3;       // contributors that must agree
constexpr float kBucketsPerPixel = 4;

// Growth goes by waves: all steps of one bucket, of several to the same point the first. Steps of
// a wave see what was there before it and nothing of each other.
class OverlapGrower {
 public:
  OverlapGrower(const SynthesisInput& input, const SourceMap& map, float overlap, Monitor& monitor)
      : input_(input),
        positions_(input.chart ? *input.chart : input.points.positions),
        map_(map),
        monitor_(monitor),
        overlap_(overlap),
        steps_(std::min(kSteps, input.neighborhoods.k)),
        fitted_(std::min(kFitted, input.neighborhoods.k)),
        buckets_(static_cast<std::size_t>(overlap * kBucketsPerPixel) + 1),
        fits_([this] { return std::make_unique<ChartFit>(fitted_ * kMostOfPoint, input_.unit); }) {}

  PatchOverlap run() {
    makeSites();
    const std::size_t n = input_.points.size();
    spreadAll(n, kGrain, [&](std::size_t i, std::vector<Step>& steps) {
      if (atBorder(static_cast<Index>(i)))
        spread(static_cast<Index>(i), static_cast<Index>(i), steps);
    });
    for (std::size_t b = 0; b < buckets_.size(); ++b) {
      while (!buckets_[b].empty()) {
        wave(std::exchange(buckets_[b], {}), b);
        if (monitor_.wantsPreview()) preview();
      }
      monitor_.advance(pointsOfStep(n, b, buckets_.size()));
    }
    return collected();
  }

 private:
  struct Step {
    Index to, patch;
    vec2 q;  // where the candidate that is stepped from puts the point
    float reach;
  };
  struct Place {  // of a candidate: what most questions are about
    vec2 q;
    Index patch;
    Index next = kNone;  // candidate of the same point
  };

  void makeSites() {
    const std::size_t n = input_.points.size();
    sites_.reserve(n + n);
    places_.reserve(n + n);
    sites_.resize(n);
    places_.resize(n);
    count_.assign(n, 1);
    wave_.assign(n, 0);
    reach_.assign(n, 0);
    distortion_ = map_.error;
    parallelFor(monitor_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        ChartSite& site = sites_[i];
        site.position = positions_[i], site.normal = input_.points.normals[i];
        site.scale = input_.scaleAt(i);
        site.n = map_.frame[i].n, site.t = map_.frame[i].t, site.q = map_.domain[i];
        site.patch = map_.state[i] == PointState::Patch ? map_.patch[i] : kNone;
        places_[i] = {site.q, site.patch};
      }
    });
  }

  bool sameSide(Index i, Index j) const { return glm::dot(sites_[i].normal, sites_[j].normal) > 0; }

  float pixelsTo(Index from, Index to) const {
    return distanceBetween(input_.points.positions[from], input_.points.positions[to]) /
           input_.unitAt(from);
  }

  // True for a patch point with a neighbour that is not plainly next to it in the patch.
  bool atBorder(Index i) const {
    const Place& place = places_[i];
    if (place.patch == kNone) return false;
    const auto near = input_.neighborhoods.of(i);
    const float within = kCoherentPixels + pixelsTo(i, near[steps_ - 1]);
    for (std::size_t s = 0; s < steps_; ++s) {
      const Place& other = places_[near[s]];
      if (other.patch != place.patch || !nearPlaces(other.q, place.q, within)) return true;
    }
    return false;
  }

  // True when point i has a candidate of the patch at q.
  bool has(Index i, Index patch, vec2 q) const {
    for (Index c = i; c != kNone; c = places_[c].next)
      if (places_[c].patch == patch && nearPlaces(places_[c].q, q, kCoherentPixels)) return true;
    return false;
  }

  static bool nearPlaces(vec2 a, vec2 b, float pixels) {
    const float x = a.x - b.x, y = a.y - b.y;
    return x * x + y * y < pixels * pixels;
  }

  // Puts the steps that body(i, steps) finds for i < count into the buckets, in the order of i.
  template <class Body>
  void spreadAll(std::size_t count, std::size_t grain, Body body) {
    std::vector<std::vector<Step>> found((count + grain - 1) / grain);
    parallelFor(monitor_, count, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i, found[begin / grain]);
    });
    for (const std::vector<Step>& steps : found)
      for (const Step& step : steps)
        buckets_[static_cast<std::size_t>(step.reach * kBucketsPerPixel)].push_back(step);
  }

  // Steps to neighbours of point i that candidate c of it does not go on into.
  void spread(Index i, Index c, std::vector<Step>& steps) const {
    const ChartSite& from = sites_[c];
    const auto near = input_.neighborhoods.of(i);
    for (std::size_t s = 0; s < steps_; ++s) {
      const Index j = near[s];
      const float reach = reach_[c] + pixelsTo(i, j);
      if (!(reach <= overlap_)) return;
      if (!sameSide(i, j)) continue;
      // Where kept patches meet they stay cut as they are.
      if (from.patch < input_.keptPatches() && input_.isKept(j)) continue;
      const vec2 q = carriedPlace(from, sites_[j], input_.unit);
      if (!has(j, from.patch, q)) steps.push_back({j, from.patch, q, reach});
    }
  }

  // Gap points as the first patch that has reached them would colour them.
  void preview() {
    std::vector<vec3> colours(map_.colour);
    parallelFor(monitor_, colours.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Index c = places_[i].next;
        if (map_.state[i] != PointState::Gap || c == kNone) continue;
        const vec2 texel = places_[c].q + map_.placement[places_[c].patch];
        if (usableTexel(input_.swatch, wrapTexel(input_.swatch, texel)))
          colours[i] = sampleSwatch(input_.swatch, texel);
      }
    });
    monitor_.publish({colours, map_.state});
  }

  void wave(std::vector<Step> steps, std::size_t bucket) {
    ++clock_;
    std::erase_if(steps, [&](const Step& step) {
      if (std::exchange(wave_[step.to], clock_) != clock_) return false;
      buckets_[bucket].push_back(step);
      return true;
    });
    std::vector<std::optional<ChartPoint>> fitted(steps.size());
    parallelFor(monitor_, steps.size(), kStepGrain, [&](std::size_t begin, std::size_t end) {
      fits_.use([&](ChartFit& fit) {
        for (std::size_t s = begin; s < end; ++s) fitted[s] = visit(steps[s], fit);
      });
    });
    std::vector<std::pair<Index, Index>> added;  // point, candidate
    for (std::size_t s = 0; s < steps.size(); ++s) {
      if (!fitted[s] || count_[steps[s].to] == kMostOfPoint) continue;
      added.push_back({steps[s].to, static_cast<Index>(sites_.size())});
      add(steps[s], *fitted[s]);
    }
    spreadAll(added.size(), kStepGrain, [&](std::size_t a, std::vector<Step>& out) {
      spread(added[a].first, added[a].second, out);
    });
  }

  std::optional<ChartPoint> visit(const Step& step, ChartFit& fit) const {
    if (has(step.to, step.patch, step.q)) return std::nullopt;
    gather(step, fit);
    fit.keepNear(step.q, kCoherentPixels);
    if (fit.size() < kFewest) return std::nullopt;
    const ChartPoint fitted = fit.average();
    if (has(step.to, step.patch, fitted.q)) return std::nullopt;
    return fitted;
  }

  // Contributors that may place the point near where the step does.
  void gather(const Step& step, ChartFit& fit) const {
    const auto near = input_.neighborhoods.of(step.to);
    const vec3 normal = sites_[step.to].normal;
    fit.begin(sites_[step.to].position, input_, step.to);
    for (std::size_t s = 0; s < fitted_; ++s) {
      const Index j = near[s];
      const float within = kSteepest * pixelsTo(step.to, j) + kCoherentPixels;
      for (Index c = j; c != kNone; c = places_[c].next)
        if (places_[c].patch == step.patch && nearPlaces(places_[c].q, step.q, within) &&
            glm::dot(normal, sites_[c].normal) > 0)
          fit.add(sites_[c]);
    }
    fit.finish();
  }

  void add(const Step& step, const ChartPoint& fitted) {
    Index last = step.to;
    while (places_[last].next != kNone) last = places_[last].next;
    places_[last].next = static_cast<Index>(sites_.size());
    ++count_[step.to];
    ChartSite site = sites_[step.to];
    site.q = fitted.q, site.patch = step.patch;
    site.n = fitted.frame.n, site.t = fitted.frame.t;
    sites_.push_back(site);
    places_.push_back({fitted.q, step.patch});
    reach_.push_back(step.reach);
    distortion_.push_back(fitted.distortion);
  }

  // Points come with one candidate of no patch, which counts for nothing.
  PatchOverlap collected() const {
    PatchOverlap overlap;
    const std::size_t n = input_.points.size();
    overlap.offset.assign(1, 0);
    overlap.offset.reserve(n + 1);
    for (std::size_t i = 0; i < n; ++i)
      overlap.offset.push_back(overlap.offset.back() + count_[i] -
                               (places_[i].patch == kNone ? 1 : 0));
    overlap.site.resize(overlap.offset[n]);
    overlap.distortion.resize(overlap.offset[n]);
    overlap.reach.resize(overlap.offset[n]);
    parallelFor(monitor_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Index to = overlap.offset[i];
        for (Index c = static_cast<Index>(i); c != kNone; c = places_[c].next) {
          if (places_[c].patch == kNone) continue;
          overlap.site[to] = sites_[c];
          overlap.distortion[to] = distortion_[c];
          overlap.reach[to] = reach_[c];
          ++to;
        }
      }
    });
    return overlap;
  }

  const SynthesisInput& input_;
  const std::vector<vec3>& positions_;
  const SourceMap& map_;
  Monitor& monitor_;
  const float overlap_;
  const std::size_t steps_, fitted_;
  std::vector<ChartSite> sites_;  // candidates: n of the points themselves, then as they are found
  std::vector<Place> places_;     // of each
  std::vector<float> reach_, distortion_;
  std::vector<std::uint8_t> count_;  // n: candidates of the point
  std::vector<Index> wave_;          // n: the last one that stepped to the point
  Index clock_ = 0;
  std::vector<std::vector<Step>> buckets_;
  ScratchPool<ChartFit> fits_;
};

}  // namespace

PatchOverlap growOverlap(const SynthesisInput& input, const SourceMap& map, float overlap,
                         Monitor& monitor) {
  DAPPLE_CHECK(map.domain.size(), ==, input.points.size());
  return OverlapGrower(input, map, overlap, monitor).run();
}

}  // namespace dapple
