// What the start screen offers of what was remembered, and the rows of the F1 sheet for the mouse.
#include <fmt/format.h>

#include <array>
#include <ctime>

#include "app/editor/editor_layout.h"
#include "app/editor/editor_memory.h"
#include "app/gui/gui_context.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"

namespace dapple {
namespace {

using theme::px;

constexpr std::size_t kRecentShown = 5, kRecoveriesShown = 2;
constexpr float kHeading = 44, kRecovery = 96;  // logical pixels

// "today 14:03", "21 Nov 14:03", "21 Nov 2025".
std::string shownTime(std::time_t time) {
  const std::time_t now = std::time(nullptr);
  std::tm then{}, today{};
  localtime_r(&time, &then);
  localtime_r(&now, &today);
  const char* format = then.tm_year != today.tm_year   ? "%-d %b %Y"
                       : then.tm_yday != today.tm_yday ? "%-d %b %H:%M"
                                                       : "today %H:%M";
  std::array<char, 64> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), format, &then);
  return {text.data(), size};
}

void gap(float logical) {
  ImGui::Dummy(px(0, logical));
}

enum class Wish { Nothing, Recover, Discard };

Wish recoveryRow(const RecoveryEntry& entry, std::size_t place) {
  const scope::Id id(static_cast<int>(place));
  const scope::Colour back(ImGuiCol_ChildBg, theme::kAccentSoft);
  const scope::Style rounding(ImGuiStyleVar_ChildRounding, px(theme::kRadius));
  const scope::Style padding(ImGuiStyleVar_WindowPadding, px(12, 10));
  Wish wish = Wish::Nothing;
  const scope::Child row("recovery", {0, px(kRecovery - theme::kGap)}, false,
                         ImGuiWindowFlags_AlwaysUseWindowPadding | ImGuiWindowFlags_NoScrollbar);
  clippedText("Unsaved work: " + entry.name(), ImGui::GetContentRegionAvail().x);
  std::string note = shownTime(entry.time);
  if (!entry.label.empty()) note += ", last edit: " + entry.label;
  {
    const scope::Font font(GuiContext::current().fonts().small);
    const scope::Colour muted(ImGuiCol_Text, theme::kTextMuted);
    clippedText(note, ImGui::GetContentRegionAvail().x);
  }
  if (textButton("Recover", ButtonKind::primary, Icon::none, px(96),
                 fmt::format("recovery.{}.recover", place)))
    wish = Wish::Recover;
  ImGui::SameLine();
  if (textButton("Discard", ButtonKind::quiet, Icon::none, px(84),
                 fmt::format("recovery.{}.discard", place)))
    wish = Wish::Discard;
  return wish;
}

}  // namespace

float Editor::Memory::startListsHeight() const {
  const std::size_t recoveries = std::min(offered.size(), kRecoveriesShown);
  const std::size_t files = std::min(recent.size(), kRecentShown);
  return px(static_cast<float>(recoveries) * kRecovery + (recoveries > 0 ? theme::kGapLarge : 0)) +
         (files > 0 ? px(kHeading + static_cast<float>(files) * (theme::kRowHeight + 2)) : 0);
}

void Editor::Memory::startLists() {
  if (!offered.empty()) gap(theme::kGapSmall);
  for (std::size_t k = 0; k < std::min(offered.size(), kRecoveriesShown); ++k) {
    const Wish wish = recoveryRow(offered[k], k);
    if (wish == Wish::Recover) return recover(offered[k]);
    if (wish == Wish::Nothing) continue;
    discardRecovery(offered[k]);
    offered.erase(offered.begin() + static_cast<std::ptrdiff_t>(k));
    return;
  }
  if (recent.empty()) return;
  gap(theme::kGapSmall);
  heading("Recent");
  const scope::Style spacing(ImGuiStyleVar_ItemSpacing, px(theme::kGap, 2));
  for (std::size_t k = 0; k < std::min(recent.size(), kRecentShown); ++k) {
    const RecentFile& file = recent[k];
    const scope::Id id(static_cast<int>(k));
    const std::string name = file.path.filename().string();
    const bool project = file.path.extension() == ".dapple";
    if (listRow({.id = name.c_str(),
                 .icon = project ? Icon::file : Icon::points,
                 .note = shownTime(file.time),
                 .mark = fmt::format("start.recent.{}", k)}))
      return openRecent(k);
    tooltip(file.path.string());
  }
}

std::vector<ShortcutSheet::Extra> Editor::Memory::gestures() const {
  std::vector<ShortcutSheet::Extra> rows;
  const std::pair<CameraMotion, const char*> motions[] = {
      {CameraMotion::orbit, "Orbit"}, {CameraMotion::pan, "Pan"}, {CameraMotion::zoom, "Zoom"}};
  for (const auto& [motion, label] : motions)
    for (const std::string& gesture : gesturesOf(*editor.navigation_, motion))
      rows.push_back({"View", gesture + "-drag", label});
  rows.push_back({"View", "Wheel", "Zoom"});
  return rows;
}

}  // namespace dapple
