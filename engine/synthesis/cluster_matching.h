// Finds where in the swatch, and how turned, a flattened cluster suits what lies around it.
#pragma once

#include <span>
#include <vector>

#include "base/monitor.h"
#include "points/point_set.h"
#include "swatch/swatch_search.h"
#include "swatch/texel_reader.h"
#include "synthesis/lattice_relaxation.h"

namespace dapple {

// A turn of the flattened domain in the swatch's plane, pixels with y down.
class DomainTurn {
 public:
  DomainTurn() = default;
  explicit DomainTurn(float radians);
  vec2 operator()(vec2 q) const {
    return {cosine_ * q.x - sine_ * q.y, sine_ * q.x + cosine_ * q.y};
  }
  // The axes that a turned domain gives the swatch, where `frame` is that of the domain itself.
  TangentFrame of(const TangentFrame& frame) const;

 private:
  float cosine_ = 1, sine_ = 0;
};

// Where its points lie, flattened and not turned yet.
struct ClusterBorder {
  std::span<const vec2> inside;           // of the cluster
  std::span<const BorderSample> samples;  // around it
};

struct ClusterMatch {
  DomainTurn turn;
  vec2 placement{0};  // of the domain's 0, swatch pixels
  float error = 0;    // root mean square colour difference per channel over the samples compared
};

// The box of places, turned.
PlacementBox boxOf(std::span<const vec2> places, const DomainTurn& turn);

// search() may be called from one thread at a time.
class ClusterMatcher {
 public:
  // Compares on the given level of the swatch's stack. The swatch must outlive this.
  ClusterMatcher(const Swatch& swatch, int level);

  // The best place for each of the angles (radians) that has one, best first. In a swatch that does
  // not tile the cluster's points lie inside. None without samples.
  std::vector<ClusterMatch> matches(const ClusterBorder& border, std::span<const float> angles,
                                    Monitor& monitor) const;

  const TexelReader& reader() const { return reader_; }

 private:
  bool matchTurned(const ClusterBorder& border, float angle, ClusterMatch& out) const;

  const Swatch& swatch_;
  const std::shared_ptr<const SwatchSearch> search_;
  const TexelReader reader_;
};

}  // namespace dapple
