// Flattens one cluster of points and, in the same chart, what lies around it.
#pragma once

#include <span>
#include <vector>

#include "base/monitor.h"
#include "points/point_graph.h"
#include "synthesis/chart_fit.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

// One chart at a time; keeps its memory between calls. `input` and `graph` must outlive it.
class ClusterChart {
 public:
  ClusterChart(const SynthesisInput& input, const PointGraph& graph);

  // Lays out the cluster from the point in its middle outward, by distance; that point is at q = 0
  // and has the input's axes. Points that no link leads to are left out.
  void flatten(std::span<const Index> cluster, Monitor& monitor);

  // Then those that are `known` (n) and at most `pixels` along the links from the cluster, as far
  // as they can be flattened without strain.
  void addBand(const std::vector<std::uint8_t>& known, float pixels, Monitor& monitor);

  // The cluster's points, its middle first, then the band's.
  std::span<const ChartSite> sites() const { return sites_; }
  std::span<const Index> ids() const { return ids_; }
  std::size_t members() const { return members_; }    // of them: of the cluster
  std::size_t strained() const { return strained_; }  // of these: bent or stretched too much

 private:
  Index middleOf(std::span<const Index> cluster) const;
  void place(Index i, const ChartSite& site, float reach);
  bool fits(Index i, float most, ChartSite& site);
  void enter(Index i, float reach);
  template <class Open>
  void spread(std::size_t from, float limit, float mostDistortion, const Open& open,
              Monitor& monitor);

  const SynthesisInput& input_;
  const std::vector<vec3>& positions_;
  const PointGraph& graph_;
  const float strainedFrom_;
  ChartFit fit_;
  std::vector<Index> slot_;           // n: index of the site, kNone: none
  std::vector<float> reach_;          // n: shortest known way, pixels; infinite: none
  std::vector<Index> met_;            // whose reach is finite
  std::vector<std::uint8_t> inside_;  // n: of the cluster at hand
  std::vector<ChartSite> sites_;
  std::vector<Index> ids_;
  std::size_t members_ = 0, strained_ = 0;
  float ringPixels_ = 1;
  std::vector<std::vector<Index>> rings_;  // waiting points by reach
};

}  // namespace dapple
