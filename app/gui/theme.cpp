#include "app/gui/theme.h"

#include <algorithm>
#include <cmath>

#include "app/gui/gui_context.h"

namespace dapple::theme {
namespace {

void applyColours(ImVec4* colours) {
  colours[ImGuiCol_Text] = kText;
  colours[ImGuiCol_TextDisabled] = kTextMuted;
  colours[ImGuiCol_WindowBg] = kPanel;
  colours[ImGuiCol_ChildBg] = {0, 0, 0, 0};
  colours[ImGuiCol_PopupBg] = kRaised;
  colours[ImGuiCol_Border] = kLine;
  colours[ImGuiCol_BorderShadow] = {0, 0, 0, 0};
  colours[ImGuiCol_FrameBg] = kField;
  colours[ImGuiCol_FrameBgHovered] = {0.098f, 0.104f, 0.113f, 1};
  colours[ImGuiCol_FrameBgActive] = {0.118f, 0.124f, 0.135f, 1};
  colours[ImGuiCol_TitleBg] = kRaised;
  colours[ImGuiCol_TitleBgActive] = kRaised;
  colours[ImGuiCol_TitleBgCollapsed] = kRaised;
  colours[ImGuiCol_MenuBarBg] = kRaised;
  colours[ImGuiCol_ScrollbarBg] = {0, 0, 0, 0};
  colours[ImGuiCol_ScrollbarGrab] = kControl;
  colours[ImGuiCol_ScrollbarGrabHovered] = kControlHovered;
  colours[ImGuiCol_ScrollbarGrabActive] = kControlActive;
  colours[ImGuiCol_CheckMark] = kAccent;
  colours[ImGuiCol_SliderGrab] = kAccentActive;
  colours[ImGuiCol_SliderGrabActive] = kAccentHovered;
  colours[ImGuiCol_Button] = kControl;
  colours[ImGuiCol_ButtonHovered] = kControlHovered;
  colours[ImGuiCol_ButtonActive] = kControlActive;
  colours[ImGuiCol_Header] = kAccentSoft;
  colours[ImGuiCol_HeaderHovered] = kControlHovered;
  colours[ImGuiCol_HeaderActive] = kControlActive;
  colours[ImGuiCol_Separator] = kLine;
  colours[ImGuiCol_SeparatorHovered] = kAccentSoft;
  colours[ImGuiCol_SeparatorActive] = kAccent;
  colours[ImGuiCol_ResizeGrip] = {0, 0, 0, 0};
  colours[ImGuiCol_ResizeGripHovered] = kAccentSoft;
  colours[ImGuiCol_ResizeGripActive] = kAccent;
  colours[ImGuiCol_Tab] = kPanel;
  colours[ImGuiCol_TabHovered] = kControlHovered;
  colours[ImGuiCol_TabActive] = kControl;
  colours[ImGuiCol_TabUnfocused] = kPanel;
  colours[ImGuiCol_TabUnfocusedActive] = kControl;
  colours[ImGuiCol_PlotLines] = kAccent;
  colours[ImGuiCol_PlotLinesHovered] = kAccentHovered;
  colours[ImGuiCol_PlotHistogram] = kAccent;
  colours[ImGuiCol_PlotHistogramHovered] = kAccentHovered;
  colours[ImGuiCol_TableHeaderBg] = kRaised;
  colours[ImGuiCol_TableBorderStrong] = kLineStrong;
  colours[ImGuiCol_TableBorderLight] = kLine;
  colours[ImGuiCol_TableRowBg] = {0, 0, 0, 0};
  colours[ImGuiCol_TableRowBgAlt] = {1, 1, 1, 0.02f};
  colours[ImGuiCol_TextSelectedBg] = {0.914f, 0.620f, 0.286f, 0.35f};
  colours[ImGuiCol_DragDropTarget] = kAccent;
  colours[ImGuiCol_NavHighlight] = kAccent;
  colours[ImGuiCol_NavWindowingHighlight] = kAccent;
  colours[ImGuiCol_NavWindowingDimBg] = kShade;
  colours[ImGuiCol_ModalWindowDimBg] = kShade;
}

}  // namespace

float px(float logical) {
  const float pixels = logical * GuiContext::current().uiScale();
  // A hairline stays one.
  return logical > 0 ? std::max(1.0f, std::round(pixels)) : std::round(pixels);
}

void apply(ImGuiStyle& style, float scale) {
  style = ImGuiStyle();
  style.WindowPadding = {12, 12};
  style.WindowRounding = kRadiusLarge;
  style.WindowBorderSize = 1;
  style.WindowMinSize = {64, 32};
  style.WindowTitleAlign = {0, 0.5f};
  style.WindowMenuButtonPosition = ImGuiDir_None;
  style.ChildRounding = kRadius;
  style.ChildBorderSize = 1;
  style.PopupRounding = kRadiusLarge;
  style.PopupBorderSize = 1;
  style.FramePadding = {8, 6};
  style.FrameRounding = kRadius;
  style.FrameBorderSize = 0;
  style.ItemSpacing = {8, 8};
  style.ItemInnerSpacing = {8, 4};
  style.CellPadding = {8, 4};
  style.IndentSpacing = 16;
  style.ScrollbarSize = 12;
  style.ScrollbarRounding = 6;
  style.GrabMinSize = 12;
  style.GrabRounding = 4;
  style.TabRounding = kRadius;
  style.SelectableTextAlign = {0, 0.5f};
  style.DisabledAlpha = 0.42f;
  style.DisplaySafeAreaPadding = {0, 0};
  style.ScaleAllSizes(scale);
  // ScaleAllSizes leaves lines as they are.
  const float line = std::max(1.0f, std::round(scale));
  style.WindowBorderSize = style.ChildBorderSize = style.PopupBorderSize = line;
  style.CircleTessellationMaxError = 0.2f;
  style.CurveTessellationTol = 0.6f;
  applyColours(style.Colors);
}

}  // namespace dapple::theme
