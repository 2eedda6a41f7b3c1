#include "points/connected_parts.h"

#include <algorithm>
#include <numeric>

namespace dapple {
namespace {

Index rootOf(std::vector<Index>& parent, Index i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// linked(i, j) is asked for each point i and its neighbours j, nearest first.
enum class Link { Yes, No, NoneFurther };

template <class Linked>
ConnectedParts partsOf(const Neighborhoods& neighborhoods, std::size_t links, Linked linked) {
  const std::size_t n = neighborhoods.size();
  std::vector<Index> parent(n);
  std::iota(parent.begin(), parent.end(), Index{0});
  for (Index i = 0; i < n; ++i)
    for (const Index j : neighborhoods.of(i).first(links)) {
      const Link link = linked(i, j);
      if (link == Link::NoneFurther) break;
      if (link == Link::No) continue;
      const Index a = rootOf(parent, i), b = rootOf(parent, j);
      parent[std::max(a, b)] = std::min(a, b);
    }
  ConnectedParts out;
  out.part.resize(n);
  for (Index i = 0; i < n; ++i) {
    const Index root = rootOf(parent, i);
    out.part[i] = root == i ? static_cast<Index>(out.count++) : out.part[root];
  }
  return out;
}

}  // namespace

ConnectedParts connectedParts(const Neighborhoods& neighborhoods,
                              const std::vector<vec3>& positions, float reach) {
  return partsOf(neighborhoods, neighborhoods.k, [&](Index i, Index j) {
    return distanceBetween(positions[i], positions[j]) > reach ? Link::NoneFurther : Link::Yes;
  });
}

ConnectedParts facingParts(const Neighborhoods& neighborhoods, const std::vector<vec3>& normals,
                           std::size_t links) {
  return partsOf(neighborhoods, links, [&](Index i, Index j) {
    return glm::dot(normals[i], normals[j]) > 0 ? Link::Yes : Link::No;
  });
}

}  // namespace dapple
