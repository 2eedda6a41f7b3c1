#include "synthesis/synthesis_input.h"

#include "points/normals.h"

namespace dapple {

ChartedInput::ChartedInput(const SynthesisInput& given, bool smooth, Monitor& monitor)
    : input_(given) {
  if (given.chart || !smooth) return;
  chart_ = smoothedPositions(given.points, given.neighborhoods, monitor);
  input_.chart = &chart_;
}

}  // namespace dapple
