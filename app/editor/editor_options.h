// What an editor is started with.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "app/gui/desktop_dialog.h"

namespace dapple {

struct EditorOptions {
  std::filesystem::path assets;  // swatches/ and scans/
  unsigned threads = 0;          // of the engine; 0: one a processor
  std::optional<bool> live;      // Engine::setLive(); else as the user's settings say
  std::function<void()> wake;    // the engine has something new: called from its threads
  // Folders of the user's settings and of unsaved work; empty: nothing is read or written.
  std::filesystem::path config, state;
  float desktopScale = 1;                           // of the user interface, unless it is set
  double autosaveQuiet = 5, autosaveLongest = 120;  // seconds: after the last and the first edit
  // The desktop's dialog for files (askPortal()); empty: our own.
  std::function<DialogAnswer(const FileQuestion&, const std::stop_token&)> askDesktop;
};

}  // namespace dapple
