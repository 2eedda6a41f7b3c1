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
constexpr std::size_t kMostOfPoint = 6;  // candidates
constexpr std::size_t kFewest = 3;       // contributors that must agree
constexpr std::size_t kBucketsPerPixel = 8;

class OverlapGrower {
 public:
  OverlapGrower(const SynthesisInput& input, const SourceMap& map, float overlap, Monitor& monitor)
      : input_(input),
        map_(map),
        monitor_(monitor),
        overlap_(overlap),
        steps_(std::min(kSteps, input.neighborhoods.k)),
        fit_(input.neighborhoods.k * kMostOfPoint, input.unit),
        buckets_(static_cast<std::size_t>(overlap * kBucketsPerPixel) + 1) {
    const std::size_t n = input.points.size();
    all_.resize(n);
    next_.assign(n, kNone);
    for (std::size_t i = 0; i < n; ++i) {
      ChartSite& site = all_[i].site;
      site.position = input.points.positions[i], site.normal = input.points.normals[i];
      site.n = map.frame[i].n, site.t = map.frame[i].t, site.q = map.domain[i];
      site.patch = map.state[i] == PointState::Patch ? map.patch[i] : kNone;
      all_[i].distortion = map.error[i];
    }
  }

  PatchOverlap run() {
    const std::size_t n = input_.points.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (all_[i].site.patch != kNone) spread(static_cast<Index>(i), static_cast<Index>(i));
      if (i % kCheckpointEvery == 0) monitor_.checkpoint();
    }
    std::size_t done = 0;
    for (auto& bucket : buckets_) {
      for (std::size_t e = 0; e < bucket.size(); ++e) {
        visit(bucket[e]);
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

  bool sameSide(Index i, Index j) const {
    return glm::dot(all_[i].site.normal, all_[j].site.normal) > 0;
  }

  // True when point i has a candidate of the patch at q.
  bool has(Index i, Index patch, vec2 q) const {
    for (Index c = i; c != kNone; c = next_[c]) {
      const ChartSite& site = all_[c].site;
      const vec2 d = site.q - q;
      if (site.patch == patch && glm::dot(d, d) < kCoherentPixels * kCoherentPixels) return true;
    }
    return false;
  }

  // Neighbours of point i that candidate c of it does not go on into.
  void spread(Index i, Index c) {
    const PlaceCandidate& from = all_[c];
    const auto near = input_.neighborhoods.of(i);
    const auto distances = input_.neighborhoods.distancesOf(i);
    for (std::size_t s = 0; s < steps_; ++s) {
      const Index j = near[s];
      const float reach = from.reach + distances[s] / input_.unit;
      if (!(reach <= overlap_) || !sameSide(i, j)) continue;
      if (has(j, from.site.patch, carriedPlace(from.site, all_[j].site.position, input_.unit)))
        continue;
      buckets_[static_cast<std::size_t>(reach * kBucketsPerPixel)].push_back({j, c, reach});
    }
  }

  void visit(const Step& step) {
    const ChartSite& from = all_[step.from].site;
    const vec3 position = all_[step.to].site.position;
    vec2 q = carriedPlace(from, position, input_.unit);
    if (has(step.to, from.patch, q)) return;
    gather(step.to, from.patch);
    fit_.keepNear(q, kCoherentPixels);
    if (fit_.size() < kFewest) return;
    const ChartPoint fitted = fit_.average();
    if (has(step.to, from.patch, fitted.q)) return;
    add(step, from.patch, fitted);
  }

  void gather(Index i, Index patch) {
    fit_.begin(all_[i].site.position);
    for (const Index j : input_.neighborhoods.of(i)) {
      if (!sameSide(i, j)) continue;
      for (Index c = j; c != kNone; c = next_[c])
        if (all_[c].site.patch == patch) fit_.add(all_[c].site);
    }
    fit_.finish();
  }

  void add(const Step& step, Index patch, const ChartPoint& fitted) {
    Index last = step.to;
    for (std::size_t count = 1; next_[last] != kNone; last = next_[last])
      if (++count == kMostOfPoint) return;
    const Index c = static_cast<Index>(all_.size());
    PlaceCandidate candidate = all_[step.to];
    candidate.distortion = fitted.distortion, candidate.reach = step.reach;
    candidate.site.q = fitted.q, candidate.site.patch = patch;
    candidate.site.n = fitted.frame.n, candidate.site.t = fitted.frame.t;
    all_.push_back(candidate);
    next_.push_back(kNone);
    next_[last] = c;
    spread(step.to, c);
  }

  PatchOverlap collected() const {
    PatchOverlap overlap;
    const std::size_t n = input_.points.size();
    overlap.offset.reserve(n + 1);
    overlap.candidates.reserve(all_.size());
    for (std::size_t i = 0; i < n; ++i) {
      overlap.offset.push_back(overlap.candidates.size());
      for (Index c = static_cast<Index>(i); c != kNone; c = next_[c])
        if (all_[c].site.patch != kNone) overlap.candidates.push_back(all_[c]);
    }
    overlap.offset.push_back(overlap.candidates.size());
    return overlap;
  }

  const SynthesisInput& input_;
  const SourceMap& map_;
  Monitor& monitor_;
  const float overlap_;
  const std::size_t steps_;
  ChartFit fit_;
  std::vector<PlaceCandidate> all_;  // n of the points themselves, then as they are found
  std::vector<Index> next_;          // of the same point
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
