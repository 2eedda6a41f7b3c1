// [Soler] flattens clusters of faces by way of a coarse control polygon; here the transfer of
// [Zhang] Appendix A carries the chart from point to point, and distortion stands for the ratio of
// areas.
#include "synthesis/cluster_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "synthesis/patch_overlap.h"

namespace dapple {
namespace {

constexpr std::size_t kMostContributors = 16;
constexpr std::size_t kCheckpointEvery = 4096;
constexpr std::size_t kMostRings = 1 << 14;  // what lies further shares the last one
// D, about 15 and 30 % of stretch: directions that are followed can be flattened nowhere.
constexpr float kStrained = 1.6f, kStrainedFollowing = 3.2f;
constexpr float kMostOfBand = 3.2f;  // D of band points: others would mislead
constexpr float kUnmet = std::numeric_limits<float>::infinity();

}  // namespace

ClusterChart::ClusterChart(const SynthesisInput& input, const PointGraph& graph)
    : input_(input),
      positions_(input.chart ? *input.chart : input.points.positions),
      graph_(graph),
      strainedFrom_(input.follow ? kStrainedFollowing : kStrained),
      fit_(kMostContributors, input.unit),
      slot_(input.points.size(), kNone),
      reach_(input.points.size(), kUnmet),
      inside_(input.points.size(), 0) {}

// The point that is nearest to the mean of all.
Index ClusterChart::middleOf(std::span<const Index> cluster) const {
  dvec3 sum(0);
  for (const Index i : cluster) sum += dvec3(positions_[i]);
  const vec3 mean(sum / static_cast<double>(cluster.size()));
  return *std::min_element(cluster.begin(), cluster.end(), [&](Index a, Index b) {
    const float da = distanceBetween(positions_[a], mean),
                db = distanceBetween(positions_[b], mean);
    return da < db || (da == db && a < b);
  });
}

void ClusterChart::place(Index i, const ChartSite& site, float reach) {
  slot_[i] = static_cast<Index>(sites_.size());
  sites_.push_back(site);
  ids_.push_back(i);
  reach_[i] = reach;
}

// Where placed neighbours put point i. False: nowhere, or with a distortion above `most`.
bool ClusterChart::fits(Index i, float most, ChartSite& site) {
  fit_.begin(positions_[i], input_, i);
  std::size_t count = 0;
  for (const Index j : graph_.of(i)) {
    if (slot_[j] == kNone) continue;
    fit_.add(sites_[slot_[j]]);
    if (++count == kMostContributors) break;
  }
  fit_.finish();
  if (fit_.size() == 0) return false;
  const ChartPoint fitted = fit_.average();
  if (!(fitted.distortion <= most)) return false;  // NaN too
  strained_ += fitted.distortion > strainedFrom_ ? 1 : 0;
  site.position = positions_[i], site.normal = input_.points.normals[i];
  site.scale = input_.scaleAt(i);
  site.n = fitted.frame.n, site.t = fitted.frame.t, site.q = fitted.q, site.patch = 0;
  return true;
}

void ClusterChart::enter(Index i, float reach) {
  if (reach_[i] == kUnmet) met_.push_back(i);
  reach_[i] = reach;
  const std::size_t ring = std::min(static_cast<std::size_t>(reach / ringPixels_), kMostRings - 1);
  if (ring >= rings_.size()) rings_.resize(ring + 1);
  rings_[ring].push_back(i);
}

// From the sites from `from` on to all that is open and within `limit` pixels.
template <class Open>
void ClusterChart::spread(std::size_t from, float limit, float mostDistortion, const Open& open,
                          Monitor& monitor) {
  for (auto& ring : rings_) ring.clear();
  const auto follow = [&](Index i, float base) {
    for (const Index j : graph_.of(i)) {
      if (slot_[j] != kNone || !open(j)) continue;
      const float unit = input_.unit * 0.5f * (input_.scaleAt(i) + input_.scaleAt(j));
      const float reach = base + distanceBetween(positions_[i], positions_[j]) / unit;
      if (reach < reach_[j] && reach <= limit) enter(j, reach);
    }
  };
  for (std::size_t s = from, count = sites_.size(); s < count; ++s) follow(ids_[s], 0);
  std::size_t visited = 0;
  for (std::size_t r = 0; r < rings_.size(); ++r)
    for (std::size_t e = 0; e < rings_[r].size(); ++e) {  // the ring may grow meanwhile
      const Index i = rings_[r][e];
      if (slot_[i] != kNone) continue;
      if (++visited % kCheckpointEvery == 0) monitor.checkpoint();
      ChartSite site;
      const float reach = reach_[i];
      if (!fits(i, mostDistortion, site)) {
        reach_[i] = -1;  // not again
        continue;
      }
      place(i, site, reach);
      follow(i, reach);
    }
}

void ClusterChart::flatten(std::span<const Index> cluster, Monitor& monitor) {
  for (const Index i : ids_) slot_[i] = kNone;
  for (const Index i : met_) reach_[i] = kUnmet;
  sites_.clear(), ids_.clear(), met_.clear();
  strained_ = 0;
  const Index middle = middleOf(cluster);
  const auto row = graph_.of(middle);
  if (!row.empty())
    ringPixels_ =
        std::max(0.05f, distanceBetween(positions_[middle], positions_[row[row.size() / 2]]) /
                            input_.unitAt(middle));
  ChartSite site;
  const TangentFrame frame =
      orthonormalFrame(input_.points.normals[middle], input_.frames[middle].t);
  site.position = positions_[middle], site.normal = input_.points.normals[middle];
  site.scale = input_.scaleAt(middle);
  site.n = frame.n, site.t = frame.t, site.patch = 0;
  for (const Index i : cluster) inside_[i] = 1;
  place(middle, site, 0);
  met_.push_back(middle);
  spread(
      0, kUnmet, kUnmet, [&](Index j) { return inside_[j] != 0; }, monitor);
  for (const Index i : cluster) inside_[i] = 0;
  members_ = sites_.size();
}

void ClusterChart::addBand(const std::vector<std::uint8_t>& known, float pixels, Monitor& monitor) {
  const std::size_t strained = strained_;
  spread(
      0, pixels, kMostOfBand, [&](Index j) { return known[j] != 0; }, monitor);
  strained_ = strained;
}

}  // namespace dapple
