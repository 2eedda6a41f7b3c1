// The desktop's own dialog for files, by its portal (org.freedesktop.portal.FileChooser).
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <stop_token>
#include <string>

#include "app/gui/file_browser.h"

namespace dapple {

struct DialogAnswer {
  enum class Kind {
    Chosen,
    Cancelled,
    Absent,  // there is no portal here: nothing to tell
    Failed,  // there is one, and it did not work
  };
  Kind kind = Kind::Absent;
  std::filesystem::path path;  // Chosen
  std::string why;             // Failed: a sentence
};

// A file:// address as a path; nothing for another scheme or a host that is not this one.
std::optional<std::filesystem::path> pathOfUri(const std::string& uri);
// ".ply" in any case: "*.[pP][lL][yY]".
std::string globOf(const std::string& extension);

// Asks by the session's bus and waits for the answer; `parent` is the window, as portals name it
// ("x11:1a", or empty). For a thread of its own. `starting`: how long the dialog may take to come.
DialogAnswer askPortal(const FileQuestion& question, const std::string& parent,
                       std::chrono::milliseconds starting, const std::stop_token& stop);

// One question at a time; never blocks the window.
class DesktopDialog {
 public:
  using Ask = std::function<DialogAnswer(const FileQuestion&, const std::stop_token&)>;
  explicit DesktopDialog(Ask ask) : ask_(std::move(ask)) {}
  ~DesktopDialog();  // closes the dialog

  void open(FileQuestion question);
  bool isOpen() const { return answer_.valid(); }
  const FileQuestion& question() const { return question_; }
  // Once; to be asked every frame, and some times a second while nothing else happens.
  std::optional<DialogAnswer> poll();

 private:
  Ask ask_;
  FileQuestion question_;
  std::stop_source stop_;
  std::future<DialogAnswer> answer_;
};

}  // namespace dapple
