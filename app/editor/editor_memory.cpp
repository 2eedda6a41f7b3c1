// What the editor remembers: settings, keys, habits, recent files, and the folders of its dialogs.
#include "app/editor/editor_memory.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>

#include "app/editor/coach_marks.h"
#include "app/gui/gui_context.h"
#include "app/gui/keymap.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr int kScales[] = {75, 100, 125, 150, 175, 200, 250, 300};  // per cent

std::vector<RecentFile> existing(const std::vector<std::string>& names) {
  std::vector<RecentFile> files;
  struct stat status = {};
  for (const std::string& name : names)
    if (::stat(name.c_str(), &status) == 0 && S_ISREG(status.st_mode))
      files.push_back({name, status.st_mtime});
  return files;
}

fs::path below(const fs::path& folder, const char* name) {
  return folder.empty() ? fs::path() : folder / name;
}

}  // namespace

Editor::Memory::Memory(Editor& whose)
    : editor(whose),
      settingsFile(whose.options_.config),
      dialog(whose.options_.askDesktop),
      autosave({.folder = below(whose.options_.state, "recovery"),
                .quiet = whose.options_.autosaveQuiet,
                .longest = whose.options_.autosaveLongest}) {}

void Editor::Memory::recall() {
  std::vector<std::string> warnings;
  settings = settingsFile.read(warnings);
  saved = settings;
  offered = recoverable(below(editor.options_.state, "recovery"), warnings);
  for (const std::string& warning : warnings) editor.notices_.warn(warning);
  editor.settings_.background = settings.background;
  editor.settings_.shading = settings.shading;
  editor.settings_.texels = settings.texels;
  editor.setLive(editor.options_.live.value_or(settings.live));
  if (settings.uiScale > 0) GuiContext::current().setUiScale(settings.uiScale);
  editor.navigation_ = &navigationPreset(settings.navigation);
  readKeys();
  lookForRecent();
}

void Editor::Memory::remember(float width, float height) {
  followFile();
  followRecovery();
  answeredByDesktop();
  questions.draw();
  if (editor.hasScan() && !editor.options_.config.empty() && !editor.browser_.isOpen() &&
      !editor.search_.isOpen() && !editor.sheet_.isOpen() && !isAsking())
    drawCoachMark(settings.hints);
  lookForRecent();
  settings.background = editor.settings_.background;
  settings.shading = editor.settings_.shading;
  settings.texels = editor.settings_.texels;
  if (!editor.options_.live) settings.live = editor.live_;
  settings.navigation = editor.navigation_->name;
  if (settings != saved) settingsFile.write(saved = settings);
  if (const auto error = settingsFile.takeError()) editor.notices_.warn(*error);
  // The size goes with the next change, or in the end: not with every step of a drag.
  windowWidth = static_cast<int>(std::lround(width / editor.options_.desktopScale));
  windowHeight = static_cast<int>(std::lround(height / editor.options_.desktopScale));
}

void Editor::Memory::readKeys() {
  editor.actions_.resetShortcuts();
  applyKeymap(editor.actions_, editor.navigation_->keymap);
  if (editor.options_.config.empty()) return;
  if (const auto text = readSmallFile(editor.options_.config / "keymap.json"))
    for (const std::string& warning : applyKeymap(editor.actions_, *text))
      editor.notices_.warn(warning);
}

void Editor::Memory::writeKeys() {
  const fs::path path = editor.options_.config / "keymap.json";
  const auto write = [this, path] {
    try {
      makeUserFolder(editor.options_.config);
      writeWhole(path, keymapJson(editor.actions_, true));
      editor.notices_.good(fmt::format(
          "The keys are in {}. Edit it, then Help > Read the keys again.", path.string()));
    } catch (const std::exception& error) {
      editor.notices_.error(error.what());
    }
  };
  std::error_code error;
  if (!fs::exists(path, error)) return write();
  questions.ask({.title = "Replace your keys?",
                 .text = fmt::format("{} is there. All actions with the keys that they "
                                     "have now would be written over it.",
                                     path.string()),
                 .yes = "Replace",
                 .danger = true,
                 .answered = [write](Answer answer) {
                   if (answer == Answer::yes) write();
                 }});
}

void Editor::Memory::setNavigation(std::string_view name) {
  editor.navigation_ = &navigationPreset(name);
  readKeys();
}

void Editor::Memory::setUiScale(float scale) {
  settings.uiScale = scale;
  GuiContext::current().setUiScale(scale > 0 ? scale : editor.options_.desktopScale);
}

// Each has a folder of its own.
const char* Editor::Memory::purposeOf(Asking asking) {
  switch (asking) {
    case Asking::Scan:
      return "scan";
    case Asking::Swatch:
    case Asking::Swatches:
    case Asking::Map:
      return "swatch";
    case Asking::Export:
      return "export";
    default:
      return "project";
  }
}

void Editor::Memory::show(FileQuestion question) {
  std::error_code error;
  const auto folder = settings.folders.find(purposeOf(editor.asking_));
  if (folder != settings.folders.end() && fs::is_directory(folder->second, error))
    question.folder = folder->second;
  const Document& document = editor.snapshot_->document;
  if (editor.asking_ == Asking::SaveProject && document.scan) {
    const fs::path from = editor.project_.empty() ? document.scan->path : editor.project_;
    question.name = from.stem().string();
    if (question.folder.empty()) question.folder = from.parent_path();
  }
  for (const RecentFile& file : recent)
    if (auto& folders = question.recentFolders;
        std::find(folders.begin(), folders.end(), file.path.parent_path()) == folders.end())
      folders.push_back(file.path.parent_path());
  if (editor.options_.askDesktop && settings.desktopDialogs && !dialogFailed)
    dialog.open(std::move(question));
  else
    editor.browser_.open(std::move(question));
}

void Editor::Memory::noteAnswer(const fs::path& path) {
  Settings with;
  with.opened(path.parent_path());  // what JSON cannot hold is not remembered
  if (!with.recent.empty())
    settings.folders[purposeOf(editor.asking_)] = path.parent_path().string();
}

void Editor::Memory::answeredByDesktop() {
  using Kind = DialogAnswer::Kind;
  const std::optional<DialogAnswer> answer = dialog.poll();
  if (!answer || answer->kind == Kind::Cancelled) return;
  if (answer->kind != Kind::Chosen) {
    dialogFailed = true;
    if (answer->kind == Kind::Failed)
      editor.notices_.warn(answer->why + " Dapple's own dialog is used instead.");
    editor.browser_.open(dialog.question());
    return;
  }
  const FileQuestion& question = dialog.question();
  fs::path path = answer->path;
  const std::string extension =
      question.purpose == BrowseFor::save ? question.kinds.front().extensions.front() : "";
  if (path.extension() == extension || extension.empty()) return editor.answered(path);
  // The desktop has asked about the name without its extension only.
  path += extension;
  std::error_code error;
  if (!fs::exists(path, error)) return editor.answered(path);
  questions.ask({.title = fmt::format("Replace {}?", path.filename().string()),
                 .text = fmt::format("It is there in {}.", path.parent_path().string()),
                 .yes = "Replace",
                 .danger = true,
                 .answered = [this, path](Answer yes) {
                   if (yes == Answer::yes) editor.answered(path);
                 }});
}

// A folder on a sleeping disk or server takes its time: looked at on another thread.
void Editor::Memory::lookForRecent() {
  if (looking.valid() && looking.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    recent = looking.get();
    for (std::size_t k = 0; k < kMostRecent; ++k)
      editor.actions_.setLabel(fmt::format("recent.{}", k),
                               k < recent.size()
                                   ? fmt::format("{}   ({})", recent[k].path.filename().string(),
                                                 recent[k].path.parent_path().filename().string())
                                   : std::string());
  }
  if (looking.valid() || settings.recent == lookedFor) return;
  lookedFor = settings.recent;
  looking = std::async(std::launch::async, existing, lookedFor);
}

void Editor::Memory::openRecent(std::size_t place) {
  if (place < recent.size()) editor.open(recent[place].path);
}

void Editor::Memory::addRecentActions() {
  for (std::size_t k = 0; k < kMostRecent; ++k)
    editor.actions_.add({.id = fmt::format("recent.{}", k),
                         .label = "",
                         .menu = "File/Open recent",
                         .run = [this, k] { openRecent(k); }});
  editor.actions_.add({.id = "recent.forget",
                       .label = "Forget these",
                       .menu = "File/Open recent",
                       .separatorBefore = true,
                       .enabled = [this] { return !settings.recent.empty(); },
                       .run = [this] { settings.recent.clear(); }});
  editor.actions_.add({.id = "file.recover",
                       .label = "Recover unsaved work",
                       .menu = "File",
                       .help = "The newest copy of work that was not saved when Dapple stopped.",
                       .icon = Icon::reset,
                       .enabled = [this] { return !offered.empty(); },
                       .run = [this] { recover(offered.front()); }});
}

void Editor::Memory::addHabitActions() {
  for (const NavigationPreset& preset : navigationPresets())
    editor.actions_.add({.id = fmt::format("navigation.{}", preset.name),
                         .label = std::string(preset.name),
                         .menu = "View/Navigation",
                         .help = std::string(preset.help),
                         .checked = [this, &preset] { return editor.navigation_ == &preset; },
                         .run = [this, &preset] { setNavigation(preset.name); }});
  const auto addScale = [this](const std::string& name, const std::string& label, float scale) {
    editor.actions_.add({.id = "size." + name,
                         .label = label,
                         .menu = "View/Size of the interface",
                         .checked = [this, scale] { return settings.uiScale == scale; },
                         .run = [this, scale] { setUiScale(scale); }});
  };
  addScale("desktop", "As the desktop", 0);
  for (const int percent : kScales)
    addScale(fmt::format("{}", percent), fmt::format("{} %", percent), percent / 100.f);
  editor.actions_.add({.id = "dialogs.desktop",
                       .label = "The desktop's file dialog",
                       .menu = "View",
                       .help = "Off: Dapple's own.",
                       .checked = [this] { return settings.desktopDialogs; },
                       .run =
                           [this] {
                             bool& on = settings.desktopDialogs;
                             on = !on;
                             dialogFailed = false;
                           }});
  const auto kept = [this] { return !editor.options_.config.empty(); };
  editor.actions_.add({.id = "keys.write",
                       .label = "Write the keys to a file",
                       .menu = "Help",
                       .help = "All actions with their keys, to be edited.",
                       .separatorBefore = true,
                       .enabled = kept,
                       .run = [this] { writeKeys(); }});
  editor.actions_.add({.id = "keys.read",
                       .label = "Read the keys again",
                       .menu = "Help",
                       .enabled = kept,
                       .run = [this] { readKeys(); }});
  editor.actions_.add({.id = "help.hints",
                       .label = "Show the hints again",
                       .menu = "Help",
                       .enabled = [this] { return !settings.hints.empty(); },
                       .run = [this] { settings.hints.clear(); }});
}

}  // namespace dapple
