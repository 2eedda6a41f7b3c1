// The transfer of [Zhang], Appendix A as corrected in methods 2.1 step 4, grown from one point
// outward: every new point takes its place and its axes from the neighbours that have theirs.
// Departure: no distortion limit and no patches; points are taken in rings of growing distance (a
// bucket queue), which is all that a map of a few hundred points around a centre needs.
#include "points/tangent_patch.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "base/hash_rng.h"

namespace dapple {
namespace {

constexpr std::size_t kInitialTable = 1u << 13;
constexpr float kRingSpacings = 0.75f;  // width of a ring in distances of the sixth neighbour
constexpr float kSteepest = 0.01f;      // cosine below which an offset has no tangential part

}  // namespace

TangentPatch::TangentPatch(const PointSet& points, const Neighborhoods& neighborhoods,
                           std::size_t used)
    : points_(points), neighborhoods_(neighborhoods), used_(used), table_(kInitialTable) {
  DAPPLE_CHECK(used, <=, neighborhoods.k);
  DAPPLE_CHECK(points.normals.size(), ==, points.size());
}

// Ids are in Morton order, so sixteen that follow each other share a run of slots (and its cache
// lines); only the runs are scattered.
TangentPatch::Slot& TangentPatch::slotOf(Index id) {
  const std::size_t mask = table_.size() - 1;
  std::size_t at = ((mixBits(id >> 4) << 4) | (id & 15u)) & mask;
  while (table_[at].stamp == stamp_ && table_[at].id != id) at = (at + 1) & mask;
  return table_[at];
}

void TangentPatch::widenTable() {
  std::vector<Slot> old(table_.size() * 2);
  old.swap(table_);
  for (const Slot& slot : old)
    if (slot.stamp == stamp_) slotOf(slot.id) = slot;
}

void TangentPatch::place(Index id, const Site& site, vec2 position) {
  Slot& slot = slotOf(id);
  slot.state = SlotState::Placed;
  slot.site = static_cast<std::uint32_t>(sites_.size());
  sites_.push_back(site);
  flat_.push_back({id, position});
}

void TangentPatch::queueNeighbours(Index id) {
  const auto ids = neighborhoods_.of(id).first(used_);
  const auto distances = neighborhoods_.distancesOf(id);
  const float reached = glm::length(flat_.back().position);
  const vec3 normal = points_.normals[id];
  for (std::size_t j = 0; j < used_; ++j) {
    const auto ring = static_cast<std::size_t>((reached + distances[j]) / ringWidth_);
    if (ring >= ringCount_) continue;
    Slot& slot = slotOf(ids[j]);
    if (slot.stamp == stamp_) {
      if (slot.state != SlotState::Waiting || slot.bucket <= ring) continue;
    } else {
      if (glm::dot(normal, points_.normals[ids[j]]) <= 0) continue;
      slot = {.stamp = stamp_, .id = ids[j]};
      ++tableFill_;
    }
    slot.bucket = static_cast<std::uint32_t>(ring);
    rings_[ring].push_back(ids[j]);
    if (2 * tableFill_ > table_.size()) widenTable();
  }
}

// Methods 2.1, steps 4 and 5: F from every placed P among its neighbours, weighted by 1 / |FP|.
bool TangentPatch::transfer(Index id, Site& site, vec2& position) {
  const auto ids = neighborhoods_.of(id).first(used_);
  const vec3 pF = points_.positions[id], nF = points_.normals[id];
  float sumW = 0;
  vec2 q(0);
  vec3 n(0), t(0);
  for (const Index j : ids) {
    const Slot& slot = slotOf(j);
    if (slot.stamp != stamp_ || slot.state != SlotState::Placed) continue;
    if (glm::dot(points_.normals[j], nF) <= 0) continue;
    const Site& P = sites_[slot.site];
    const vec3 V = pF - P.position;
    const float L = glm::length(V);
    if (!(L > 0)) {  // a twin: V has no direction, and its place is F's
      site = {pF, P.n, P.t};
      position = flat_[slot.site].position;
      return true;
    }
    const vec3 V0 = V / L;
    const float h = glm::dot(V0, P.n), c2 = 1 - h * h;
    if (c2 < kSteepest * kSteepest) continue;
    const float rc = 1 / std::sqrt(c2);
    const float a = glm::dot(V0, glm::cross(P.t, P.n)), b = glm::dot(V0, P.t);
    const vec3 N = (P.n - h * V0) * rc;
    const float w = 1 / L;
    sumW += w;
    q += w * (flat_[slot.site].position + L * rc * vec2(a, b));
    n += w * N;
    // The printed T is not of unit length: its part along V0 must not be shortened (methods 2.2).
    t += w * rc * (b * V0 + a * glm::cross(N, V0));
  }
  if (!(sumW > 0)) return false;
  position = q / sumW;
  site.position = pF;
  site.n = glm::normalize(n);
  site.t = glm::normalize(t - glm::dot(t, site.n) * site.n);
  return std::isfinite(position.x + position.y + site.t.x);
}

std::span<const FlatPoint> TangentPatch::grow(Index centre, const TangentFrame& frame,
                                              float radius) {
  if (++stamp_ == 0) {  // wrapped round: every old stamp would look fresh
    std::fill(table_.begin(), table_.end(), Slot{});
    stamp_ = 1;
  }
  tableFill_ = 0;
  sites_.clear();
  flat_.clear();
  const float near = neighborhoods_.distancesOf(centre)[std::min<std::size_t>(5, used_ - 1)];
  ringWidth_ = std::max(kRingSpacings * near, radius * 1e-3f);
  ringCount_ = static_cast<std::size_t>(radius / ringWidth_) + 1;
  if (rings_.size() < ringCount_) rings_.resize(ringCount_);
  for (auto& ring : rings_) ring.clear();

  slotOf(centre) = {.stamp = stamp_, .id = centre};
  ++tableFill_;
  place(centre, {points_.positions[centre], frame.n, frame.t}, vec2(0));
  queueNeighbours(centre);
  for (std::size_t r = 0; r < ringCount_; ++r) {
    for (std::size_t i = 0; i < rings_[r].size(); ++i) {  // the ring grows while it is walked
      const Index id = rings_[r][i];
      const Slot& slot = slotOf(id);
      if (slot.state != SlotState::Waiting || slot.bucket != r) continue;
      Site site;
      vec2 position;
      if (!transfer(id, site, position)) continue;
      if (glm::length(position) > radius) {
        slotOf(id).state = SlotState::Outside;
        continue;
      }
      place(id, site, position);
      queueNeighbours(id);
    }
  }
  return flat_;
}

}  // namespace dapple
