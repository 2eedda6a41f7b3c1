// What the colours of the view mean, in a corner of it.
#pragma once

#include <imgui.h>

#include "app/editor/scene_view.h"

namespace dapple {

// With its lower left corner at `corner` (pixels), in the present window. Nothing for views whose
// colours need no key. Mark: "legend".
void drawViewLegend(const SceneView& view, View shown, ImVec2 corner);

}  // namespace dapple
