#include "app/gui/file_browser.h"

#include <fmt/format.h>
#include <imgui_internal.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>
#include <utility>

#include "app/gui/keys.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;
using namespace theme;

constexpr const char* kName = "##files";
constexpr float kWidth = 860, kHeight = 560;
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
