// Stands in for engine/points/neighborhoods.cpp until that is merged: delete then. Weak, so that
// both together still link.
#include <cmath>
#include <nanoflann.hpp>
#include <numbers>

#include "points/neighborhoods.h"

namespace dapple {
namespace {
struct Cloud {
  const std::vector<vec3>& p;
  std::size_t kdtree_get_point_count() const { return p.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t d) const { return p[i][static_cast<int>(d)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
}  // namespace

__attribute__((weak)) Neighborhoods buildNeighborhoods(const std::vector<vec3>& positions,
                                                       std::size_t k, Monitor&) {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>,
                                                   Cloud, 3, Index>;
  const Cloud cloud{positions};
  Tree tree(3, cloud, {12});
  tree.buildIndex();
  Neighborhoods result{k, {}, {}};
  std::vector<Index> ids(k + 1);
  std::vector<float> squares(k + 1);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    tree.knnSearch(&positions[i].x, k + 1, ids.data(), squares.data());
    std::size_t taken = 0;
    for (std::size_t j = 0; j <= k && taken < k; ++j) {
      if (ids[j] == i) continue;
      result.ids.push_back(ids[j]);
      result.distances.push_back(std::sqrt(squares[j]));
      ++taken;
    }
  }
  return result;
}

__attribute__((weak)) double meanSpacing(const Neighborhoods& n) {
  double sum = 0;
  for (std::size_t i = 0; i < n.size(); ++i) sum += n.distancesOf(i)[n.k - 1];
  return sum / static_cast<double>(n.size()) *
         std::sqrt(std::numbers::pi / (static_cast<double>(n.k) + 0.5));
}

}  // namespace dapple
