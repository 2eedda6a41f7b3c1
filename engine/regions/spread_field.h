// Directions that spread from strokes point by point.
#pragma once

#include <span>
#include <vector>

#include "regions/field_options.h"
#include "regions/strokes.h"

namespace dapple {

// Frames (n) that follow the marks where there is one and, further away, those nearer to one, in
// the order of their distance ([Zeng] 2.3, by links weighted 1 / distance). Points that no mark
// reaches have those of framesTowards(). Throws Cancelled.
std::vector<TangentFrame> spreadMarks(const PointSet& points, const Neighborhoods& neighborhoods,
                                      std::span<const StrokeMark> marks,
                                      const FieldOptions& options, Monitor& monitor);

}  // namespace dapple
