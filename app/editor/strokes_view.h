// The document's strokes as they are seen: drawn over the picture, and picked from it.
#pragma once

#include <optional>
#include <string>
#include <vector>

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

struct OverlayLabel {
  vec2 place;  // pixels of the picture: of what it belongs to
  std::string text;
};
// The scales of those that have one and are seen.
std::vector<OverlayLabel> strokeLabels(const OverlayView& view, const Document& document);

// The stroke whose visible part is nearest to a place in the picture, within `reach` pixels.
std::optional<StrokeId> strokeAt(const OverlayView& view, const Document& document, vec2 place,
                                 float reach);

}  // namespace dapple
