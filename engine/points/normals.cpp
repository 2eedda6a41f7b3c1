// Normals of raw scans: local plane fits, then one consistent side (Hoppe et al. 1992, "Surface
// reconstruction from unorganized points", section 3.3: the spanning tree).
#include "points/normals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <queue>

namespace dapple {
namespace {

constexpr std::size_t kGrain = 2048;
constexpr std::size_t kOrientNeighbours = 10;
constexpr std::size_t kSmoothNeighbours = 16;

vec3 planeNormal(const std::vector<vec3>& positions, std::size_t i, std::span<const Index> near) {
  vec3 mean = positions[i];
  for (const Index j : near) mean += positions[j];
  mean /= static_cast<float>(near.size() + 1);
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
  auto add = [&](const vec3& p) {
    const vec3 d = p - mean;
    covariance(0, 0) += d.x * d.x, covariance(1, 0) += d.x * d.y, covariance(1, 1) += d.y * d.y;
    covariance(2, 0) += d.x * d.z, covariance(2, 1) += d.y * d.z, covariance(2, 2) += d.z * d.z;
  };
  add(positions[i]);
  for (const Index j : near) add(positions[j]);
  const float trace = covariance.trace();
  if (!(trace > 0)) return {0, 0, 1};
  covariance /= trace;  // keeps the closed form away from denormals
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3f n = solver.eigenvectors().col(0);
  const vec3 normal(n.x(), n.y(), n.z());
  const float length = glm::length(normal);
  return length > 0.5f ? normal / length : vec3(0, 0, 1);
}

// Neighbours in both directions, so that the graph is undirected. Flat.
struct Graph {
  std::vector<std::size_t> offset;
  std::vector<Index> to;
};

Graph symmetricGraph(const Neighborhoods& neighborhoods, std::size_t used) {
  const std::size_t n = neighborhoods.size();
  Graph graph;
  graph.offset.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (const Index j : neighborhoods.of(i).first(used))
      ++graph.offset[i + 1], ++graph.offset[j + 1];
  for (std::size_t i = 0; i < n; ++i) graph.offset[i + 1] += graph.offset[i];
  graph.to.resize(graph.offset[n]);
  std::vector<std::size_t> next(graph.offset.begin(), graph.offset.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    for (const Index j : neighborhoods.of(i).first(used)) {
      graph.to[next[i]++] = j;
      graph.to[next[j]++] = static_cast<Index>(i);
    }
  return graph;
}

struct Step {
  float cost;
  Index from, to;
  bool operator>(const Step& other) const {
    return std::tie(cost, to, from) > std::tie(other.cost, other.to, other.from);
  }
};

// Walks one connected part from `root` in the order of a minimum spanning tree and turns every
// normal to its tree parent's side. Returns the part's points.
std::vector<Index> alignPart(const Graph& graph, Index root, std::vector<vec3>& normals,
                             std::vector<std::uint8_t>& visited, Monitor& monitor) {
  std::priority_queue<Step, std::vector<Step>, std::greater<>> queue;
  std::vector<Index> part;
  auto visit = [&](Index i) {
    visited[i] = 1;
    part.push_back(i);
    if (part.size() % 4096 == 0) monitor.advance(4096);
    for (std::size_t e = graph.offset[i]; e < graph.offset[i + 1]; ++e) {
      const Index j = graph.to[e];
      if (!visited[j]) queue.push({1 - std::abs(glm::dot(normals[i], normals[j])), i, j});
    }
  };
  visit(root);
  while (!queue.empty()) {
    const Step step = queue.top();
    queue.pop();
    if (visited[step.to]) continue;
    if (glm::dot(normals[step.from], normals[step.to]) < 0) normals[step.to] = -normals[step.to];
    visit(step.to);
  }
  return part;
}

// Where a part reaches furthest along an axis its surface faces that way. All six extremes vote,
// weighted by how squarely they face.
bool facesInward(const std::vector<vec3>& positions, const std::vector<vec3>& normals,
                 const std::vector<Index>& part) {
  float vote = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Index low = part[0], high = part[0];
    for (const Index i : part) {
      if (positions[i][axis] < positions[low][axis]) low = i;
      if (positions[i][axis] > positions[high][axis]) high = i;
    }
    vote += normals[high][axis] - normals[low][axis];
  }
  return vote < 0;
}

}  // namespace

std::vector<vec3> estimateNormals(const std::vector<vec3>& positions,
                                  const Neighborhoods& neighborhoods, std::size_t used,
                                  Monitor& monitor) {
  used = std::min(used, neighborhoods.k);
  std::vector<vec3> normals(positions.size());
  parallelFor(monitor, positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      normals[i] = planeNormal(positions, i, neighborhoods.of(i).first(used));
  });
  return normals;
}

void orientNormals(const std::vector<vec3>& positions, const Neighborhoods& neighborhoods,
                   std::vector<vec3>& normals, Monitor& monitor) {
  const Graph graph = symmetricGraph(neighborhoods, std::min(kOrientNeighbours, neighborhoods.k));
  std::vector<std::uint8_t> visited(positions.size(), 0);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (visited[i]) continue;
    const std::vector<Index> part =
        alignPart(graph, static_cast<Index>(i), normals, visited, monitor);
    if (facesInward(positions, normals, part))
      for (const Index j : part) normals[j] = -normals[j];
  }
}

// The plane's normal is the mean of the neighbours' normals, not a fit of its own: as steady (45
// degrees of noise in a file's normals average out over 17) and a tenth of the cost.
std::vector<vec3> smoothedPositions(const PointSet& points, const Neighborhoods& neighborhoods,
                                    Monitor& monitor) {
  const std::size_t used = std::min(kSmoothNeighbours, neighborhoods.k);
  std::vector<vec3> smoothed(points.size());
  parallelFor(monitor, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      vec3 mean(0), normal = points.normals[i];
      float count = 0;
      for (const Index j : neighborhoods.of(i).first(used)) {
        // Points across a thin sheet would pull the surface inside.
        if (glm::dot(points.normals[i], points.normals[j]) <= 0) continue;
        mean += points.positions[j] - points.positions[i];
        normal += points.normals[j];
        ++count;
      }
      smoothed[i] = points.positions[i];
      const float length = glm::length(normal);
      if (count < 3 || !(length > 0)) continue;
      normal /= length;
      smoothed[i] += normal * glm::dot(mean / count, normal);
    }
  });
  return smoothed;
}

}  // namespace dapple
