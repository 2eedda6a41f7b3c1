// The choices that seams are cut through, and what every pair of choices of two neighbours costs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "synthesis/patch_overlap.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

inline constexpr float kSeamCost = 4096;  // integer cost of a colour difference of 1
inline constexpr std::uint8_t kNoLink = 255;
inline constexpr float kLengthSteps = 64;  // of an edge's length, for each pixel

// Usable candidates of every point, and a node for each point that has several.
struct SeamGraph {
  // By point, n + 1, into the three columns of candidates below.
  std::vector<Index> first;
  std::vector<Index> source;  // place in the overlap
  std::vector<vec2> texel;
  std::vector<vec3> colour;
  std::vector<float> relief;  // empty: the swatch has none

  // By node.
  std::vector<Index> point;        // ascending
  std::vector<Index> firstData;    // nodes + 1: candidates of the nodes only
  std::vector<std::int32_t> data;  // of a candidate: distortion, and seams to points without choice
  std::vector<std::uint8_t> torn;  // 1: candidate 0 does not go on into a point without choice

  struct HalfEdge {
    Index to;              // node
    Index cost;            // first of count(from) x count(to) entries of `cost`
    Index link;            // first of count(from) entries of `link`
    std::uint16_t length;  // 1 / kLengthSteps pixels, the largest number for all above
    std::uint8_t choices;  // count(to)
  };
  std::vector<Index> firstEdge;  // nodes + 1
  std::vector<HalfEdge> edges;   // between nodes, both ways
  std::vector<std::uint16_t> cost;
  std::vector<std::uint8_t> link;  // candidate of `to` that continues one of `from`, or kNoLink

  std::size_t nodes() const { return point.size(); }
  std::size_t count(Index i) const { return first[i + 1] - first[i]; }  // of a point
  std::span<const HalfEdge> of(Index node) const {
    return {edges.data() + firstEdge[node], firstEdge[node + 1] - firstEdge[node]};
  }
  // Candidates a of an edge's one end and b of the other.
  std::int32_t seam(const HalfEdge& edge, std::uint8_t a, std::uint8_t b) const {
    return cost[edge.cost + std::size_t{a} * edge.choices + b];
  }
};

// Throws Cancelled.
SeamGraph buildSeamGraph(const SynthesisInput& input, const PatchOverlap& overlap,
                         const SourceMap& map, Monitor& monitor);

}  // namespace dapple
