#include "app/editor/coach_marks.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <iterator>

#include "app/gui/gui_context.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"

namespace dapple {
namespace {

using theme::px;

struct CoachMark {
  const char *id, *beside, *title, *text;
};
constexpr CoachMark kMarks[] = {
    {"segment", "tool.brush", "Mark a part",
     "Brush over a part of the scan. Ctrl+G makes it a region of its own; without regions the "
     "whole scan is one."},
    {"swatch", "panel.swatch", "Choose its swatch",
     "The small image that the region is to look like: click one, or drop an image of yours."},
    {"strokes", "tool.stroke", "Give it a direction",
     "Stroke over the surface where the swatch's top is to point."},
    {"synthesize", "synthesize.all", "Watch it grow",
     "Synthesize gives every point its colour. You can go on working meanwhile; Escape stops it."},
};
constexpr float kWidth = 270, kTip = 9, kDistance = 6;  // logical pixels

const CoachMark* next(const std::set<std::string>& dismissed) {
  for (const CoachMark& mark : kMarks) {
    if (dismissed.contains(mark.id)) continue;
    const ItemMark* item = GuiContext::current().marks().find(mark.beside);
    if (item && item->visible) return &mark;
  }
  return nullptr;
}

// On the side of the thing where the window has room; the tip of the frame points at it.
struct Place {
  ImVec2 min, tip;
  bool right;  // of the thing
};

Place placeBeside(const ItemMark& item, ImVec2 size) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const float away = px(kTip + kDistance), middle = (item.min.y + item.max.y) / 2;
  const bool right = item.min.x + item.max.x < display.x;
  const float x = right ? item.max.x + away : item.min.x - away - size.x;
  const float top = ImGui::GetFrameHeight() + px(theme::kGap);  // below the menus
  const float y =
      std::clamp(middle - px(24), top, std::max(top, display.y - size.y - px(theme::kGap)));
  return {{x, y}, {right ? item.max.x + px(kDistance) : item.min.x - px(kDistance), middle}, right};
}

void drawTip(const Place& place, float width) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float side = place.right ? place.min.x + 1 : place.min.x + width - 1;
  const float height = px(kTip) * 0.8f;
  list->PushClipRectFullScreen();
  list->AddTriangleFilled(place.tip, {side, place.tip.y - height}, {side, place.tip.y + height},
                          theme::packed(theme::kAccent));
  list->PopClipRect();
}

}  // namespace

bool coachMarksDone(const std::set<std::string>& dismissed) {
  return std::all_of(std::begin(kMarks), std::end(kMarks),
                     [&](const CoachMark& mark) { return dismissed.contains(mark.id); });
}

bool drawCoachMark(std::set<std::string>& dismissed) {
  if (ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel))
    return false;
  const CoachMark* mark = next(dismissed);
  if (!mark) return false;
  const ItemMark item = *GuiContext::current().marks().find(mark->beside);
  const float width = px(kWidth), inner = width - 2 * px(14);
  const float words = ImGui::CalcTextSize(mark->text, nullptr, false, inner).y;
  const ImVec2 size{width, words + ImGui::GetTextLineHeight() + px(theme::kButtonHeight) + px(52)};
  const Place place = placeBeside(item, size);
  ImGui::SetNextWindowPos(place.min);
  ImGui::SetNextWindowSize(size);
  const scope::Style padding(ImGuiStyleVar_WindowPadding, px(14, 12));
  const scope::Style rounding(ImGuiStyleVar_WindowRounding, px(theme::kRadiusLarge));
  const scope::Style line(ImGuiStyleVar_WindowBorderSize, px(1.5f));
  const scope::Colour raised(ImGuiCol_WindowBg, theme::kRaised);
  const scope::Colour border(ImGuiCol_Border, theme::kAccent);
  const scope::Window window("hint", nullptr,
                             ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                 ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                 ImGuiWindowFlags_NoFocusOnAppearing);
  drawTip(place, width);
  markRectangle(fmt::format("hint.{}", mark->id), place.min,
                {place.min.x + size.x, place.min.y + size.y});
  heading(mark->title);
  {
    const scope::WrappedText wrapped(px(14) + inner);
    ImGui::TextUnformatted(mark->text);
  }
  ImGui::Dummy(px(0, theme::kGapTiny));
  const bool none = textButton("No more hints", ButtonKind::quiet, Icon::none, 0, "hint.none");
  ImGui::SameLine();
  alignRight(px(84));
  const bool got = textButton("Got it", ButtonKind::primary, Icon::none, px(84), "hint.next");
  if (none)
    for (const CoachMark& each : kMarks) dismissed.insert(each.id);
  if (got) dismissed.insert(mark->id);
  return none || got;
}

}  // namespace dapple
