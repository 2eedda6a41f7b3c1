#include "app/gui/file_browser.h"

#include <fmt/format.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <thread>
#include <utility>

#include "app/gui/gui_context.h"
#include "app/gui/item_marks.h"
#include "app/gui/keys.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;
using namespace theme;

constexpr const char* kName = "##files";
constexpr float kWidth = 860, kHeight = 560, kPlacesWidth = 176;
constexpr float kSizeWidth = 84, kDateWidth = 140, kThumbnailRow = 48;
constexpr double kJumpPause = 0.9;  // seconds that end a typed name
// A folder that takes longer is waited for without standing still.
constexpr std::chrono::milliseconds kPatience{15};

fs::path homeFolder() {
  const char* home = std::getenv("HOME");
  return home == nullptr || *home == '\0' ? fs::path("/") : fs::path(home);
}

bool isFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool isThere(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

fs::path firstFolder(fs::path path) {
  if (path.empty()) return homeFolder();
  std::error_code error;
  path = fs::absolute(path, error).lexically_normal();
  while (!isFolder(path) && path.has_relative_path()) path = path.parent_path();
  return path;
}

bool keyHit(Key key, bool repeat = false) {
  return ImGui::IsKeyPressed(static_cast<int>(key), repeat);
}

std::string defaultAccept(BrowseFor purpose) {
  return purpose == BrowseFor::open ? "Open" : purpose == BrowseFor::save ? "Save" : "Choose";
}

// Completes on Tab, inside ImGui's text field.
int completeOnTab(ImGuiInputTextCallbackData* data) {
  const std::string& completed = *static_cast<const std::string*>(data->UserData);
  if (data->EventFlag != ImGuiInputTextFlags_CallbackCompletion || completed.empty()) return 0;
  data->DeleteChars(0, data->BufTextLen);
  data->InsertChars(0, completed.c_str());
  return 0;
}

}  // namespace

void FileBrowser::open(FileQuestion question) {
  question_ = std::move(question);
  if (question_.accept.empty()) question_.accept = defaultAccept(question_.purpose);
  kind_ = 0;
  field_ = question_.name;
  error_.clear();
  replacing_.reset();
  result_.reset();
  back_.clear();
  opening_ = true;
  close_ = false;
  typed_ = question_.purpose == BrowseFor::save;
  focusField_ = typed_;
  goTo(firstFolder(question_.folder), false);
}

void FileBrowser::goTo(const fs::path& folder, bool remember) {
  if (remember && folder != folder_) back_.push_back(folder_);
  folder_ = folder;
  listing_ = {folder, {}, {}};
  rows_.clear();
  selected_.reset();
  jump_.clear();
  completedFor_.clear();
  completions_.clear();
  // A task of its own thread, not std::async: leaving a dead network folder must not wait for it.
  std::packaged_task<FolderListing()> task([folder] { return readFolder(folder); });
  reading_ = task.get_future();
  std::thread(std::move(task)).detach();
  reading_.wait_for(kPatience);
  takeListing();
}

void FileBrowser::takeListing() {
  if (!reading_.valid() || reading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return;
  listing_ = reading_.get();
  refresh();
  for (std::size_t row = 0; row < rows_.size(); ++row)
    if (listing_.entries[rows_[row]].path == selectWhenRead_) {
      selected_ = row;
      scroll_ = true;
    }
  selectWhenRead_.clear();
}

FolderView FileBrowser::view() const {
  FolderView view{{}, showHidden_, question_.purpose == BrowseFor::folder, order_, descending_};
  if (kind_ < static_cast<int>(question_.kinds.size()))
    view.extensions = question_.kinds[static_cast<std::size_t>(kind_)].extensions;
  return view;
}

void FileBrowser::refresh() {
  fs::path kept;
  if (selected_) kept = listing_.entries[rows_[*selected_]].path;
  selected_.reset();
  rows_ = shownEntries(listing_, view());
  for (std::size_t row = 0; row < rows_.size(); ++row)
    if (listing_.entries[rows_[row]].path == kept) selected_ = row;
}

void FileBrowser::select(std::size_t row) {
  selected_ = row;
  scroll_ = true;
  error_.clear();
  const FolderEntry& entry = listing_.entries[rows_[row]];
  // A folder must not overwrite the name under which one is about to save.
  if (entry.folder && question_.purpose == BrowseFor::save) return;
  field_ = entry.shown;
  typed_ = false;
}

void FileBrowser::activate(std::size_t row) {
  const FolderEntry entry = listing_.entries[rows_[row]];
  if (entry.folder) {
    if (question_.purpose != BrowseFor::save) field_.clear();
    goTo(entry.path);
    return;
  }
  select(row);
  accept();
}

void FileBrowser::accept() {
  error_.clear();
  if (typed_ && !field_.empty()) return acceptTyped(resolvedPath(field_, folder_));
  if (question_.purpose == BrowseFor::folder) {
    result_ = selected_ ? listing_.entries[rows_[*selected_]].path : folder_;
    return;
  }
  if (!selected_) {
    error_ = question_.purpose == BrowseFor::save ? "Type a name for the file."
                                                  : "Choose a file, or type its name.";
    return;
  }
  // By the entry's own bytes: what is shown may be a stand-in for them.
  const FolderEntry& entry = listing_.entries[rows_[*selected_]];
  if (entry.folder) {
    const fs::path folder = entry.path;
    return goTo(folder);
  }
  if (question_.purpose == BrowseFor::save)
    replacing_ = entry.path;
  else
    result_ = entry.path;
}

void FileBrowser::acceptTyped(const fs::path& path) {
  if (isFolder(path)) {
    if (question_.purpose == BrowseFor::folder && field_.back() != '/') {
      result_ = path;
      return;
    }
    field_.clear();
    typed_ = question_.purpose == BrowseFor::save;
    return goTo(path.has_filename() ? path : path.parent_path());
  }
  if (question_.purpose != BrowseFor::save) {
    if (question_.purpose == BrowseFor::open && isThere(path))
      result_ = path;
    else
      error_ = fmt::format("There is no {} {}. Check the spelling.",
                           question_.purpose == BrowseFor::open ? "file" : "folder",
                           shownText(path.native()));
    return;
  }
  fs::path target = path;
  const std::vector<std::string> extensions = view().extensions;
  if (!extensions.empty() &&
      std::find(extensions.begin(), extensions.end(), lowerExtension(target)) == extensions.end())
    target += extensions.front();
  if (!isFolder(target.parent_path()))
    error_ = fmt::format("There is no folder {}. Make it first, or choose another.",
                         shownText(target.parent_path().native()));
  else if (isFolder(target))
    error_ = fmt::format("{} is a folder. Choose another name.", shownText(target.native()));
  else if (isThere(target))
    replacing_ = target;
  else
    result_ = target;
}

void FileBrowser::makeFolder() {
  fs::path folder = folder_ / "New folder";
  for (int number = 2; isThere(folder); ++number)
    folder = folder_ / fmt::format("New folder {}", number);
  // What is typed is its name, when a folder is wanted.
  if (question_.purpose == BrowseFor::folder && typed_ && !field_.empty())
    folder = resolvedPath(field_, folder_);
  std::error_code error;
  if (!fs::create_directory(folder, error)) {
    error_ = fmt::format("The folder {} cannot be made: {}.", shownText(folder.native()),
                         error ? error.message() : "it is there already");
    return;
  }
  selectWhenRead_ = folder;
  goTo(folder_, false);
}

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
  drawPlace("Home", static_cast<int>(Icon::home), homeFolder());
  for (const char* name : {"Desktop", "Documents", "Downloads", "Pictures"})
    if (isFolder(homeFolder() / name))
      drawPlace(name, static_cast<int>(Icon::folder), homeFolder() / name);
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
    const ImVec2 min = ImGui::GetCursorScreenPos();
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
      &field_, ImGuiInputTextFlags_CallbackCompletion | ImGuiInputTextFlags_EnterReturnsTrue,
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
  iconItem(Icon::warning, kWarning, height - px(10));
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  clippedText(fmt::format("{} is there already. Replace it?", name), width - px(260));
  ImGui::SameLine();
  alignRight(px(200) + px(kGap));
  if (textButton("Keep", ButtonKind::normal, Icon::none, px(100), "files.keep") ||
      keyHit(Key::escape)) {
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
  alignRight(2 * button + px(kGap));
  if (textButton("Cancel", ButtonKind::normal, Icon::none, button, "files.cancel")) close_ = true;
  ImGui::SameLine();
  if (textButton(question_.accept.c_str(), ButtonKind::primary, Icon::none, button, "files.accept"))
    accept();
}

void FileBrowser::takeKeys() {
  const ImGuiIO& io = ImGui::GetIO();
  if (replacing_) return;
  // Not when it closes the list of kinds or leaves the field.
  if (keyHit(Key::escape) && ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows) &&
      !io.WantTextInput)
    close_ = true;
  if (io.KeyCtrl && keyHit(Key::h)) {
    showHidden_ = !showHidden_;
    refresh();
  }
  if (io.KeyCtrl && keyHit(Key::l)) focusField_ = true;
  if (io.WantTextInput || ImGui::IsAnyItemActive()) return;
  const std::size_t count = rows_.size();
  const auto step = [&](std::ptrdiff_t by) {
    if (count == 0) return;
    const std::ptrdiff_t from = selected_ ? static_cast<std::ptrdiff_t>(*selected_)
                                : by > 0  ? -1
                                          : 1;
    select(static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(from + by, 0, static_cast<std::ptrdiff_t>(count) - 1)));
  };
  if (keyHit(Key::down, true)) step(1);
  if (keyHit(Key::up, true)) step(-1);
  if (keyHit(Key::pageDown, true)) step(10);
  if (keyHit(Key::pageUp, true)) step(-10);
  if (keyHit(Key::home) && count > 0) select(0);
  if (keyHit(Key::end) && count > 0) select(count - 1);
  if (keyHit(Key::backspace) && folder_.has_relative_path()) {
    selectWhenRead_ = folder_;
    return goTo(folder_.parent_path());
  }
  if (keyHit(Key::enter) || keyHit(Key::numpadEnter)) {
    if (selected_) return activate(*selected_);
    return accept();
  }
  if (io.KeyCtrl || io.KeyAlt || io.InputQueueCharacters.empty()) return;
  if (ImGui::GetTime() - jumpTime_ > kJumpPause) jump_.clear();
  jumpTime_ = ImGui::GetTime();
  for (ImWchar c : io.InputQueueCharacters) {
    char text[5];
    ImTextCharToUtf8(text, c);
    jump_ += text;
  }
  for (std::size_t row = 0; row < count; ++row) {
    const std::string& shown = listing_.entries[rows_[row]].shown;
    if (shown.size() >= jump_.size() && ImStrnicmp(shown.c_str(), jump_.c_str(), jump_.size()) == 0)
      return select(row);
  }
}

std::optional<fs::path> FileBrowser::draw() {
  if (opening_) ImGui::OpenPopup(kName);
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const float margin = 2 * px(kGapLarge);
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize(
      {std::min(px(kWidth), display.x - margin), std::min(px(kHeight), display.y - margin)});
  const scope::Style padding(ImGuiStyleVar_WindowPadding, px(16, 14));
  const scope::Modal modal(kName, nullptr,
                           ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoScrollbar);
  open_ = modal.open;
  opening_ = false;
  if (!modal) return {};
  takeListing();
  // Before the widgets: a field that Escape leaves is still active in that frame.
  if (!busy()) takeKeys();

  drawTop();
  const float bottom = ImGui::GetFrameHeight() + px(kButtonHeight) + 3 * px(kGap);
  {
    const scope::Child middle("##middle", {0, ImGui::GetContentRegionAvail().y - bottom});
    drawPlaces();
    ImGui::SameLine();
    drawEntries();
  }
  {
    const scope::Disabled asking(replacing_.has_value());
    drawField();
  }
  ImGui::Dummy({0, 0});
  drawButtons();

  if (!result_ && !close_) return {};
  close_ = false;
  open_ = false;
  ImGui::CloseCurrentPopup();
  return std::exchange(result_, {});
}

}  // namespace dapple
