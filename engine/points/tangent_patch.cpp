// The transfer of [Zhang], Appendix A as corrected in methods 2.1 step 4, grown from one point
// outward: every new point takes its place and its axes from the neighbours that have theirs.
// Departures: no distortion limit and no patches; points are taken in rings of growing distance (a
// bucket queue), which is all that a map of a few hundred points around a centre needs; and only
// the nearest few placed neighbours are asked, as the further ones weigh little.
#include "points/tangent_patch.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::uint32_t kWaiting = 0x80000000u, kOutside = 0xfffffffeu, kUnseen = 0xffffffffu;
constexpr float kRingSpacings = 0.75f;  // width of a ring in distances of the sixth neighbour
constexpr float kSteepest = 1e-4f;  // squared cosine below which an offset has no tangential part
constexpr int kContributors = 4;
constexpr std::size_t kQueued = 8;  // neighbours that a placed point puts in the queue
constexpr std::size_t kMostUsed = 64;

}  // namespace

TangentPatch::TangentPatch(const PointSet& points, const Neighborhoods& neighborhoods,
                           std::size_t used)
    : points_(points), neighborhoods_(neighborhoods), used_(used), status_(points.size(), kUnseen) {
  DAPPLE_CHECK(used, <=, neighborhoods.k);
  DAPPLE_CHECK(used, <=, kMostUsed);
  DAPPLE_CHECK(points.normals.size(), ==, points.size());
}

void TangentPatch::place(Index id, const Site& site) {
  status_[id] = static_cast<std::uint32_t>(sites_.size());
  sites_.push_back(site);
  flat_.push_back({id, site.flat});
}

void TangentPatch::queueNeighbours(Index id) {
  const auto ids = neighborhoods_.of(id).first(used_);
  const float reached = glm::length(flat_.back().position);
  const vec3 normal = points_.normals[id];
  for (std::size_t j = 0; j < std::min(kQueued, used_); ++j) {
    const auto ring = static_cast<std::uint32_t>((reached + distanceTo(id, ids[j])) / ringWidth_);
    if (ring >= ringCount_) break;  // the others are no nearer
    std::uint32_t& status = status_[ids[j]];
    if (status == kUnseen) {
      if (glm::dot(normal, points_.normals[ids[j]]) <= 0) continue;
      seen_.push_back(ids[j]);
    } else if (status <= kWaiting + ring || status == kOutside) {
      continue;
    }
    status = kWaiting + ring;
    rings_[ring].push_back(ids[j]);
  }
}

// Methods 2.1, steps 4 and 5: F from placed neighbours P, each weighted by 1 / |FP|. With
// V = F - P, L = |V| and m the length of V's part in P's tangent plane, (a, b) = (V.S, V.T) / m is
// the direction there, and the printed N_l = (N - h V0) / c, M = N_l x V0 become
// (L N - (V.N / L) V) / m and a T - b S. The printed T is not of unit length: its part along V0
// must not be shortened (methods 2.2).
bool TangentPatch::transfer(Index id, Site& site) {
  const vec3 pF = points_.positions[id], nF = points_.normals[id];
  // Who is placed, without a branch that cannot be foreseen.
  std::array<std::uint32_t, kMostUsed> placed;
  std::size_t count = 0;
  for (const Index j : neighborhoods_.of(id).first(used_)) {
    placed[count] = status_[j];
    count += status_[j] < kWaiting;
  }
  float sumW = 0;
  vec2 q(0);
  vec3 n(0), t(0);
  int asked = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const Site& P = sites_[placed[c]];
    if (glm::dot(P.n, nF) <= 0) continue;
    const vec3 V = pF - P.position;
    const float L2 = glm::dot(V, V), h = glm::dot(V, P.n), m2 = L2 - h * h;
    if (!(L2 > 0)) {  // a twin: V has no direction, and its place is F's
      site = P;
      return true;
    }
    if (m2 < kSteepest * L2) continue;
    const float w = 1 / std::sqrt(L2), rm = 1 / std::sqrt(m2);
    const float a = glm::dot(V, P.s) * rm, b = glm::dot(V, P.t) * rm;
    sumW += w;
    q += w * P.flat + vec2(a, b);
    n += rm * (P.n - (h * w * w) * V);
    t += w * ((b * w) * V + a * (a * P.t - b * P.s));
    if (++asked == kContributors) break;
  }
  if (asked == 0) return false;
  site.position = pF;
  site.flat = q / sumW;
  site.n = glm::normalize(n);
  site.t = glm::normalize(t - glm::dot(t, site.n) * site.n);
  site.s = glm::cross(site.t, site.n);
  return std::isfinite(site.flat.x + site.flat.y + site.t.x);
}

std::span<const FlatPoint> TangentPatch::grow(Index centre, const TangentFrame& frame,
                                              float radius) {
  for (const Index id : seen_) status_[id] = kUnseen;
  seen_.assign(1, centre);
  sites_.clear();
  flat_.clear();
  const float near =
      distanceTo(centre, neighborhoods_.of(centre)[std::min<std::size_t>(5, used_ - 1)]);
  ringWidth_ = std::max(kRingSpacings * near, radius * 1e-3f);
  ringCount_ = static_cast<std::size_t>(radius / ringWidth_) + 1;
  if (rings_.size() < ringCount_) rings_.resize(ringCount_);
  for (auto& ring : rings_) ring.clear();

  place(centre, {points_.positions[centre], frame.s, frame.t, frame.n, vec2(0)});
  queueNeighbours(centre);
  for (std::uint32_t r = 0; r < ringCount_; ++r) {
    for (std::size_t i = 0; i < rings_[r].size(); ++i) {  // the ring grows while it is walked
      const Index id = rings_[r][i];
      if (status_[id] != kWaiting + r) continue;  // placed, or queued nearer, meanwhile
      Site site;
      if (!transfer(id, site)) continue;
      if (glm::length(site.flat) > radius) {
        status_[id] = kOutside;
        continue;
      }
      place(id, site);
      queueNeighbours(id);
    }
  }
  return flat_;
}

}  // namespace dapple
