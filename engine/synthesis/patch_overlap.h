// Extends grown patches beyond their borders, over gap points and over each other, so that there is
// a choice to cut through.
#pragma once

#include <cmath>
#include <vector>

#include "base/monitor.h"
#include "synthesis/chart_fit.h"
#include "synthesis/source_map.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

// The ways to lay each point into the swatch, its candidates: a patch point's own first, then by
// reach. Two of a point lie apart: a patch that bends round until it meets itself gives candidates
// of the same patch with different q. One column for each number, a point's candidates together.
struct PatchOverlap {
  std::vector<Index> offset;      // n + 1
  std::vector<ChartSite> site;    // q in the domain of site.patch
  std::vector<float> distortion;  // D of the fit
  std::vector<float> reach;       // pixels beyond the patch as grown; 0: the point belongs to it
};

inline constexpr float kCoherentPixels = 1.5f;  // places further apart belong to different sheets

// Where `from` puts the point at `position`, in the domain of its patch: the step along the plane,
// stretched to its length in space, as in chart_fit.cpp. `unit` local units are a pixel on the way.
inline vec2 carriedPlace(const ChartSite& from, const vec3& position, float unit) {
  const vec3 step = position - from.position;
  const vec3 s = glm::cross(from.t, from.n);
  const float along = glm::dot(step, s), up = glm::dot(step, from.t);
  const float flat2 = along * along + up * up, length2 = glm::dot(step, step);
  if (!(flat2 > 1e-4f * length2)) return from.q;
  return from.q + std::sqrt(length2 / flat2) / unit * vec2(along, -up);
}

// The same of where `to` lies, whose scale may differ; `unit` is that of SynthesisInput.
inline vec2 carriedPlace(const ChartSite& from, const ChartSite& to, float unit) {
  return carriedPlace(from, to.position, unit * 0.5f * (from.scale + to.scale));
}

// Grows over at most `overlap` pixels. `map` as growPatches() leaves it. Gap points that no patch
// reaches have no candidate. Counts every point once. The same bytes at any number of threads.
// Throws Cancelled.
PatchOverlap growOverlap(const SynthesisInput& input, const SourceMap& map, float overlap,
                         Monitor& monitor);

}  // namespace dapple
