// Decides which of several patterns every point near a border shows, so that the border runs where
// it is seen least.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "points/neighborhoods.h"
#include "points/point_set.h"

namespace dapple {

inline constexpr std::uint16_t kNoPattern = 0xffff;

// A further pattern that a point may show.
struct PatternOption {
  Index point = 0;
  std::uint16_t pattern = 0;
  vec3 colour{0};  // that the point has then
};

struct PatternCutInput {
  const PointSet& points;  // with normals
  const Neighborhoods& neighborhoods;
  const std::vector<std::uint16_t>& own;  // n: the pattern of each point, or kNoPattern
  const std::vector<vec3>& colour;        // n: by its own pattern
  // By point, then pattern; each other than the point's own, which it has. Points without an option
  // keep their own pattern.
  std::span<const PatternOption> options;
};

struct PatternCut {
  std::vector<bool> taken;  // by option; at most one of a point
  // Sum over links between points that show different patterns (patternSeams()).
  double energyBefore = 0;  // every point shows its own
  double energyAfter = 0;   // never more
};

// What a border costs that gives each point its own pattern, or the option that is taken: over its
// links, the difference of both patterns' colours at both ends (0..2 sqrt 3), and the less the more
// either pattern changes from one end to the other by itself. Throws Cancelled.
double patternSeams(const PatternCutInput& input, const std::vector<bool>& taken, Monitor& monitor);

// The cheapest border, exactly where two patterns meet, else by swapping two patterns at a time.
// Serial, and of the same bytes always. Throws Cancelled.
PatternCut cutPatterns(const PatternCutInput& input, Monitor& monitor);

}  // namespace dapple
