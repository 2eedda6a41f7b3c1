// Synthesis of that part of a region alone which its result does not suit any more: points that are
// new to it, and points where the directions or the scale have turned into others.
#pragma once

#include "document/region_points.h"

namespace dapple {

// What a region asks for now. Its m points are numbered as in `part`.
struct RegionTarget {
  const Region& region;
  const RegionPoints& part;
  const OrientationField& field;
  float unit = 0;  // local units per swatch pixel
};

// Some of a region's points, and the map that their synthesis starts from.
struct RegionPart {
  std::vector<Index> points;  // of the region's, ascending: those that changed, and a halo
  SourceMap map;              // of `points`: Free where they changed
  // The result has patches of these numbers in place of the map's; new ones follow the largest.
  std::vector<Index> patchOf;
};

// Nothing when all of the region should be synthesized: it has no result by these options and this
// swatch, its method cannot keep points, or most points have changed. Empty points: its result is
// what it asks for. Throws Cancelled.
std::optional<RegionPart> changedPart(const Document& document, const RegionTarget& target,
                                      Monitor& monitor);

// A region's result of which some points have new values.
struct PartResult {
  std::vector<Index> points;       // of the scan, ascending: these; all others keep what they have
  SourceMap map;                   // of `points`, patches by their numbers in the result; no blends
  SynthesisStatistics statistics;  // of the whole region
  // Of the whole region, as ResultSource has them.
  std::vector<Index> blended;
  std::vector<std::size_t> blendEnd;
  std::vector<BlendTerm> blend;
};

// The region's result with the part's in its place: what synthesize() made of part.map. Throws
// Cancelled.
PartResult withPart(const Document& document, const RegionTarget& target, const RegionPart& part,
                    const SourceMap& made, Monitor& monitor);

}  // namespace dapple
