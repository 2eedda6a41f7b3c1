// What an editor keeps beyond one run, and what it must not lose.
#pragma once

#include <future>

#include "app/editor/editor.h"
#include "app/editor/known_files.h"
#include "app/editor/recovery.h"
#include "app/editor/settings.h"
#include "app/gui/desktop_dialog.h"

namespace dapple {

struct RecentFile {
  std::filesystem::path path;
  std::time_t time = 0;  // of its last change
};

// Belongs to the window's thread.
struct Editor::Memory {
  explicit Memory(Editor& whose);

  // editor_memory.cpp
  void recall();                             // when the actions are there
  void remember(float width, float height);  // once a frame, after the widgets; pixels
  void addRecentActions();
  void addHabitActions();
  void readKeys();
  void writeKeys();
  void setNavigation(std::string_view name);
  void setUiScale(float scale);  // 0: the desktop's
  static const char* purposeOf(Asking asking);
  void show(FileQuestion question);  // by the desktop's dialog or ours
  void noteAnswer(const std::filesystem::path& path);
  void answeredByDesktop();
  void lookForRecent();
  void openRecent(std::size_t place);

  // editor_memory_views.cpp
  float startListsHeight() const;  // pixels
  void startLists();
  std::vector<ShortcutSheet::Extra> gestures() const;

  // editor_unsaved.cpp
  bool unsaved() const;  // of the frame's snapshot
  bool unsavedWork(const Document& document) const { return knownFiles.unsaved(document); }
  bool isAsking() const;                     // a question or the desktop's dialog is open
  void guarded(std::function<void()> then);  // at once, or when the user has said so
  // What is dropped on the window, on this region if on any.
  void openAll(const std::vector<std::filesystem::path>& paths, std::optional<RegionId> under);
  void followFile();
  void followRecovery();
  void recover(const RecoveryEntry& entry);
  void leave();

  Editor& editor;
  SettingsFile settingsFile;
  Settings settings, saved;  // as they are, and as the file has them or will soon
  int windowWidth = 0, windowHeight = 0;
  Questions questions;
  DesktopDialog dialog;
  bool dialogFailed = false;  // in this run: not asked again

  KnownFiles knownFiles;
  std::shared_ptr<const DocumentFile> seen;  // by knownFiles
  std::function<void()> afterSave;           // what waits for the work to be saved

  Autosave autosave;
  DocumentIdentity followed;  // by autosave
  bool followedClean = true;
  std::vector<RecoveryEntry> offered;  // at the start
  std::optional<RecoveryEntry> recovering;
  std::vector<RecoveryEntry> recovered;  // open here now; gone once there is a copy of our own

  std::vector<RecentFile> recent;  // those of settings.recent that exist
  std::future<std::vector<RecentFile>> looking;
  std::vector<std::string> lookedFor;
};

}  // namespace dapple
