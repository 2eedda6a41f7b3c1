// The smoothest field of directions that follows the strokes: Gauss-Seidel sweeps over N-fold
// directions from coarse clusters of points to the points themselves (methods: section 1.3).
#pragma once

#include "regions/field_levels.h"
#include "regions/field_relaxation.h"
#include "regions/orientation_field.h"

namespace dapple {

// Keeps the levels of the hierarchy and what was found on each, for strokes that change.
class SmoothField {
 public:
  // The points must outlive this. Throws Cancelled.
  SmoothField(const PointSet& points, const Neighborhoods& neighborhoods,
              const FieldOptions& options, Monitor& monitor);

  void solve(std::span<const StrokeMark> marks, Monitor& monitor);

  // The same bytes for once, in about half the memory: each level goes as soon as the next finer
  // one has taken over from it.
  OrientationField solveOnce(std::span<const StrokeMark> marks, Monitor& monitor) &&;

  // As solve() after other marks, in a time that goes with the number of points that it touches:
  // levels of few nodes are solved anew, and on the others only what lies under a node that turned
  // by more than `degrees`, and around it as far as that goes on. Returns the points that turned by
  // more, ascending; all others keep their frame. Not the same bytes as solve(), which a result
  // that is to be kept has to come from: directions differ by about `degrees`. Scales are all
  // solved anew. Throws Cancelled; solve() then.
  std::vector<Index> update(std::span<const StrokeMark> marks, float degrees, Monitor& monitor);

  const OrientationField& field() const { return field_; }

 private:
  using FixedLevels = std::vector<std::vector<Fixed<vec2>>>;

  std::vector<vec2> coarsest(Monitor& monitor) const;
  void fix(std::span<const StrokeMark> marks);
  void enterLevel(std::size_t l, Monitor& monitor);
  void relaxLevel(std::size_t l, Monitor& monitor);
  void solveLevel(std::size_t l, Monitor& monitor);
  std::vector<Index> refreshLevel(std::size_t l, std::span<const Index> parents,
                                  std::span<const Index> drawn, Monitor& monitor);
  std::vector<Index> turnedSince(std::size_t l, std::span<const Index> nodes, float cosine);
  void writeFrames(std::span<const StrokeMark> marks, Monitor& monitor);

  const PointSet& points_;
  FieldOptions options_;
  FieldLevels levels_;
  FixedLevels fixed_;                              // by level
  std::vector<std::vector<std::uint8_t>> pulled_;  // by level: parts that no stroke reaches
  std::vector<std::vector<vec2>> value_;           // by level, N-th powers
  std::vector<std::vector<vec2>> seen_;            // as the level below, or field_, knows them
  float cosine_ = 1;                               // of N times the tolerance
  OrientationField field_;
};

// The directions that marks fix, ascending by point: N-th powers of unit length, of their weighted
// sum. A point where they cancel is left out.
std::vector<Fixed<vec2>> fixedDirections(const PointSet& points, std::span<const StrokeMark> marks,
                                         int folds);

// Scales (n) from the marks' by smoothing their logarithms over all levels; empty when all are 1.
std::vector<float> smoothScales(const FieldLevels& field, std::span<const StrokeMark> marks,
                                Monitor& monitor);

}  // namespace dapple
