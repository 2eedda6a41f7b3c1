// The surroundings of a point flattened onto its tangent plane: an approximate logarithmic map.
#pragma once

#include <span>
#include <vector>

#include "points/neighborhoods.h"
#include "points/point_set.h"

namespace dapple {

struct FlatPoint {
  Index id;
  vec2 position;  // along the frame's s and t, local units; the centre is (0, 0)
};

// Grows such maps, one at a time; keeps its memory between calls, so have one for each thread.
class TangentPatch {
 public:
  // Walks along the `used` nearest neighbours of each point, between points whose normals agree
  // within 90 degrees. References are kept.
  TangentPatch(const PointSet& points, const Neighborhoods& neighborhoods, std::size_t used);

  // The points within `radius` (local units, on the surface) of `centre`, the centre first, the
  // others roughly outward. `frame` belongs to the centre. Valid until the next call.
  std::span<const FlatPoint> grow(Index centre, const TangentFrame& frame, float radius);

  // The centre's frame carried to the i-th point of the last map.
  TangentFrame carriedFrame(std::size_t i) const { return {sites_[i].s, sites_[i].t, sites_[i].n}; }

 private:
  struct alignas(64) Site {
    vec3 position;
    vec3 s, t, n;  // transported axes
    vec2 flat;
  };

  void place(Index id, const Site& site);
  void queueNeighbours(Index id);
  float distanceTo(Index from, Index to) const {
    return distanceBetween(points_.positions[from], points_.positions[to]);
  }
  bool transfer(Index id, Site& site);

  const PointSet& points_;
  const Neighborhoods& neighborhoods_;
  std::size_t used_;
  std::vector<std::uint32_t> status_;  // n: kUnseen, kWaiting + ring, or the index of the site
  std::vector<Index> seen_;            // that are not kUnseen
  std::vector<Site> sites_;
  std::vector<FlatPoint> flat_;
  std::vector<std::vector<Index>> rings_;  // waiting points by distance from the centre
  float ringWidth_ = 1;
  std::size_t ringCount_ = 0;
};

}  // namespace dapple
