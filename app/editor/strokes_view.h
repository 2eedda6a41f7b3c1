// The document's strokes as they are seen: drawn over the picture, and picked from it.
#pragma once

#include <optional>

#include "app/render/overlay.h"
#include "document/document.h"

namespace dapple {

struct StrokeId {
  RegionId region = kUnassigned;
  std::size_t index = 0;  // of the region's
  bool operator==(const StrokeId&) const = default;
};

// Null when there is no such stroke.
const Stroke* findStroke(const Document& document, const StrokeId& id);

// All strokes of visible regions; the chosen one stands out.
OverlayLines strokesOverlay(const OverlayView& view, const Document& document,
                            const std::optional<StrokeId>& chosen);

// The stroke whose visible part is nearest to a place in the picture, within `reach` pixels.
std::optional<StrokeId> strokeAt(const OverlayView& view, const Document& document, vec2 place,
                                 float reach);

}  // namespace dapple
