#include "synthesis/score_seams.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dapple {
namespace {

constexpr std::size_t kEdges = 8;     // of a point: its nearest neighbours
constexpr float kBreak = 0.8f;        // pixels off where the source goes on elsewhere
constexpr std::size_t kGrain = 2048;  // points

// a - b, the short way round where the swatch tiles.
vec2 texelDifference(const Swatch& swatch, vec2 a, vec2 b) {
  const vec2 d = a - b, size(swatch.width, swatch.height);
  return swatch.tileable ? d - size * glm::round(d / size) : d;
}

// One point's edges, in swatch pixels (x right, y down).
struct Edges {
  std::array<vec2, kEdges> offset;  // where the neighbour lies on the surface
  std::array<vec2, kEdges> source;  // where its texel lies in the swatch
  std::array<Index, kEdges> id;
  std::size_t count = 0;
};

bool hasSource(const SourceMap& map, std::size_t i) {
  return (map.state.empty() || map.state[i] != PointState::Free) &&
         std::isfinite(map.texel[i].x + map.texel[i].y);
}

Edges edgesOf(const ScoreInput& input, Index i) {
  const SourceMap& map = *input.map;
  const TangentFrame& frame = map.frame[i];
  Edges edges;
  for (const Index j : input.neighborhoods.of(i).first(std::min(kEdges, input.neighborhoods.k))) {
    if (!hasSource(map, j) || glm::dot(input.points.normals[i], input.points.normals[j]) <= 0)
      continue;
    const vec3 V = input.points.positions[j] - input.points.positions[i];
    const vec2 flat(glm::dot(V, frame.s), -glm::dot(V, frame.t));
    const float length = glm::length(flat);
    // The surface is curved: keep the distance, not its shadow on the plane.
    const float stretch = length > 0 ? glm::length(V) / length : 0.0f;
    edges.offset[edges.count] = flat * (2 * stretch / (input.unitAt(i) + input.unitAt(j)));
    edges.source[edges.count] = texelDifference(input.swatch, map.texel[j], map.texel[i]);
    edges.id[edges.count++] = j;
  }
  return edges;
}

vec2 turned(vec2 v, vec2 rotation) {
  return {rotation.x * v.x - rotation.y * v.y, rotation.y * v.x + rotation.x * v.y};
}

// The rotation (cosine, sine) under which most edges run on in the swatch: none, or one that an
// edge itself asks for. Ties go to the first.
vec2 bestRotation(const Edges& edges) {
  vec2 best(1, 0);
  int most = -1;
  for (std::size_t c = 0; c <= edges.count; ++c) {
    vec2 rotation(1, 0);
    if (c > 0) {
      const vec2 o = edges.offset[c - 1], s = edges.source[c - 1];
      const vec2 product(glm::dot(o, s), o.x * s.y - o.y * s.x);
      const float length = glm::length(product);
      if (!(length > 0) || glm::length(s) > glm::length(o) + kBreak) continue;
      rotation = product / length;
    }
    int inliers = 0;
    for (std::size_t e = 0; e < edges.count; ++e)
      inliers += glm::length(turned(edges.offset[e], rotation) - edges.source[e]) <= kBreak;
    if (inliers > most) {
      most = inliers;
      best = rotation;
    }
  }
  return best;
}

// Disjoint sets with path halving; the smaller id is the root, so the order of joins is of no
// consequence.
class Pieces {
 public:
  explicit Pieces(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Index a, Index b) {
    a = root(a), b = root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<Index> parent_;
};

// Mean size of the piece that a point with a source belongs to. An edge joins two points when
// neither calls it broken: two pieces often touch by chance as seen from one side.
double meanPiece(const ScoreInput& input, const std::vector<std::uint8_t>& runsOn) {
  const std::size_t n = input.points.size();
  const std::size_t count = std::min(kEdges, input.neighborhoods.k);
  const auto edge = [&](Index i, Index j) -> int {  // 1 runs on, 0 broken, -1 no such edge
    const auto ids = input.neighborhoods.of(i).first(count);
    for (std::size_t e = 0; e < count; ++e)
      if (ids[e] == j) return runsOn[i] >> e & 1;
    return -1;
  };
  Pieces pieces(n);
  for (Index i = 0; i < n; ++i)
    for (const Index j : input.neighborhoods.of(i).first(count))
      if (edge(i, j) == 1 && edge(j, i) != 0) pieces.join(i, j);
  std::vector<double> size(n, 0.0);
  double points = 0, squares = 0;
  for (Index i = 0; i < n; ++i) {
    if (!hasSource(*input.map, i)) continue;
    ++points;
    ++size[pieces.root(i)];
  }
  for (double s : size) squares += s * s;
  return points > 0 ? squares / points : 0;
}

std::optional<double> contrastOfGaps(const ScoreInput& input) {
  dvec3 sum(0), squares(0);
  double count = 0;
  for (std::size_t i = 0; i < input.points.size(); ++i) {
    const PointState state = input.map->state[i];
    if (state != PointState::Gap && state != PointState::Matched) continue;
    const dvec3 colour(input.colours[i]);
    sum += colour;
    squares += colour * colour;
    ++count;
  }
  const double sigma = swatchContrast(input.swatch);
  if (count < 2 || !(sigma > 0)) return std::nullopt;
  const dvec3 variance = squares / count - (sum / count) * (sum / count);
  return std::sqrt(std::max(0.0, (variance.x + variance.y + variance.z) / 3)) / sigma;
}

}  // namespace

SeamFigures seamFigures(const ScoreInput& input, Monitor& monitor) {
  const std::size_t n = input.points.size();
  const SourceMap& map = *input.map;
  SeamFigures figures;
  if (!map.state.empty()) figures.gapContrast = contrastOfGaps(input);
  if (map.texel.size() != n || map.frame.size() != n) return figures;

  struct Sums {
    double error = 0, edges = 0, broken = 0;
  };
  std::vector<Sums> chunks((n + kGrain - 1) / kGrain);
  std::vector<std::uint8_t> runsOn(n, 0);  // bit e: the edge to neighbour e is not broken
  static_assert(kEdges <= 8);
  parallelFor(monitor, n, kGrain, [&](std::size_t begin, std::size_t end) {
    Sums& sums = chunks[begin / kGrain];
    for (std::size_t i = begin; i < end; ++i) {
      if (!hasSource(map, i)) continue;
      const auto ids = input.neighborhoods.of(i);
      const Edges edges = edgesOf(input, static_cast<Index>(i));
      const vec2 rotation = bestRotation(edges);
      for (std::size_t e = 0, slot = 0; e < edges.count; ++e) {
        while (ids[slot] != edges.id[e]) ++slot;
        const vec2 expected = turned(edges.offset[e], rotation);
        const bool broken = !(glm::length(expected - edges.source[e]) <= kBreak);
        const vec3 off =
            sampleSwatch(input.swatch, map.texel[i] + expected) - input.colours[edges.id[e]];
        sums.error += std::sqrt(glm::dot(off, off) / 3);
        sums.broken += broken;
        ++sums.edges;
        if (!broken) runsOn[i] |= static_cast<std::uint8_t>(1u << slot);
      }
    }
  });
  Sums sums;
  for (const Sums& chunk : chunks) {
    sums.error += chunk.error;
    sums.edges += chunk.edges;
    sums.broken += chunk.broken;
  }
  if (!(sums.edges > 0)) return figures;
  const double sigma = swatchContrast(input.swatch);
  if (sigma > 0) figures.seamError = sums.error / sums.edges / sigma;
  figures.breaks = sums.broken / sums.edges;
  figures.verbatim = meanPiece(input, runsOn);
  return figures;
}

}  // namespace dapple
