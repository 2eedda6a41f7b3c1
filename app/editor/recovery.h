// Work that was not saved, kept for the case that the program or the machine stops: a project file
// a process beside a small JSON, in the folder "recovery" of the user's state.
#pragma once

#include <condition_variable>
#include <ctime>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "document/document.h"

namespace dapple {

struct RecoveryEntry {
  std::filesystem::path file;  // a project
  std::string project;         // where it was saved before; empty: never
  std::string scan;
  std::string label;     // of the last edit
  std::time_t time = 0;  // of the copy
  int tried = 0;         // openings that were begun and never ended

  std::string name() const;  // of the project, else of the scan
};

// Copies of processes that are no longer alive, newest first. One whose opening never ended is
// moved to "quarantine" and told in a notice; of more than kMostRecoveries the oldest are deleted.
inline constexpr std::size_t kMostRecoveries = 5;
std::vector<RecoveryEntry> recoverable(const std::filesystem::path& folder,
                                       std::vector<std::string>& notices);
// To be called before it is opened (true), and after it was or could not be (false).
void markTried(const RecoveryEntry& entry, bool tried);
void discardRecovery(const RecoveryEntry& entry);

struct AutosaveOptions {
  std::filesystem::path folder;  // empty: nothing is kept
  double quiet = 5;              // seconds after the last edit
  double longest = 120;          // seconds after the first one that is not kept
};

// Keeps the copy of this process on a thread of its own, with low priority: the window gives it
// documents, which are values, and never waits but for the end of a write in the destructor. Files
// stay behind unless forget() was the last call.
class Autosave {
 public:
  explicit Autosave(AutosaveOptions options);
  ~Autosave();
  Autosave(const Autosave&) = delete;
  Autosave& operator=(const Autosave&) = delete;

  struct Work {
    Document document;  // with a scan
    std::string project, label;
  };
  void follow(Work work);
  // All is saved: there is nothing to keep.
  void forget();

  std::size_t written() const;  // copies so far
  // Why the last copy could not be written, once.
  std::optional<std::string> takeError();

 private:
  using Clock = std::chrono::steady_clock;
  void serve(const std::stop_token& stop);
  std::string write(const Work& work);
  bool lock();
  void remove();

  const AutosaveOptions options_;
  std::filesystem::path base_;  // without extension
  int lock_ = -1;               // descriptor; others see by it that this process lives

  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::optional<Work> work_;
  std::optional<std::stop_source> writing_;
  bool remove_ = false;
  Clock::time_point changed_, waiting_;
  std::size_t written_ = 0;
  std::string error_, told_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace dapple
