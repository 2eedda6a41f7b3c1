// Shortest ways along the links of a scan, in buckets of about equal length.
#pragma once

#include <span>
#include <vector>

#include "regions/segmentation.h"

namespace dapple {

// Links of a point that segmentation follows: its nearest.
std::size_t linksOf(const Neighborhoods& neighborhoods);

// Shortest ways from several sources, label by label, along the links that points have; where those
// do not lead, along the links that others have to them (neighbours are not mutual). Distances are
// the least over all ways, sums taken from the source on: the same whatever the order of the
// search.
class SurfaceWays {
 public:
  // `lengths` (n x linksOf): of each link. All must outlive this.
  SurfaceWays(const LinkedPoints& graph, const std::vector<float>& lengths);

  // Points closer to `source` than to all before take `label`.
  void add(Index source, Index label);
  // Brings all distances up to date, none above `limit`.
  void run(float limit, Monitor& monitor);

  const std::vector<float>& distances() const { return distance_; }  // n, infinite: not reached
  const std::vector<Index>& labels() const { return label_; }        // n, kNone: not reached

 private:
  void enter(Index i, float distance, Index label);
  void drain(float limit, Monitor& monitor);
  bool followLinksOfOthers(float limit, Monitor& monitor);
  float length(std::size_t i, std::size_t link) const { return lengths_[i * links_ + link]; }

  const LinkedPoints graph_;
  const std::vector<float>& lengths_;
  const std::size_t links_;
  float step_;  // width of a bucket: a speed, not a precision
  std::vector<float> distance_;
  std::vector<Index> label_;
  std::vector<std::vector<Index>> buckets_;
  std::size_t first_ = 0;  // bucket that may hold something
};

}  // namespace dapple
