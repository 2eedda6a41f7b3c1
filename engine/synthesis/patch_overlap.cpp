// Not in [Zhang], whose patches end where they meet. Growth goes by distance from the patches (a
// Dijkstra search over candidates in place of points), so that every point is laid out by what lies
// between it and the patch, and uses the fit of section 3.2.
#include "synthesis/patch_overlap.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 512;
constexpr std::size_t kSteps = 10;       // nearest neighbours that growth steps to
constexpr std::size_t kFitted = 12;      // nearest neighbours that lay a point out
constexpr float kSteepest = 2;           // steps in the domain are at most so many times as long
constexpr std::size_t kMostOfPoint = 6;  // candidates
constexpr std::size_t kFewest = 3;       // contributors that must agree
constexpr std::size_t kBucketsPerPixel = 8;

class OverlapGrower {
 public:
  OverlapGrower(const SynthesisInput& input, const SourceMap& map, float overlap, Monitor& monitor)
      : input_(input),
        monitor_(monitor),
        overlap_(overlap),
        steps_(std::min(kSteps, input.neighborhoods.k)),
        fitted_(std::min(kFitted, input.neighborhoods.k)),
        fit_(fitted_ * kMostOfPoint, input.unit),
        buckets_(static_cast<std::size_t>(overlap * kBucketsPerPixel) + 1) {
    const std::size_t n = input.points.size();
    sites_.reserve(n + n / 2);
    sites_.resize(n);
    next_.assign(n, kNone);
    reach_.assign(n, 0);
    distortion_ = map.error;
    for (std::size_t i = 0; i < n; ++i) {
      ChartSite& site = sites_[i];
      site.position = input.points.positions[i], site.normal = input.points.normals[i];
      site.n = map.frame[i].n, site.t = map.frame[i].t, site.q = map.domain[i];
      site.patch = map.state[i] == PointState::Patch ? map.patch[i] : kNone;
    }
  }

  PatchOverlap run() {
    const std::size_t n = input_.points.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (atBorder(static_cast<Index>(i))) spread(static_cast<Index>(i), static_cast<Index>(i));
      if (i % kCheckpointEvery == 0) monitor_.checkpoint();
    }
    std::size_t done = 0;
    for (auto& bucket : buckets_) {
      for (std::size_t e = 0; e < bucket.size(); ++e) {
        visit(Step(bucket[e]));
        if (++done % kCheckpointEvery == 0) monitor_.checkpoint();
      }
      bucket = {};
    }
    return collected();
  }

 private:
  struct Step {
    Index to, from;  // a point, and the candidate of a neighbour that it is reached by
    float reach;
  };

  bool sameSide(Index i, Index j) const { return glm::dot(sites_[i].normal, sites_[j].normal) > 0; }

  // True for a patch point with a neighbour that is not plainly next to it in the patch.
  bool atBorder(Index i) const {
    const ChartSite& site = sites_[i];
    if (site.patch == kNone) return false;
    const auto near = input_.neighborhoods.of(i);
    const float within =
        kCoherentPixels + input_.neighborhoods.distancesOf(i)[steps_ - 1] / input_.unit;
    for (std::size_t s = 0; s < steps_; ++s)
      if (sites_[near[s]].patch != site.patch || !nearPlaces(sites_[near[s]].q, site.q, within))
        return true;
    return false;
  }

  // True when point i has a candidate of the patch at q.
  bool has(Index i, Index patch, vec2 q) const {
    for (Index c = i; c != kNone; c = next_[c])
      if (sites_[c].patch == patch && nearPlaces(sites_[c].q, q, kCoherentPixels)) return true;
    return false;
  }

  static bool nearPlaces(vec2 a, vec2 b, float pixels) {
    const float x = a.x - b.x, y = a.y - b.y;
    return x * x + y * y < pixels * pixels;
  }

  // Neighbours of point i that candidate c of it does not go on into.
  void spread(Index i, Index c) {
    const ChartSite& from = sites_[c];
    const auto near = input_.neighborhoods.of(i);
    const auto distances = input_.neighborhoods.distancesOf(i);
    for (std::size_t s = 0; s < steps_; ++s) {
      const Index j = near[s];
      const float reach = reach_[c] + distances[s] / input_.unit;
      if (!(reach <= overlap_)) return;
      if (!sameSide(i, j)) continue;
      if (has(j, from.patch, carriedPlace(from, sites_[j].position, input_.unit))) continue;
      buckets_[static_cast<std::size_t>(reach * kBucketsPerPixel)].push_back({j, c, reach});
    }
  }

  void visit(const Step& step) {
    const ChartSite& from = sites_[step.from];
    const vec2 q = carriedPlace(from, sites_[step.to].position, input_.unit);
    if (has(step.to, from.patch, q)) return;
    gather(step.to, from.patch, q);
    fit_.keepNear(q, kCoherentPixels);
    if (fit_.size() < kFewest) return;
    const ChartPoint fitted = fit_.average();
    if (!has(step.to, from.patch, fitted.q)) add(step, from.patch, fitted);
  }

  // Contributors of the patch that may place point i near q.
  void gather(Index i, Index patch, vec2 q) {
    const auto near = input_.neighborhoods.of(i);
    const auto distances = input_.neighborhoods.distancesOf(i);
    fit_.begin(sites_[i].position);
    for (std::size_t s = 0; s < fitted_; ++s) {
      const Index j = near[s];
      const float within = kSteepest * distances[s] / input_.unit + kCoherentPixels;
      for (Index c = j; c != kNone; c = next_[c])
        if (sites_[c].patch == patch && nearPlaces(sites_[c].q, q, within) && sameSide(i, j))
          fit_.add(sites_[c]);
    }
    fit_.finish();
  }

  void add(const Step& step, Index patch, const ChartPoint& fitted) {
    Index last = step.to;
    for (std::size_t count = 1; next_[last] != kNone; last = next_[last])
      if (++count == kMostOfPoint) return;
    const Index c = static_cast<Index>(sites_.size());
    ChartSite site = sites_[step.to];
    site.q = fitted.q, site.patch = patch;
    site.n = fitted.frame.n, site.t = fitted.frame.t;
    sites_.push_back(site);
    next_.push_back(kNone);
    reach_.push_back(step.reach);
    distortion_.push_back(fitted.distortion);
    next_[last] = c;
    spread(step.to, c);
  }

  PatchOverlap collected() const {
    PatchOverlap overlap;
    const std::size_t n = input_.points.size();
    overlap.offset.reserve(n + 1);
    overlap.site.reserve(sites_.size());
    overlap.distortion.reserve(sites_.size());
    overlap.reach.reserve(sites_.size());
    for (std::size_t i = 0; i < n; ++i) {
      overlap.offset.push_back(static_cast<Index>(overlap.site.size()));
      for (Index c = static_cast<Index>(i); c != kNone; c = next_[c]) {
        if (sites_[c].patch == kNone) continue;
        overlap.site.push_back(sites_[c]);
        overlap.distortion.push_back(distortion_[c]);
        overlap.reach.push_back(reach_[c]);
      }
    }
    overlap.offset.push_back(static_cast<Index>(overlap.site.size()));
    return overlap;
  }

  const SynthesisInput& input_;
  Monitor& monitor_;
  const float overlap_;
  const std::size_t steps_, fitted_;
  ChartFit fit_;
  std::vector<ChartSite> sites_;  // candidates: n of the points themselves, then as they are found
  std::vector<float> reach_, distortion_;  // of each
  std::vector<Index> next_;                // candidate of the same point
  std::vector<std::vector<Step>> buckets_;
};

}  // namespace

vec2 carriedPlace(const ChartSite& from, const vec3& position, float unit) {
  // As in chart_fit.cpp: the step along the plane, stretched to its length in space.
  const vec3 step = position - from.position;
  const vec3 s = glm::cross(from.t, from.n);
  const float along = glm::dot(step, s), up = glm::dot(step, from.t);
  const float flat2 = along * along + up * up, length2 = glm::dot(step, step);
  if (!(flat2 > 1e-4f * length2)) return from.q;
  return from.q + std::sqrt(length2 / flat2) / unit * vec2(along, -up);
}

PatchOverlap growOverlap(const SynthesisInput& input, const SourceMap& map, float overlap,
                         Monitor& monitor) {
  DAPPLE_CHECK(map.domain.size(), ==, input.points.size());
  return OverlapGrower(input, map, overlap, monitor).run();
}

}  // namespace dapple
