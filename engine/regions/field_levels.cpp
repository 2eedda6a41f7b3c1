#include "regions/field_levels.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/errors.h"
#include "points/point_hierarchy.h"
#include "regions/tangent_numbers.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr std::size_t kFewestNodes = 16;
constexpr double kLeastGain =
    0.8;  // a level with more of the nodes below than this is not worth it
// How far the wish to be upright reaches where it has to give in to smoothness, in root mean square
// distances of the points from their centre.
constexpr double kUprightReach = 0.1;

// What a level is made from; not needed to solve.
struct Cloud {
  std::span<const vec3> positions, normals;  // n_l
  std::vector<float> weight;                 // by link; empty at the finest level: 1 / d

  // Of link e, from node i. Of methods 1.3: w = 1 / d. Coarser links sum up the weights of the
  // links that they merge.
  float weightOf(std::size_t e, Index i, Index j) const {
    return weight.empty() ? weightOver(distanceBetween(positions[i], positions[j])) : weight[e];
  }
  static float weightOver(float distance) { return 1 / std::max(distance, 1e-12f); }
};

double reachOf(std::span<const vec3> positions) {
  dvec3 sum(0);
  double squares = 0;
  for (const vec3& p : positions) sum += dvec3(p);
  const dvec3 centre = sum / static_cast<double>(positions.size());
  for (const vec3& p : positions) squares += glm::dot(dvec3(p) - centre, dvec3(p) - centre);
  return kUprightReach * std::sqrt(squares / static_cast<double>(positions.size()));
}

// Unit length. A surface that faces along `up` has no upright direction: z then, or x, as
// framesTowards() does point by point.
vec3 usableUp(std::span<const vec3> normals, const vec3& up) {
  constexpr double kTooSteep = 0.15;  // root mean square of what is left of it on the surface
  const vec3 axes[] = {up / glm::length(up), vec3(0, 0, 1), vec3(1, 0, 0)};
  for (const vec3& axis : axes) {
    double left = 0;
    for (const vec3& n : normals) left += 1 - std::min(1.f, glm::dot(n, axis) * glm::dot(n, axis));
    if (left > kTooSteep * kTooSteep * static_cast<double>(normals.size())) return axis;
  }
  return axes[0];
}

// Turns and pulls. The pull's weight: a sum over links w (u_j - u_i) is W d^2 / 4 times the
// Laplacian for links of length d in all directions, and minimising |grad u|^2 + |u - p|^2 /
// reach^2 asks for a Laplacian of (u - p) / reach^2.
void connect(const Cloud& cloud, const FieldCompass& compass, FieldLevel& level, Monitor& monitor) {
  const PointGraph& graph = level.graph;
  std::vector<vec2> turns(graph.ids.size()), pulls(graph.size());
  parallelFor(monitor, graph.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const vec3 &n = cloud.normals[i], &p = cloud.positions[i];
      float pull = 0;
      for (std::size_t e = graph.offset[i]; e < graph.offset[i + 1]; ++e) {
        const Index j = graph.ids[e];
        const float d = distanceBetween(p, cloud.positions[j]);
        const float weight = cloud.weight.empty() ? Cloud::weightOver(d) : cloud.weight[e];
        turns[e] = weight * power(transport(cloud.normals[j], n), compass.folds);
        pull += weight * d * d;
      }
      const vec2 upright = tangentNumber(n, compass.up);
      pulls[i] = pull / (4 * compass.reach * compass.reach) * glm::length(upright) *
                 power(unit(upright), compass.folds);
      if (pulls[i] == vec2(0) && graph.of(i).empty())  // nobody else to say
        pulls[i] = power(unit(upright), compass.folds);
    }
  });
  level.turn = std::move(turns);
  level.pull = std::move(pulls);
}

// Nodes of the next level by their members, flat.
struct Members {
  std::vector<std::size_t> offset;
  std::vector<Index> ids;
};

Members membersOf(const std::vector<Index>& parent, Index count) {
  Members out;
  out.offset.assign(static_cast<std::size_t>(count) + 1, 0);
  for (const Index p : parent) ++out.offset[p + 1];
  for (std::size_t p = 0; p < count; ++p) out.offset[p + 1] += out.offset[p];
  out.ids.resize(parent.size());
  std::vector<std::size_t> next(out.offset.begin(), out.offset.end() - 1);
  for (std::size_t i = 0; i < parent.size(); ++i)
    out.ids[next[parent[i]]++] = static_cast<Index>(i);
  return out;
}

struct Means {
  std::vector<vec3> positions, normals;  // n_l
};

Means meansOf(const Cloud& fine, const Members& members, Monitor& monitor) {
  Means out;
  const std::size_t count = members.offset.size() - 1;
  out.positions.resize(count);
  out.normals.resize(count);
  parallelFor(monitor, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::size_t first = members.offset[p], last = members.offset[p + 1];
      vec3 position(0), normal(0);
      for (std::size_t m = first; m < last; ++m) {
        position += fine.positions[members.ids[m]];
        normal += fine.normals[members.ids[m]];
      }
      out.positions[p] = position / static_cast<float>(last - first);
      const float length = glm::length(normal);
      out.normals[p] = length > 1e-3f ? normal / length : fine.normals[members.ids[first]];
    }
  });
  return out;
}

struct Link {
  Index to;
  float weight;
};

using Bridges = std::vector<std::pair<Index, Index>>;

// Links of a chunk of nodes.
struct Rows {
  std::vector<std::size_t> length;
  std::vector<Link> links;
  Bridges bridges;  // links that were left out: normals too far apart
};

class Merger {
 public:
  Merger(const PointGraph& graph, const Cloud& fine, const std::vector<Index>& parent,
         const Members& members, const std::vector<vec3>& normals)
      : graph_(graph), fine_(fine), parent_(parent), members_(members), normals_(normals) {}

  void addRow(Index node, Rows& rows) {
    row_.clear();
    for (std::size_t m = members_.offset[node]; m < members_.offset[node + 1]; ++m) {
      const Index i = members_.ids[m];
      for (std::size_t e = graph_.offset[i]; e < graph_.offset[i + 1]; ++e) {
        const Index j = graph_.ids[e], to = parent_[j];
        if (to != node) merge(to, fine_.weightOf(e, i, j));
      }
    }
    std::sort(row_.begin(), row_.end(), [](const Link& a, const Link& b) {
      return a.weight != b.weight ? a.weight > b.weight : a.to < b.to;
    });
    const std::size_t before = rows.links.size();
    for (const Link& link : row_) {
      if (glm::dot(normals_[node], normals_[link.to]) >= kFacing)
        rows.links.push_back(link);
      else if (node < link.to)
        rows.bridges.emplace_back(node, link.to);
    }
    rows.length.push_back(rows.links.size() - before);
  }

 private:
  void merge(Index to, float weight) {
    for (Link& link : row_)
      if (link.to == to) {
        link.weight += weight;
        return;
      }
    row_.push_back({to, weight});
  }

  const PointGraph& graph_;
  const Cloud& fine_;
  const std::vector<Index>& parent_;
  const Members& members_;
  const std::vector<vec3>& normals_;
  std::vector<Link> row_;
};

struct MergedLinks {
  PointGraph graph;
  std::vector<float> weight;
  Bridges bridges;  // links that had to be left out
};

// Links of the next level, whose nodes have these members and normals.
MergedLinks mergeLinks(const FieldLevel& level, const Cloud& fine, const Members& members,
                       const std::vector<vec3>& normals, Monitor& monitor) {
  const std::size_t count = normals.size();
  std::vector<Rows> chunks((count + kGrain - 1) / kGrain);
  parallelFor(monitor, count, kGrain, [&](std::size_t begin, std::size_t end) {
    Merger merger(level.graph, fine, level.parent, members, normals);
    for (std::size_t p = begin; p < end; ++p)
      merger.addRow(static_cast<Index>(p), chunks[begin / kGrain]);
  });
  std::size_t links = 0;
  for (const Rows& rows : chunks) links += rows.links.size();
  MergedLinks out;
  out.graph.offset.reserve(count + 1);
  out.graph.offset.push_back(0);
  out.graph.ids.reserve(links);
  out.weight.reserve(links);
  for (Rows& chunk : chunks) {
    const Rows rows = std::move(chunk);  // not all of them twice at the same time
    for (const std::size_t length : rows.length)
      out.graph.offset.push_back(out.graph.offset.back() + length);
    for (const Link& link : rows.links) {
      out.graph.ids.push_back(link.to);
      out.weight.push_back(link.weight);
    }
    out.bridges.insert(out.bridges.end(), rows.bridges.begin(), rows.bridges.end());
  }
  return out;
}

Index rootOf(std::vector<Index>& part, Index i) {
  while (part[i] != i) i = part[i] = part[part[i]];
  return i;
}

void join(std::vector<Index>& part, Index a, Index b) {
  a = rootOf(part, a), b = rootOf(part, b);
  part[std::max(a, b)] = std::min(a, b);
}

std::vector<Index> partsOf(const PointGraph& graph, const Bridges& bridges) {
  std::vector<Index> part(graph.size());
  std::iota(part.begin(), part.end(), Index{0});
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (const Index j : graph.of(i)) join(part, static_cast<Index>(i), j);
  for (const auto& [a, b] : bridges) join(part, a, b);
  for (std::size_t i = 0; i < part.size(); ++i) part[i] = rootOf(part, static_cast<Index>(i));
  return part;
}

std::vector<vec2> parentTurns(const Cloud& fine, const Means& coarse,
                              const std::vector<Index>& parent, int folds, Monitor& monitor) {
  std::vector<vec2> turn(parent.size());
  parallelFor(monitor, turn.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      turn[i] = power(transport(coarse.normals[parent[i]], fine.normals[i]), folds);
  });
  return turn;
}

}  // namespace

float facingOf(Creases creases) {
  if (creases == Creases::Carry) return kFacing;
  return static_cast<float>(std::cos(kCreaseDegrees * std::numbers::pi / 180));
}

FieldLevels clusterField(const PointSet& points, const Neighborhoods& neighborhoods,
                         const FieldOptions& options, int depth, Monitor& monitor) {
  FieldLevels field;
  field.compass = {.up = usableUp(points.normals, options.up),
                   .reach = static_cast<float>(std::max(reachOf(points.positions), 1e-12)),
                   .folds = foldsOf(options.symmetry)};
  field.levels.emplace_back();
  field.levels[0].graph =
      linkBothWays(neighborhoods, points.normals, facingOf(options.creases), monitor);
  Cloud cloud{.positions = points.positions, .normals = points.normals};
  Means means;      // the cloud's, but at the finest level
  Bridges bridges;  // between nodes of the last level
  while (static_cast<int>(field.levels.size()) < depth) {
    FieldLevel& level = field.levels.back();
    Index count = 0;
    std::vector<Index> parent = clusterByFour(level.graph, count, monitor);
    if (count < kFewestNodes || count > kLeastGain * static_cast<double>(level.size())) break;
    level.parent = std::move(parent);
    for (auto& [a, b] : bridges) a = level.parent[a], b = level.parent[b];
    monitor.checkpoint();
    const Members members = membersOf(level.parent, count);
    Means coarse = meansOf(cloud, members, monitor);
    MergedLinks merged = mergeLinks(level, cloud, members, coarse.normals, monitor);
    bridges.insert(bridges.end(), merged.bridges.begin(), merged.bridges.end());
    level.fromParent = parentTurns(cloud, coarse, level.parent, field.compass.folds, monitor);
    means = std::move(coarse);
    cloud = {means.positions, means.normals, std::move(merged.weight)};
    field.levels.emplace_back();
    field.levels.back().graph = std::move(merged.graph);
    connect(cloud, field.compass, field.levels.back(), monitor);
  }
  field.part = partsOf(field.levels.back().graph, bridges);
  return field;
}

void connectFinest(const PointSet& points, FieldLevels& field, Monitor& monitor) {
  connect({.positions = points.positions, .normals = points.normals}, field.compass,
          field.levels[0], monitor);
}

FieldLevels buildFieldLevels(const PointSet& points, const Neighborhoods& neighborhoods,
                             const FieldOptions& options, int depth, Monitor& monitor) {
  FieldLevels field = clusterField(points, neighborhoods, options, depth, monitor);
  connectFinest(points, field, monitor);
  return field;
}

std::vector<std::vector<std::uint8_t>> freeParts(const FieldLevels& field,
                                                 std::span<const Index> fixed) {
  const std::size_t depth = field.levels.size();
  std::vector<std::vector<std::uint8_t>> out(depth);
  std::vector<std::uint8_t> drawn(field.part.size(), 0);
  for (const Index i : fixed) drawn[field.part[i]] = 1;
  std::vector<std::uint8_t> top(field.part.size());
  for (std::size_t i = 0; i < top.size(); ++i) top[i] = !drawn[field.part[i]];
  if (std::find(top.begin(), top.end(), 1) == top.end()) return out;
  out.back() = std::move(top);
  for (std::size_t l = depth - 1; l-- > 0;) {
    const std::vector<Index>& parent = field.levels[l].parent;
    out[l].resize(parent.size());
    for (std::size_t i = 0; i < parent.size(); ++i) out[l][i] = out[l + 1][parent[i]];
  }
  return out;
}

}  // namespace dapple
