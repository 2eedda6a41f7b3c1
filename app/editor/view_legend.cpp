#include "app/editor/view_legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/gui/gui_context.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"

namespace dapple {
namespace {

using theme::px;

constexpr int kSteps = 32;                                     // of the bar
constexpr float kBarWidth = 160, kBarHeight = 10, kChip = 10;  // logical pixels
constexpr std::size_t kMostRegions = 12;

struct KeyRow {
  vec3 colour;
  std::string text;
};

ImU32 packed(const vec3& c) {
  return ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, 1});
}

std::vector<KeyRow> rowsOf(const SceneView& view, View shown) {
  if (shown == View::State)
    return {{stateColour(PointState::Patch), "patch"},
            {stateColour(PointState::Gap), "gap"},
            {stateColour(PointState::Matched), "matched"},
            {stateColour(PointState::Free), "free"}};
  std::vector<KeyRow> rows;
  if (shown == View::Regions)
    for (const Region& region : *view.snapshot().document.regions)
      if (rows.size() < kMostRegions) rows.push_back({region.colour, region.name});
  return rows;
}

// A dark card with its lower left corner there; returns its upper left inside.
ImVec2 card(ImVec2 corner, ImVec2 inside) {
  const float pad = px(theme::kGap);
  const ImVec2 min(corner.x, corner.y - inside.y - 2 * pad);
  const ImVec2 max(corner.x + inside.x + 2 * pad, corner.y);
  ImGui::GetWindowDrawList()->AddRectFilled(
      min, max, theme::packed(theme::withAlpha(theme::kPanel, 0.85f)), px(theme::kRadius));
  markRectangle("legend", min, max);
  return {min.x + pad, min.y + pad};
}

void drawBar(const HeatRange& range, ImVec2 corner) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float width = px(kBarWidth), height = px(kBarHeight), line = ImGui::GetTextLineHeight();
  const ImVec2 at = card(corner, {width, height + px(theme::kGapSmall) + line});
  for (int k = 0; k < kSteps; ++k) {
    const auto edge = [&](int step) {
      return at.x + width * static_cast<float>(step) / static_cast<float>(kSteps);
    };
    const ImU32 left = packed(heatColour(static_cast<float>(k) / kSteps));
    const ImU32 right = packed(heatColour(static_cast<float>(k + 1) / kSteps));
    list.AddRectFilledMultiColor({edge(k), at.y}, {edge(k + 1), at.y + height}, left, right, right,
                                 left);
  }
  const std::string low = fmt::format("{:.3g}", range.low),
                    high = fmt::format("{:.3g}", range.high);
  const float y = at.y + height + px(theme::kGapSmall);
  const ImU32 text = theme::packed(theme::kText);
  list.AddText({at.x, y}, text, low.c_str());
  list.AddText({at.x + width - ImGui::CalcTextSize(high.c_str()).x, y}, text, high.c_str());
}

void drawRows(const std::vector<KeyRow>& rows, ImVec2 corner) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float line = ImGui::GetTextLineHeight() + px(theme::kGapTiny), chip = px(kChip);
  float width = 0;
  for (const KeyRow& row : rows) width = std::max(width, ImGui::CalcTextSize(row.text.c_str()).x);
  const float textX = chip + px(theme::kGap);
  ImVec2 at = card(corner, {textX + width, line * static_cast<float>(rows.size())});
  for (const KeyRow& row : rows) {
    const float y = at.y + 0.5f * (line - chip);
    list.AddRectFilled({at.x, y}, {at.x + chip, y + chip}, packed(row.colour), px(theme::kGapTiny));
    list.AddText({at.x + textX, at.y}, theme::packed(theme::kText), row.text.c_str());
    at.y += line;
  }
}

}  // namespace

void drawViewLegend(const SceneView& view, View shown, ImVec2 corner) {
  if (view.empty() || !view.missing().empty()) return;
  const scope::Font font(GuiContext::current().fonts().small);
  if (view.legend())
    drawBar(*view.legend(), corner);
  else if (const std::vector<KeyRow> rows = rowsOf(view, shown); !rows.empty())
    drawRows(rows, corner);
}

}  // namespace dapple
