// The look: colours, spacing, sizes. Panels take them from here and write no number of their own.
#pragma once

#include <imgui.h>

namespace dapple {

namespace theme {

// Surfaces, from the back to the front.
inline const ImVec4 kBackdrop{0.071f, 0.075f, 0.082f, 1};  // behind everything, the viewport
inline const ImVec4 kPanel{0.106f, 0.112f, 0.122f, 1};
inline const ImVec4 kRaised{0.137f, 0.145f, 0.157f, 1};  // cards, popups, title bars
inline const ImVec4 kControl{0.184f, 0.194f, 0.210f, 1};
inline const ImVec4 kControlHovered{0.235f, 0.247f, 0.267f, 1};
inline const ImVec4 kControlActive{0.282f, 0.296f, 0.318f, 1};
inline const ImVec4 kField{0.078f, 0.083f, 0.091f, 1};  // where one types or picks
inline const ImVec4 kLine{1, 1, 1, 0.075f};             // separators, outlines
inline const ImVec4 kLineStrong{1, 1, 1, 0.16f};

inline const ImVec4 kText{0.906f, 0.898f, 0.882f, 1};
inline const ImVec4 kTextMuted{0.620f, 0.616f, 0.608f, 1};
inline const ImVec4 kTextFaint{0.435f, 0.435f, 0.435f, 1};  // disabled

// The one accent: what is selected, what to press next.
inline const ImVec4 kAccent{0.914f, 0.620f, 0.286f, 1};
inline const ImVec4 kAccentHovered{0.957f, 0.698f, 0.392f, 1};
inline const ImVec4 kAccentActive{0.824f, 0.529f, 0.208f, 1};
inline const ImVec4 kAccentSoft{0.914f, 0.620f, 0.286f, 0.20f};  // behind selected rows
inline const ImVec4 kOnAccent{0.110f, 0.078f, 0.035f, 1};        // text on it

inline const ImVec4 kGood{0.518f, 0.753f, 0.463f, 1};
inline const ImVec4 kInfo{0.455f, 0.678f, 0.871f, 1};
inline const ImVec4 kWarning{0.929f, 0.776f, 0.325f, 1};
inline const ImVec4 kError{0.914f, 0.443f, 0.388f, 1};
inline const ImVec4 kShade{0.03f, 0.03f, 0.035f, 0.60f};  // over what a dialog covers

// Logical pixels, all multiples of 4 save hairlines: px() them.
inline constexpr float kGapTiny = 2, kGapSmall = 4, kGap = 8, kGapLarge = 16, kGapHuge = 32;
inline constexpr float kRadius = 5, kRadiusLarge = 8;
inline constexpr float kIconSize = 18;        // the drawing
inline constexpr float kIconButtonSize = 32;  // the button around it
inline constexpr float kButtonHeight = 30;
inline constexpr float kRowHeight = 28;  // of lists
inline constexpr float kToolbarWidth = 44;
inline constexpr float kPanelWidth = 300;
inline constexpr float kStatusHeight = 26;

// Logical pixels to whole pixels at the UI scale of the context.
float px(float logical);
inline ImVec2 px(float x, float y) {
  return {px(x), px(y)};
}
inline ImU32 packed(const ImVec4& colour) {
  return ImGui::ColorConvertFloat4ToU32(colour);
}
inline ImVec4 withAlpha(ImVec4 colour, float alpha) {
  colour.w = alpha;
  return colour;
}

// Writes all of `style`, sizes times `scale`.
void apply(ImGuiStyle& style, float scale);

}  // namespace theme
}  // namespace dapple
