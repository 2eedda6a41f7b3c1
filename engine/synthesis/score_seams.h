// What a source map tells about a textured point set: seams, breaks, verbatim pieces, gap contrast.
#pragma once

#include <optional>

#include "synthesis/texture_score.h"

namespace dapple {

struct SeamFigures {
  std::optional<double> seamError, breaks, verbatim, gapContrast;  // as in TextureScore
};

// Needs input.map. Throws Cancelled.
SeamFigures seamFigures(const ScoreInput& input, Monitor& monitor);

}  // namespace dapple
