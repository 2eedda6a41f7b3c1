#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/gui/file_browser.h"
#include "app/gui/gui_context.h"
#include "app/gui/item_marks.h"
#include "app/gui/keys.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"

// The parts of the file browser's dialog; what they do is in file_browser.cpp.
namespace dapple {
namespace {

namespace fs = std::filesystem;
using namespace theme;

constexpr float kPlacesWidth = 176, kSizeWidth = 84, kDateWidth = 140, kThumbnailRow = 48;

// Completes on Tab, inside ImGui's text field.
int completeOnTab(ImGuiInputTextCallbackData* data) {
  const std::string& completed = *static_cast<const std::string*>(data->UserData);
  if (data->EventFlag != ImGuiInputTextFlags_CallbackCompletion || completed.empty()) return 0;
  data->DeleteChars(0, data->BufTextLen);
  data->InsertChars(0, completed.c_str());
  return 0;
}

}  // namespace

void FileBrowser::drawBreadcrumb(float width) {
  std::vector<std::pair<std::string, fs::path>> parts;
  fs::path sum;
  for (const fs::path& part : folder_) {
    sum /= part;
    if (!part.empty()) parts.push_back({shownText(part.native()), sum});
  }
  const float padding = px(kGap), chevron = px(12);
  const auto widthOf = [&](const std::string& name) {
    return ImGui::CalcTextSize(name.c_str()).x + 2 * padding;
  };
  // From the end as many as fit; the rest can be reached by going up.
  std::size_t first = parts.size();
  float used = 0;
  while (first > 0 &&
         (first == parts.size() || used + widthOf(parts[first - 1].first) + chevron <= width))
    used += widthOf(parts[--first].first) + chevron;
  std::optional<fs::path> target;
  for (std::size_t i = first; i < parts.size(); ++i) {
    const scope::Id id(static_cast<int>(i));
    const bool last = i + 1 == parts.size();
    const scope::Colour ink(ImGuiCol_Text, last ? kText : kTextMuted);
    const scope::Colour none(ImGuiCol_Button, {0, 0, 0, 0});
    const std::string shown = shortenedMiddle(parts[i].first, width - 2 * padding);
    if (ImGui::Button((shown + "##part").c_str(), {0, px(kIconButtonSize)}))
      target = parts[i].second;
    markItem("files.part." + parts[i].first);
    if (last) break;
    ImGui::SameLine(0, 0);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    drawIcon(*ImGui::GetWindowDrawList(), Icon::chevronRight,
             {at.x, at.y + std::round((px(kIconButtonSize) - px(10)) / 2)}, px(10),
             ImGui::GetColorU32(kTextFaint));
    ImGui::Dummy({px(10), 1});
    ImGui::SameLine(0, 0);
  }
  if (target) goTo(*target);
}

void FileBrowser::drawTop() {
  heading(question_.title.c_str());
  ImGui::Dummy({0, px(kGapTiny)});
  const scope::Style spacing(ImGuiStyleVar_ItemSpacing, px(kGapSmall, kGap));
  if (iconButton({.icon = Icon::up,
                  .id = "files.up",
                  .tooltip = "Folder above",
                  .keys = "Backspace",
                  .enabled = folder_.has_relative_path()})) {
    selectWhenRead_ = folder_;
    goTo(folder_.parent_path());
  }
  ImGui::SameLine();
  const float buttons = 2 * (px(kIconButtonSize) + px(kGapSmall));
  drawBreadcrumb(ImGui::GetContentRegionAvail().x - buttons - px(kGap));
  ImGui::SameLine();
  alignRight(buttons - px(kGapSmall));
  if (iconButton({.icon = showHidden_ ? Icon::eye : Icon::eyeOff,
                  .id = "files.hidden",
                  .tooltip = showHidden_ ? "Leave hidden files out" : "Show hidden files",
                  .keys = "Ctrl+H",
                  .selected = showHidden_})) {
    showHidden_ = !showHidden_;
    refresh();
  }
  ImGui::SameLine();
  if (iconButton({.icon = Icon::plus, .id = "files.new-folder", .tooltip = "New folder"}))
    makeFolder();
}

void FileBrowser::drawPlace(const char* label, int icon, const fs::path& folder) {
  const scope::Id id(folder.c_str());
  const float height = px(kRowHeight), width = ImGui::GetContentRegionAvail().x, side = px(16);
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const bool clicked = ImGui::InvisibleButton(label, {width, height});
  markItem(std::string("files.place.") + label);
  const bool here = folder == folder_;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (here || ImGui::IsItemHovered())
    list.AddRectFilled(min, {min.x + width, min.y + height},
                       ImGui::GetColorU32(here ? kAccentSoft : kControl), px(kRadius));
  drawIcon(list, static_cast<Icon>(icon),
           {min.x + px(kGap), min.y + std::round((height - side) / 2)}, side,
           ImGui::GetColorU32(here ? kAccentHovered : kTextMuted));
  const std::string shown = shortenedMiddle(label, width - side - 3 * px(kGap));
  list.AddText(
      {min.x + side + 2 * px(kGap), min.y + std::round((height - ImGui::GetFontSize()) / 2)},
      ImGui::GetColorU32(kText), shown.c_str());
  tooltip(shownText(folder.native()));
  if (clicked) goTo(folder);
}

void FileBrowser::drawPlaces() {
  const scope::Child places("##places", {px(kPlacesWidth), ImGui::GetContentRegionAvail().y});
  const scope::Style spacing(ImGuiStyleVar_ItemSpacing, px(0, 2));
  const fs::path home = resolvedPath("~", folder_);
  std::error_code error;
  drawPlace("Home", static_cast<int>(Icon::home), home);
  for (const char* name : {"Desktop", "Documents", "Downloads", "Pictures"})
    if (fs::is_directory(home / name, error))
      drawPlace(name, static_cast<int>(Icon::folder), home / name);
  drawPlace("Computer", static_cast<int>(Icon::layers), "/");
  if (question_.recentFolders.empty()) return;
  ImGui::Dummy({0, px(kGap)});
  mutedText("Recent");
  for (const fs::path& folder : question_.recentFolders)
    drawPlace(shownText((folder.has_filename() ? folder : folder.parent_path()).filename().native())
                  .c_str(),
              static_cast<int>(Icon::clock), folder);
}

void FileBrowser::drawHeader() {
  struct Column {
    const char* label;
    const char* mark;
    FolderOrder order;
  };
  constexpr Column kColumns[] = {{"Name", "files.sort.name", FolderOrder::name},
                                 {"Size", "files.sort.size", FolderOrder::size},
                                 {"Changed", "files.sort.date", FolderOrder::date}};
  const float height = px(26), full = ImGui::GetContentRegionAvail().x;
  const float widths[] = {full - px(kSizeWidth) - px(kDateWidth), px(kSizeWidth), px(kDateWidth)};
  const scope::Style spacing(ImGuiStyleVar_ItemSpacing, ImVec2{0, 0});
  const scope::Font small(GuiContext::current().fonts().small);
  for (int i = 0; i < 3; ++i) {
    if (i > 0) ImGui::SameLine();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    // In line with the rows, which the list's border and padding make narrower on both sides.
    const ImVec2 min{corner.x + (i == 0 ? px(kGapSmall) : -px(kGapSmall)), corner.y};
    if (ImGui::InvisibleButton(kColumns[i].label, {std::max(widths[i], 1.0f), height})) {
      descending_ = order_ == kColumns[i].order && !descending_;
      order_ = kColumns[i].order;
      refresh();
    }
    markItem(kColumns[i].mark);
    const bool sorted = order_ == kColumns[i].order;
    const ImU32 ink = ImGui::GetColorU32(sorted || ImGui::IsItemHovered() ? kText : kTextMuted);
    const float textY = min.y + std::round((height - ImGui::GetFontSize()) / 2);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddText({min.x + px(kGap), textY}, ink, kColumns[i].label);
    if (!sorted) continue;
    const float x = min.x + px(kGap) + ImGui::CalcTextSize(kColumns[i].label).x + px(6);
    const float middle = min.y + height / 2, r = px(3), tip = descending_ ? r : -r;
    list.AddTriangleFilled({x, middle - tip / 2}, {x + 2 * r, middle - tip / 2},
                           {x + r, middle + tip}, ink);
  }
}

void FileBrowser::drawRow(std::size_t row, float height) {
  const FolderEntry entry = listing_.entries[rows_[row]];
  const scope::Id id(static_cast<int>(row));
  const float width = ImGui::GetContentRegionAvail().x, gap = px(kGap);
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const bool clicked = ImGui::InvisibleButton("##row", {width, height});
  markItem("files.entry." + entry.shown);
  const bool hovered = ImGui::IsItemHovered(), chosen = selected_ == row;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (hovered || chosen)
    list.AddRectFilled(min, {min.x + width, min.y + height},
                       ImGui::GetColorU32(chosen ? kAccentSoft : kControl), px(kRadius));
  const float side = std::round(height - px(thumbnails_ ? 8 : 12));
  const ImVec2 at{min.x + gap, min.y + std::round((height - side) / 2)};
  const ImTextureID picture = thumbnails_ && !entry.folder ? thumbnails_(entry.path) : nullptr;
  if (picture != nullptr)
    list.AddImageRounded(picture, at, {at.x + side, at.y + side}, {0, 0}, {1, 1},
                         ImGui::GetColorU32({1, 1, 1, 1}), px(3));
  else
    drawIcon(list, entry.folder ? Icon::folder : Icon::file,
             {at.x + std::round((side - px(16)) / 2), at.y + std::round((side - px(16)) / 2)},
             px(16), ImGui::GetColorU32(entry.folder ? kAccent : kTextMuted));
  const float textY = min.y + std::round((height - ImGui::GetFontSize()) / 2);
  const float nameX = at.x + side + gap;
  const float columns = px(kSizeWidth) + px(kDateWidth);
  const std::string name = shortenedMiddle(entry.shown, min.x + width - columns - gap - nameX);
  const ImU32 ink = ImGui::GetColorU32(entry.hidden ? kTextMuted : kText);
  list.AddText({nameX, textY}, ink, name.c_str());
  const ImU32 muted = ImGui::GetColorU32(kTextMuted);
  const std::string size = entry.folder ? std::string() : shownSize(entry.bytes);
  list.AddText({min.x + width - columns + gap, textY}, muted, size.c_str());
  list.AddText({min.x + width - px(kDateWidth) + gap, textY}, muted,
               shownDate(entry.changed).c_str());
  // The release that ends a double click belongs to it, not to the row that came under it.
  if (hovered && ImGui::IsMouseDoubleClicked(0))
    activate(row);
  else if (clicked && ImGui::GetIO().MouseClickedLastCount[0] < 2)
    select(row);
}

void FileBrowser::drawEntries() {
  const scope::Group group;
  drawHeader();
  const scope::Colour field(ImGuiCol_ChildBg, kField);
  const scope::Style padding(ImGuiStyleVar_WindowPadding, px(kGapSmall, kGapSmall));
  const scope::Child list("##entries", {0, ImGui::GetContentRegionAvail().y}, true);
  markRectangle("files.list", ImGui::GetWindowPos(),
                {ImGui::GetWindowPos().x + ImGui::GetWindowWidth(),
                 ImGui::GetWindowPos().y + ImGui::GetWindowHeight()});
  if (busy()) return mutedText("Reading the folder …");
  if (!listing_.error.empty()) {
    iconItem(Icon::warning, kWarning);
    ImGui::SameLine();
    const scope::WrappedText wrapped;
    return ImGui::TextUnformatted(listing_.error.c_str());
  }
  if (rows_.empty())
    return mutedText(listing_.entries.empty() ? "This folder is empty."
                                              : "Nothing of the chosen kind is in this folder.");
  const scope::Style spacing(ImGuiStyleVar_ItemSpacing, ImVec2{0, 0});
  const float height = px(thumbnails_ ? kThumbnailRow : kRowHeight);
  if (scroll_ && selected_) {
    const float top = height * static_cast<float>(*selected_) + px(kGapSmall);
    const float visible = ImGui::GetWindowHeight() - 2 * px(kGapSmall);
    if (top < ImGui::GetScrollY()) ImGui::SetScrollY(top);
    if (top + height > ImGui::GetScrollY() + visible) ImGui::SetScrollY(top + height - visible);
  }
  scroll_ = false;
  const fs::path folder = folder_;
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows_.size()), height);
  while (clipper.Step())
    for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row)
      // A double click goes elsewhere and empties the list.
      if (folder == folder_ && static_cast<std::size_t>(row) < rows_.size())
        drawRow(static_cast<std::size_t>(row), height);
      else
        ImGui::Dummy({1, height});
}

void FileBrowser::drawCompletions() {
  if (completions_.empty() || !ImGui::IsItemActive()) return;
  std::string words;
  for (std::size_t i = 0; i < std::min<std::size_t>(completions_.size(), 6); ++i)
    words += (i > 0 ? "    " : "") + shownText(completions_[i]);
  if (completions_.size() > 6) words += "    …";
  const ImVec2 min = ImGui::GetItemRectMin();
  const scope::Font small(GuiContext::current().fonts().small);
  const ImVec2 size = ImGui::CalcTextSize(words.c_str());
  const float pad = px(kGap), height = size.y + px(12);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 top{min.x, min.y - height - px(kGapSmall)};
  const ImVec2 bottom{std::min(min.x + size.x + 2 * pad + px(48), ImGui::GetItemRectMax().x),
                      min.y - px(kGapSmall)};
  list.AddRectFilled(top, bottom, ImGui::GetColorU32(kControl), px(kRadius));
  const scope::ClipRect clip(top, bottom);
  list.AddText({top.x + pad, top.y + px(6)}, ImGui::GetColorU32(kText), words.c_str());
  list.AddText({top.x + pad + size.x + px(14), top.y + px(6)}, ImGui::GetColorU32(kTextFaint),
               "Tab");
}

void FileBrowser::drawField() {
  const float kinds = question_.kinds.empty() ? 0 : px(200);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - (kinds > 0 ? kinds + px(kGap) : 0));
  if (focusField_ && !replacing_) {
    ImGui::SetKeyboardFocusHere();
    focusField_ = false;
  }
  if (typed_ && completedFor_ != field_) {
    completedFor_ = field_;
    completions_ =
        field_.empty() ? std::vector<std::string>() : completions(field_, folder_, view());
  }
  if (!typed_) completions_.clear();
  std::string completed = commonPrefix(completions_);
  const bool entered = ImGui::InputTextWithHint(
      "##field",
      question_.purpose == BrowseFor::save     ? "Name of the file"
      : question_.purpose == BrowseFor::folder ? "Folder; empty for the one shown"
                                               : "Name or path",
      &field_,
      kTextFlags | ImGuiInputTextFlags_CallbackCompletion | ImGuiInputTextFlags_EnterReturnsTrue,
      completeOnTab, &completed);
  markItem("files.field");
  if (ImGui::IsItemEdited()) {
    typed_ = true;
    selected_.reset();
    error_.clear();
  }
  drawCompletions();
  if (entered) {
    accept();
    if (!result_) focusField_ = true;
  }
  if (question_.kinds.empty()) return;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(kinds);
  const scope::Combo combo("##kind", question_.kinds[static_cast<std::size_t>(kind_)].name.c_str());
  markItem("files.kind");
  if (!combo) return;
  for (int i = 0; i < static_cast<int>(question_.kinds.size()); ++i) {
    const std::string& name = question_.kinds[static_cast<std::size_t>(i)].name;
    if (ImGui::Selectable(name.c_str(), i == kind_)) {
      kind_ = i;
      refresh();
    }
    markItem("files.kind." + name);
  }
}

void FileBrowser::drawReplaceQuestion() {
  const std::string name = shownText(replacing_->filename().native());
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = px(kButtonHeight);
  ImGui::GetWindowDrawList()->AddRectFilled(
      {min.x - px(kGap), min.y - px(kGapSmall)},
      {min.x + width + px(kGap), min.y + height + px(kGapSmall)},
      ImGui::GetColorU32(withAlpha(kWarning, 0.14f)), px(kRadius));
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + px(6));
  iconItem(Icon::warning, kWarning);
  ImGui::SameLine();
  clippedText(fmt::format("{} is there already. Replace it?", name), width - px(260));
  ImGui::SameLine();
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() - px(6));
  alignRight(px(200) + px(kGap));
  if (textButton("Keep", ButtonKind::normal, Icon::none, px(100), "files.keep") ||
      ImGui::IsKeyPressed(static_cast<int>(Key::escape), false)) {
    replacing_.reset();
    focusField_ = true;
    return;
  }
  ImGui::SameLine();
  if (textButton("Replace", ButtonKind::danger, Icon::none, px(100), "files.replace"))
    result_ = std::exchange(replacing_, {});
}

void FileBrowser::drawButtons() {
  if (replacing_) return drawReplaceQuestion();
  const float button = px(100);
  const float top = ImGui::GetCursorPosY();
  ImGui::SetCursorPosY(top + px(6));
  if (!error_.empty()) {
    iconItem(Icon::warning, kError, px(16));
    ImGui::SameLine();
    const scope::Colour colour(ImGuiCol_Text, kError);
    clippedText(error_, ImGui::GetContentRegionAvail().x - 2 * button - 3 * px(kGap));
  } else if (selected_ || !listing_.error.empty() || busy()) {
    ImGui::Dummy({1, 1});
  } else {
    mutedText(fmt::format("{} of {} entries", rows_.size(), listing_.entries.size()));
  }
  ImGui::SameLine();
  ImGui::SetCursorPosY(top);
  alignRight(2 * button + px(kGap));
  if (textButton("Cancel", ButtonKind::normal, Icon::none, button, "files.cancel")) close_ = true;
  ImGui::SameLine();
  if (textButton(question_.accept.c_str(), ButtonKind::primary, Icon::none, button, "files.accept"))
    accept();
}

}  // namespace dapple
