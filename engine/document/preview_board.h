// What a synthesis has so far, on the whole scan.
#pragma once

#include "document/apply.h"

namespace dapple {

// Used by the thread of the job only.
class PreviewBoard {
 public:
  explicit PreviewBoard(const Document& document);

  void begins(std::span<const Index> points, std::size_t before, std::size_t total);
  void show(const Preview& preview);  // of the points that begins() named
  void ends(const SourceMap& map);

  // Progress of all regions from that of the one at hand.
  Progress overall(Progress progress) const;

  const std::vector<vec3>& colours() const { return colours_; }      // n
  const std::vector<PointState>& states() const { return states_; }  // n

 private:
  std::size_t at(std::size_t r) const { return points_.empty() ? r : points_[r]; }

  std::vector<Index> points_;
  double before_ = 0, share_ = 1, total_ = 0;
  std::vector<vec3> colours_;
  std::vector<PointState> states_;
};

}  // namespace dapple
