// What every method starts from.
#pragma once

#include <span>

#include "base/monitor.h"
#include "points/neighborhoods.h"
#include "points/point_set.h"
#include "swatch/swatch.h"
#include "synthesis/source_map.h"

namespace dapple {

struct SynthesisInput {
  const PointSet& points;  // with normals
  const Neighborhoods& neighborhoods;
  const Swatch& swatch;
  const std::vector<TangentFrame>& frames;  // n: where the swatch's axes should point
  float unit = 0;                           // local units per swatch pixel
  std::span<const float> scale = {};        // n, times the unit; empty: 1 everywhere
  // n: where charts take the points to lie (smoothedPositions()); null: the stages decide.
  const std::vector<vec3>* chart = nullptr;
  // Charts turn with the frames at every point; else they run straight on from where they start.
  bool follow = false;
  int symmetry = 1;  // of the swatch: it looks the same turned by whole turns / symmetry; 1, 2, 4
  // Where synthesis begins (grid only); empty: by the seed.
  std::span<const Index> starts = {};
  // The points whose state is not Free have their texel already; the others are to suit them.
  // Patches of the kept points are as growPatches() leaves them. Null: nothing is kept. For the
  // methods of keepsPoints() only.
  const SourceMap* kept = nullptr;

  float scaleAt(std::size_t i) const { return scale.empty() ? 1 : scale[i]; }
  float unitAt(std::size_t i) const { return unit * scaleAt(i); }
  bool isKept(std::size_t i) const { return kept && kept->state[i] != PointState::Free; }
  // The first patches of a map, which stay where they are in the swatch.
  std::size_t keptPatches() const { return kept ? kept->placement.size() : 0; }
};

// The input with points charted where smoothing takes them to lie, unless it says where or they are
// to be taken where they are. Refers to what `given` does. Throws Cancelled.
class ChartedInput {
 public:
  ChartedInput(const SynthesisInput& given, bool smooth, Monitor& monitor);
  ChartedInput(const ChartedInput&) = delete;
  ChartedInput& operator=(const ChartedInput&) = delete;

  const SynthesisInput& get() const { return input_; }

 private:
  std::vector<vec3> chart_;
  SynthesisInput input_;
};

}  // namespace dapple
