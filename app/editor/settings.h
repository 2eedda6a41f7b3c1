// What the editor remembers from one day to the next: settings.json in the user's folder.
#pragma once

#include <filesystem>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/render/splats.h"

namespace dapple {

inline constexpr std::size_t kMostRecent = 10;

struct Settings {
  std::string navigation = "Default";  // of navigationPresets()
  float uiScale = 0;                   // 0: the desktop's
  vec3 background{0.071f, 0.075f, 0.082f};
  Shading shading = Shading::Headlight;
  std::vector<std::string> recent;             // scans and projects, newest first
  std::map<std::string, std::string> folders;  // of the file browser, by purpose
  int windowWidth = 1440, windowHeight = 900;  // logical pixels
  std::set<std::string> hints;                 // coach marks that were dismissed
  bool desktopDialogs = true;
  bool live = true;    // regions are synthesized again after each edit that touches them
  bool texels = true;  // the swatch inside the splats

  // To the front; the oldest beyond kMostRecent go. Not for a name that JSON cannot hold.
  void opened(const std::filesystem::path& file);
  bool operator==(const Settings&) const = default;
};

// $XDG_CONFIG_HOME/dapple, else ~/.config/dapple; $XDG_STATE_HOME/dapple, else
// ~/.local/state/dapple. Empty when there is neither: nothing is kept then.
std::filesystem::path userConfigFolder();
std::filesystem::path userStateFolder();

// Makes the folder with those above it, for the user alone. False: it cannot be.
bool makeUserFolder(const std::filesystem::path& folder);

// Out of range is clamped; of the wrong kind or not known is left at its default. Each is told in
// a warning.
Settings settingsFromJson(const std::string& text, std::vector<std::string>& warnings);

// Those of a folder, or the defaults; nothing is told or set aside.
Settings peekSettings(const std::filesystem::path& folder);

// The file. It belongs to the window's thread, which never waits for the disk but in the end.
class SettingsFile {
 public:
  // An empty folder: nothing is read or written.
  explicit SettingsFile(std::filesystem::path folder) : folder_(std::move(folder)) {}
  ~SettingsFile();
  SettingsFile(const SettingsFile&) = delete;
  SettingsFile& operator=(const SettingsFile&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  // Never throws: a file that is no JSON is set aside (settings.broken.json) and told.
  Settings read(std::vector<std::string>& warnings);
  // Whole or not at all, on another thread. Keys that are not ours stay as they were read.
  void write(const Settings& settings);
  // Why the last writing failed, once.
  std::optional<std::string> takeError();

 private:
  void begin();

  std::filesystem::path folder_;
  std::string others_ = "{}";  // the file as it was read
  std::optional<std::string> next_;
  std::future<std::string> writing_;
};

// The whole of a small text file; nothing when it is not there, cannot be read or has more than
// `most` bytes.
std::optional<std::string> readSmallFile(const std::filesystem::path& path,
                                         std::size_t most = std::size_t{1} << 20);
// Whole or not at all. Throws IoError.
void writeWhole(const std::filesystem::path& path, const std::string& text);

}  // namespace dapple
