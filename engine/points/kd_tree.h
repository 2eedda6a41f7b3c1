// nanoflann over a list of positions, for a few questions about any place; the neighbourhoods of
// all points are found otherwise (neighborhoods.h), and compared with this in tests and bench/.
#pragma once

#include <nanoflann.hpp>
#include <vector>

#include "base/types.h"

namespace dapple {

struct KdCloud {
  const std::vector<vec3>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<int>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using KdTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, KdCloud>, KdCloud, 3>;

}  // namespace dapple
