#include "app/editor/region_panel.h"

#include <fmt/format.h>

#include <cmath>

#include "app/gui/gui_context.h"
#include "app/gui/gui_renderer.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"
#include "document/options_table.h"

namespace dapple {
namespace {

using theme::px;

constexpr float kRow = 34, kChip = 14, kThumbnail = 26, kIcon = 24;  // logical pixels
constexpr std::size_t kLongestName = 200;                            // bytes, as the engine's

std::string methodOf(const Region& region) {
  return optionText(region.options, *findOption("method"));
}

// The part of the picture that the region takes, over the item's square.
void thumbnail(const SwatchLibrary::Entry& entry, const Region& region, ImVec2 min, float side) {
  ImVec2 low(0, 0), high(1, 1);
  if (const auto& crop = region.reference.crop) {
    const auto w = static_cast<float>(entry.imageWidth), h = static_cast<float>(entry.imageHeight);
    low = {static_cast<float>(crop->x) / w, static_cast<float>(crop->y) / h};
    high = {static_cast<float>(crop->x + crop->width) / w,
            static_cast<float>(crop->y + crop->height) / h};
  }
  ImGui::GetWindowDrawList()->AddImageRounded(guiTexture(entry.thumbnail.id()), min,
                                              {min.x + side, min.y + side}, low, high,
                                              IM_COL32_WHITE, px(theme::kGapSmall));
}

}  // namespace

void RegionPanel::rename(const Region& region) {
  renaming_ = region.id;
  name_ = region.name;
  open_ = focus_ = true;
}

void RegionPanel::chip(const Region& region) {
  const std::string popup = fmt::format("colour {}", region.id);
  const ImVec2 at = ImGui::GetCursorPos();
  if (ImGui::InvisibleButton("chip", px(kChip, kChip))) {
    picked_ = region.colour;
    ImGui::OpenPopup(popup.c_str());
  }
  markItem(fmt::format("region.colour.{}", region.id));
  tooltip("Colour in the list and the view of regions");
  ImGui::SetCursorPos(at);
  colourChip({region.colour.r, region.colour.g, region.colour.b, 1}, px(kChip));
  if (const scope::Popup opened(popup.c_str()); opened) {
    if (ImGui::ColorPicker3("##picker", &picked_.x,
                            ImGuiColorEditFlags_NoSidePreview | ImGuiColorEditFlags_NoInputs)) {
      SetRegion set{.region = region.id, .gesture = gesture_};
      set.colour = glm::clamp(picked_, 0.f, 1.f);
      engine_->submit(set);
    }
  }
}

void RegionPanel::name(const Region& region, float width) {
  if (!open_ || renaming_ != region.id) {
    clippedText(region.name, width);
    return;
  }
  if (focus_) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(width);
  name_.resize(kLongestName + 1);
  const bool entered = ImGui::InputText(
      "##name", name_.data(), name_.size(),
      kTextFlags | ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
  name_.resize(name_.find('\0'));
  markItem("region.name");
  const bool left = ImGui::IsItemDeactivated() || (!focus_ && !ImGui::IsItemActive());
  focus_ = false;
  const bool given =
      (entered || ImGui::IsItemDeactivatedAfterEdit()) && !name_.empty() && name_ != region.name;
  if (given) {
    SetRegion set{.region = region.id};
    set.name = name_;
    engine_->submit(set);
  }
  if (entered || left) open_ = false;
}

void RegionPanel::buttons(const Region& region) {
  SetRegion set{.region = region.id};
  if (iconButton({.icon = region.visible ? Icon::eye : Icon::eyeOff,
                  .id = "visible",
                  .tooltip = region.visible ? "Hide" : "Show",
                  .size = kIcon})) {
    set.visible = !region.visible;
    engine_->submit(set);
  }
  markItem(fmt::format("region.visible.{}", region.id));
  ImGui::SameLine(0, 0);
  if (iconButton({.icon = region.locked ? Icon::lock : Icon::unlock,
                  .id = "locked",
                  .tooltip = region.locked ? "Unlock" : "Lock: its points stay as they are",
                  .selected = region.locked,
                  .size = kIcon})) {
    set.locked = !region.locked;
    engine_->submit(set);
  }
  markItem(fmt::format("region.locked.{}", region.id));
}

void RegionPanel::menu(const Region& region, std::size_t position, std::size_t count) {
  const scope::ContextPopup popup("menu");
  if (!popup) return;
  const auto item = [&](const char* label, const Command& command, bool enabled = true) {
    if (ImGui::MenuItem(label, nullptr, false, enabled)) engine_->submit(command);
    markItem(fmt::format("region.menu.{}", label));
  };
  if (ImGui::MenuItem("Rename...")) rename(region);
  markItem("region.menu.Rename");
  item("Select its points", SelectRegion{region.id});
  item("Show only this", ShowOnly{region.id});
  item("Show all", ShowOnly{});
  ImGui::Separator();
  item("Synthesize", Synthesize{region.id}, region.swatch && !region.locked);
  item("Clear its result", ClearResult{region.id});
  ImGui::Separator();
  item("Move up", MoveRegion{region.id, position - 1}, position > 0);
  item("Move down", MoveRegion{region.id, position + 1}, position + 1 < count);
  item("Remove", RemoveRegion{region.id}, region.id != kUnassigned);
}

bool RegionPanel::row(const std::vector<Region>& regions, std::size_t position, bool chosen) {
  const Region& region = regions[position];
  const float height = px(kRow), icons = 2 * px(kIcon) + px(theme::kGapSmall);
  const ImVec2 start = ImGui::GetCursorPos();
  const float width = ImGui::GetContentRegionAvail().x;
  const auto middle = [&](float x, float size) {
    ImGui::SetCursorPos({start.x + x, start.y + std::round(0.5f * (height - size))});
  };
  const bool clicked = ImGui::Selectable(
      "##row", chosen,
      ImGuiSelectableFlags_AllowItemOverlap | ImGuiSelectableFlags_AllowDoubleClick,
      {width - icons, height});
  markItem(fmt::format("region.row.{}", region.id));
  if (clicked && ImGui::IsMouseDoubleClicked(0)) rename(region);
  menu(region, position, regions.size());
  float x = px(theme::kGapSmall);
  middle(x, px(kChip));
  chip(region);
  x += px(kChip) + px(theme::kGap);
  const SwatchLibrary::Entry* entry =
      region.reference.path.empty() ? nullptr : library_->wanted(region.reference.path);
  if (entry) {
    middle(x, px(kThumbnail));
    thumbnail(*entry, region, ImGui::GetCursorScreenPos(), px(kThumbnail));
    x += px(kThumbnail) + px(theme::kGap);
  }
  const std::string note = region.swatch ? methodOf(region) : "no swatch";
  float noteWidth = 0;
  {
    const scope::Font font(GuiContext::current().fonts().small);
    noteWidth = ImGui::CalcTextSize(note.c_str()).x;
    middle(width - icons - noteWidth - px(theme::kGapSmall), ImGui::GetTextLineHeight());
    const scope::Colour muted(ImGuiCol_Text, theme::kTextFaint);
    ImGui::TextUnformatted(note.c_str());
  }
  const bool field = open_ && renaming_ == region.id;
  middle(x, field ? ImGui::GetFrameHeight() : ImGui::GetTextLineHeight());
  name(region, width - icons - x - noteWidth - px(2 * theme::kGap));
  middle(width - icons + px(theme::kGapSmall), px(kIcon));
  buttons(region);
  ImGui::SetCursorPos({start.x, start.y + height + px(theme::kGapTiny)});
  return clicked;
}

RegionId RegionPanel::draw(const Document& document, RegionId chosen, SwatchLibrary& library,
                           Engine& engine) {
  library_ = &library, engine_ = &engine;
  if (ImGui::IsMouseClicked(0)) gesture_ = static_cast<unsigned>(ImGui::GetFrameCount());
  const std::vector<Region>& regions = *document.regions;
  for (std::size_t k = 0; k < regions.size(); ++k) {
    const scope::Id id(regions[k].id);
    const scope::Group group;
    if (row(regions, k, regions[k].id == chosen)) chosen = regions[k].id;
  }
  library_ = nullptr, engine_ = nullptr;
  return chosen;
}

}  // namespace dapple
