#include "regions/orientation_field.h"

#include "base/errors.h"
#include "points/tangent_frames.h"
#include "regions/diffused_field.h"
#include "regions/field_combing.h"
#include "regions/field_levels.h"
#include "regions/smooth_field.h"
#include "regions/spread_field.h"
#include "regions/tangent_numbers.h"

namespace dapple {
namespace {

OrientationField smooth(const PointSet& points, const Neighborhoods& neighborhoods,
                        std::span<const StrokeMark> marks, const FieldOptions& options,
                        Monitor& monitor) {
  return SmoothField(points, neighborhoods, options, monitor).solveOnce(marks, monitor);
}

std::vector<TangentFrame> diffused(const PointSet& points, const Neighborhoods& neighborhoods,
                                   std::span<const StrokeMark> marks, const FieldOptions& options,
                                   Monitor& monitor) {
  const int folds = foldsOf(options.symmetry);
  const FieldLevels field = buildFieldLevels(points, neighborhoods, options, 1, monitor);
  const std::vector<vec2> powers =
      diffusedDirections(field, fixedDirections(points, marks, folds), monitor);
  const std::vector<vec2> directions =
      combed({points, field.levels[0].graph, powers, folds, options.up}, marks, monitor);
  std::vector<TangentFrame> frames;
  for (std::size_t i = 0; i < points.size(); ++i)
    frames.push_back(
        orthonormalFrame(points.normals[i], tangentDirection(points.normals[i], directions[i])));
  return frames;
}

std::vector<float> scalesOf(const PointSet& points, const Neighborhoods& neighborhoods,
                            std::span<const StrokeMark> marks, const FieldOptions& options,
                            Monitor& monitor) {
  constexpr int kLevels = 16;
  for (const StrokeMark& mark : marks)
    if (mark.scale != 1)
      return smoothScales(buildFieldLevels(points, neighborhoods, options, kLevels, monitor), marks,
                          monitor);
  return {};
}

}  // namespace

OrientationField orientPoints(const PointSet& points, const Neighborhoods& neighborhoods,
                              std::span<const Stroke> strokes, const FieldOptions& options,
                              Monitor& monitor) {
  DAPPLE_CHECK(points.normals.size(), ==, points.size());
  if (options.method == FieldMethod::Random) return {randomFrames(points, options.seed), {}};
  if (options.method == FieldMethod::Up || neighborhoods.k == 0)
    return {framesTowards(points, options.up), {}};
  const std::vector<StrokeMark> marks = strokeMarks(points, neighborhoods, strokes);
  if (options.method == FieldMethod::Smooth)
    return smooth(points, neighborhoods, marks, options, monitor);
  OrientationField out;
  if (options.method == FieldMethod::Diffuse)
    out.frames = diffused(points, neighborhoods, marks, options, monitor);
  else
    out.frames = spreadMarks(points, neighborhoods, marks, options, monitor);
  out.scale = scalesOf(points, neighborhoods, marks, options, monitor);
  return out;
}

}  // namespace dapple
