// Extends grown patches beyond their borders, over gap points and over each other, so that there is
// a choice to cut through.
#pragma once

#include <span>
#include <vector>

#include "base/monitor.h"
#include "synthesis/chart_fit.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

// One way to lay a point into the swatch.
struct PlaceCandidate {
  ChartSite site;        // q in the domain of site.patch
  float distortion = 0;  // D of the fit
  float reach = 0;       // pixels beyond the patch as grown; 0: the point belongs to it
};

// The candidates of all points, a patch point's own first, then by reach. Two of a point lie apart:
// a patch that bends round until it meets itself gives candidates of the same patch with
// different q.
struct PatchOverlap {
  std::vector<std::size_t> offset;  // n + 1
  std::vector<PlaceCandidate> candidates;

  std::span<const PlaceCandidate> of(std::size_t i) const {
    return {candidates.data() + offset[i], offset[i + 1] - offset[i]};
  }
};

inline constexpr float kCoherentPixels = 1.5f;  // places further apart belong to different sheets

// Where `from` puts the point at `position`, in the domain of its patch.
vec2 carriedPlace(const ChartSite& from, const vec3& position, float unit);

// Grows over at most `overlap` pixels. `map` as growPatches() leaves it. Gap points that no patch
// reaches have no candidate. Throws Cancelled.
PatchOverlap growOverlap(const SynthesisInput& input, const SourceMap& map, float overlap,
                         Monitor& monitor);

}  // namespace dapple
