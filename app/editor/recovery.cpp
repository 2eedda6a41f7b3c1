#include "app/editor/recovery.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "app/editor/settings.h"
#include "base/errors.h"
#include "document/project_io.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kNice = 10;  // of the thread: the window and the engine come first
constexpr const char* kQuarantine = "quarantine";

fs::path with(const fs::path& base, const char* extension) {
  return fs::path(base.string() + extension);
}

fs::path baseOf(const RecoveryEntry& entry) {
  return entry.file.parent_path() / entry.file.stem();
}

void removeFiles(const fs::path& base) {
  std::error_code ignored;
  for (const char* extension : {".dapple", ".json", ".lock"})
    fs::remove(with(base, extension), ignored);
}

// The kernel lets go of a lock when its process ends, however it ends; a number of a process could
// be another's by now.
bool alive(const fs::path& base) {
  const int descriptor = ::open(with(base, ".lock").c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool held = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0;
  ::close(descriptor);
  return held;
}

std::string textOf(const json& root, const char* key) {
  const auto found = root.find(key);
  return found != root.end() && found->is_string() ? found->get<std::string>() : std::string();
}

json readNote(const fs::path& base) {
  const auto text = readSmallFile(with(base, ".json"));
  json root = text ? json::parse(*text, nullptr, false) : json();
  return root.is_object() ? root : json::object();
}

void writeNote(const fs::path& base, const json& root) {
  writeWhole(with(base, ".json"), root.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

RecoveryEntry readEntry(const fs::path& file) {
  RecoveryEntry entry{.file = file};
  const json root = readNote(baseOf(entry));
  entry.project = textOf(root, "project");
  entry.scan = textOf(root, "scan");
  entry.label = textOf(root, "label");
  if (root.contains("time") && root["time"].is_number_integer()) entry.time = root["time"];
  struct stat status = {};
  if (entry.time <= 0 && ::stat(file.c_str(), &status) == 0) entry.time = status.st_mtime;
  if (root.contains("tried") && root["tried"].is_number_integer()) entry.tried = root["tried"];
  return entry;
}

// What killed processes left behind: half a file, a lock without a copy.
void removeDebris(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> debris;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const std::size_t dot = name.find('.', 1);
    if (dot == std::string::npos) continue;
    const fs::path base = folder / name.substr(name[0] == '.' ? 1 : 0, dot - (name[0] == '.'));
    const bool half = name[0] == '.' && name.find(".tmp-") != std::string::npos;
    const bool lone = name.ends_with(".lock") || name.ends_with(".json");
    if ((half || (lone && !fs::exists(with(base, ".dapple"), error))) && !alive(base))
      debris.push_back(it->path());
  }
  for (const fs::path& path : debris) fs::remove(path, error);
}

std::vector<RecoveryEntry> entriesIn(const fs::path& folder) {
  std::vector<RecoveryEntry> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".dapple" && it->path().filename().string()[0] != '.')
      entries.push_back(readEntry(it->path()));
  std::sort(entries.begin(), entries.end(), [](const RecoveryEntry& a, const RecoveryEntry& b) {
    return a.time != b.time ? a.time > b.time : a.file < b.file;
  });
  return entries;
}

void keepNewest(std::vector<RecoveryEntry>& entries) {
  for (std::size_t k = kMostRecoveries; k < entries.size(); ++k) discardRecovery(entries[k]);
  if (entries.size() > kMostRecoveries) entries.resize(kMostRecoveries);
}

// The file stays for whoever wants to look into it, but is not offered again.
std::string quarantine(const RecoveryEntry& entry) {
  const fs::path folder = entry.file.parent_path() / kQuarantine;
  std::error_code error;
  makeUserFolder(folder);
  for (const char* extension : {".dapple", ".json"})
    fs::rename(with(baseOf(entry), extension), folder / (entry.file.stem().string() + extension),
               error);
  removeFiles(baseOf(entry));
  std::vector<RecoveryEntry> there = entriesIn(folder);
  keepNewest(there);
  return fmt::format("The unsaved work of {} did not open the last time. It is set aside as {}.",
                     entry.name(), (folder / entry.file.filename()).string());
}

}  // namespace

std::string RecoveryEntry::name() const {
  const std::string& from = project.empty() ? scan : project;
  return from.empty() ? "an unnamed project" : fs::path(from).filename().string();
}

std::vector<RecoveryEntry> recoverable(const fs::path& folder, std::vector<std::string>& notices) {
  std::vector<RecoveryEntry> entries;
  if (folder.empty()) return entries;
  removeDebris(folder);
  for (RecoveryEntry& entry : entriesIn(folder)) {
    if (alive(baseOf(entry))) continue;
    if (entry.tried > 0)
      notices.push_back(quarantine(entry));
    else
      entries.push_back(std::move(entry));
  }
  keepNewest(entries);
  return entries;
}

void markTried(const RecoveryEntry& entry, bool tried) {
  const fs::path base = baseOf(entry);
  json root = readNote(base);
  root["tried"] = tried ? entry.tried + 1 : 0;
  if (!root.contains("time")) root["time"] = entry.time;
  try {
    writeNote(base, root);
  } catch (const IoError&) {
    // A full disk must not keep the user from the work.
  }
}

void discardRecovery(const RecoveryEntry& entry) {
  removeFiles(baseOf(entry));
}

Autosave::Autosave(AutosaveOptions options) : options_(std::move(options)) {
  if (options_.folder.empty()) return;
  std::random_device random;
  base_ = options_.folder / fmt::format("{}-{:08x}", ::getpid(), random());
  thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
}

Autosave::~Autosave() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    work_.reset();
    if (writing_) writing_->request_stop();
  }
  thread_.request_stop();
  thread_.join();
  if (lock_ >= 0) ::close(lock_);
}

void Autosave::follow(Work work) {
  if (options_.folder.empty()) return;
  std::optional<Work> old;  // may be the last to hold large columns: let go outside the mutex
  {
    const std::lock_guard lock(mutex_);
    changed_ = Clock::now();
    if (!work_) waiting_ = changed_;
    old = std::exchange(work_, std::move(work));
  }
  wake_.notify_all();
}

void Autosave::forget() {
  std::optional<Work> old;
  {
    const std::lock_guard lock(mutex_);
    old = std::exchange(work_, {});
    remove_ = true;
    if (writing_) writing_->request_stop();
  }
  wake_.notify_all();
}

std::size_t Autosave::written() const {
  const std::lock_guard lock(mutex_);
  return written_;
}

std::optional<std::string> Autosave::takeError() {
  const std::lock_guard lock(mutex_);
  if (error_.empty() || error_ == told_) return {};
  return told_ = error_;
}

bool Autosave::lock() {
  if (lock_ >= 0) return true;
  if (!makeUserFolder(options_.folder)) return false;
  struct stat status = {};
  // Again when another process that was clearing up removed it in between.
  while (status.st_nlink == 0) {
    if (lock_ >= 0) ::close(lock_);
    lock_ = ::open(with(base_, ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (lock_ < 0 || ::flock(lock_, LOCK_EX) != 0 || ::fstat(lock_, &status) != 0) break;
  }
  return lock_ >= 0;
}

void Autosave::remove() {
  removeFiles(base_);
  if (lock_ >= 0) ::close(lock_);
  lock_ = -1;
}

std::string Autosave::write(const Work& work) {
  try {
    if (!lock())
      throw IoError(options_.folder.string(), "", "the folder cannot be made or written",
                    "Check its permissions and the space on the disk");
    std::stop_token stop;
    {
      const std::lock_guard guard(mutex_);
      stop = writing_->get_token();
    }
    Workers one(1);
    Monitor monitor(one, stop);
    saveProject(work.document, with(base_, ".dapple"), monitor);
    ::chmod(with(base_, ".dapple").c_str(), 0600);
    writeNote(base_, {{"project", work.project},
                      {"scan", work.document.scan->path},
                      {"label", work.label},
                      {"time", std::time(nullptr)},
                      {"tried", 0}});
    return {};
  } catch (const Cancelled&) {
    return {};
  } catch (const std::exception& error) {
    return fmt::format("Unsaved work cannot be kept for a recovery. {}", error.what());
  }
}

void Autosave::serve(const std::stop_token& stop) {
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice);
  const auto seconds = [](double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  };
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, stop, [&] { return remove_ || work_; });
    if (remove_) {
      remove_ = false;
      remove();
      continue;
    }
    if (stop.stop_requested()) return;
    const auto due =
        std::min(changed_ + seconds(options_.quiet), waiting_ + seconds(options_.longest));
    if (Clock::now() < due) {
      wake_.wait_until(lock, stop, due, [&] { return remove_ || !work_; });
      continue;
    }
    std::optional<Work> now = std::exchange(work_, {});
    writing_.emplace();
    lock.unlock();
    std::string error = write(*now);
    now.reset();
    lock.lock();
    written_ += error.empty() && !writing_->stop_requested() ? 1 : 0;
    writing_.reset();
    error_ = std::move(error);
  }
}

}  // namespace dapple
