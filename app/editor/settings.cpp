#include "app/editor/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/gui/gui_context.h"
#include "app/gui/navigation.h"
#include "io/output_file.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kSmallestWindow = 480, kLargestWindow = 16384;
constexpr int kDeepest = 64;
constexpr std::size_t kMostFolders = 32, kMostHints = 32, kLongestPath = 4096;
constexpr std::pair<const char*, Shading> kLights[] = {
    {"off", Shading::Off}, {"headlight", Shading::Headlight}, {"studio", Shading::Studio}};

fs::path homed(const char* variable, const char* below) {
  // The specification has relative paths ignored.
  if (const char* set = std::getenv(variable); set && set[0] == '/')
    return fs::path(set) / "dapple";
  if (const char* home = std::getenv("HOME"); home && home[0] == '/')
    return fs::path(home) / below / "dapple";
  return {};
}

// Deeper values are left out: writing them again would take a stack as deep.
json parsed(const std::string& text) {
  return json::parse(
      text, [](int depth, json::parse_event_t, json&) { return depth <= kDeepest; }, false);
}

bool canBeJson(const std::string& text) {
  try {
    return !json(text).dump().empty();
  } catch (const json::exception&) {
    return false;
  }
}

// One key after another; what does not fit is told and passed over.
class Reader {
 public:
  Reader(const json& root, std::vector<std::string>& warnings) : root_(root), warnings_(warnings) {}

  const json* find(const char* key, bool (json::*is)() const noexcept, const char* wanted) {
    known_.insert(key);
    const auto found = root_.find(key);
    if (found == root_.end()) return nullptr;
    if (((*found).*is)()) return &*found;
    warn(fmt::format("\"{}\" is to be {}; the default is taken", key, wanted));
    return nullptr;
  }
  double clamped(const char* key, double value, double low, double high) {
    const double within = std::isfinite(value) ? std::clamp(value, low, high) : low;
    if (within != value)
      warn(fmt::format("\"{}\" is {:g}, taken as {:g} (from {:g} to {:g})", key, value, within, low,
                       high));
    return within;
  }
  void number(const char* key, float& value, double low, double high) {
    if (const json* found = find(key, &json::is_number, "a number"))
      value = static_cast<float>(clamped(key, found->get<double>(), low, high));
  }
  void strings(const char* key, std::size_t most, std::vector<std::string>& values) {
    const json* found = find(key, &json::is_array, "a list of texts");
    if (!found) return;
    for (const json& item : *found)
      if (item.is_string() && item.get_ref<const std::string&>().size() <= kLongestPath &&
          values.size() < most)
        values.push_back(item);
  }
  void warn(const std::string& what) { warnings_.push_back("Settings: " + what + "."); }
  void unknown() {
    for (const auto& [key, value] : root_.items())
      if (!known_.contains(key))
        warn(fmt::format("there is no \"{}\"; it is left alone", key.substr(0, 80)));
  }

 private:
  const json& root_;
  std::vector<std::string>& warnings_;
  std::set<std::string> known_;
};

void readBackground(Reader& reader, Settings& settings) {
  const json* found =
      reader.find("background", &json::is_array, "three numbers from 0 to 1: red, green, blue");
  if (!found) return;
  if (found->size() != 3 ||
      !std::all_of(found->begin(), found->end(), [](const json& c) { return c.is_number(); }))
    return reader.warn("\"background\" is to be three numbers from 0 to 1; the default is taken");
  for (int c = 0; c < 3; ++c)
    settings.background[c] = static_cast<float>(
        reader.clamped("background", (*found)[static_cast<std::size_t>(c)].get<double>(), 0, 1));
}

void readWindow(Reader& reader, Settings& settings) {
  const json* found = reader.find("window", &json::is_array, "a width and a height");
  if (!found) return;
  if (found->size() != 2 || !(*found)[0].is_number() || !(*found)[1].is_number())
    return reader.warn("\"window\" is to be a width and a height; the default is taken");
  const auto side = [&](std::size_t k) {
    return static_cast<int>(
        reader.clamped("window", (*found)[k].get<double>(), kSmallestWindow, kLargestWindow));
  };
  settings.windowWidth = side(0), settings.windowHeight = side(1);
}

void readNames(Reader& reader, Settings& settings) {
  if (const json* found = reader.find("navigation", &json::is_string, "a text")) {
    const std::string name = *found;
    settings.navigation = navigationPreset(name).name;
    if (!std::equal(name.begin(), name.end(), settings.navigation.begin(),
                    settings.navigation.end(), [](char a, char b) { return (a | 32) == (b | 32); }))
      reader.warn(fmt::format("there is no navigation \"{}\"; Default is taken", name));
  }
  if (const json* found = reader.find("light", &json::is_string, "a text")) {
    const auto* light = std::find_if(std::begin(kLights), std::end(kLights),
                                     [&](const auto& each) { return *found == each.first; });
    if (light == std::end(kLights))
      reader.warn("\"light\" is none of off, headlight and studio; the default is taken");
    else
      settings.shading = light->second;
  }
  if (const json* found = reader.find("folders", &json::is_object, "folders by purpose"))
    for (const auto& [purpose, folder] : found->items())
      if (folder.is_string() && settings.folders.size() < kMostFolders)
        settings.folders[purpose] = folder;
}

std::string toJson(const Settings& settings, const std::string& others) {
  json root = parsed(others);
  if (!root.is_object()) root = json::object();
  const auto* light = std::find_if(std::begin(kLights), std::end(kLights), [&](const auto& each) {
    return each.second == settings.shading;
  });
  root["navigation"] = settings.navigation;
  root["ui_scale"] = settings.uiScale;
  root["background"] = {settings.background.r, settings.background.g, settings.background.b};
  root["light"] = light == std::end(kLights) ? "headlight" : light->first;
  root["recent"] = settings.recent;
  root["folders"] = settings.folders;
  root["window"] = {settings.windowWidth, settings.windowHeight};
  root["hints_dismissed"] = settings.hints;
  root["desktop_dialogs"] = settings.desktopDialogs;
  root["live"] = settings.live;
  root["texels"] = settings.texels;
  return root.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string writeIn(const fs::path& folder, const std::string& text) {
  try {
    makeUserFolder(folder);
    writeWhole(folder / "settings.json", text);
    return {};
  } catch (const std::exception& error) {
    return fmt::format("The settings were not saved. {}", error.what());
  }
}

}  // namespace

fs::path userConfigFolder() {
  return homed("XDG_CONFIG_HOME", ".config");
}

fs::path userStateFolder() {
  return homed("XDG_STATE_HOME", ".local/state");
}

bool makeUserFolder(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return true;
  if (folder.has_parent_path() && folder.parent_path() != folder)
    makeUserFolder(folder.parent_path());
  if (fs::create_directory(folder, error))
    fs::permissions(folder, fs::perms::owner_all, fs::perm_options::replace, error);
  return fs::is_directory(folder, error);
}

std::optional<std::string> readSmallFile(const fs::path& path, std::size_t most) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};
  std::ifstream file(path, std::ios::binary);
  if (!file) return {};
  std::string text(most + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) return {};
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > most) return {};
  return text;
}

void writeWhole(const fs::path& path, const std::string& text) {
  OutputFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

void Settings::opened(const fs::path& file) {
  const std::string name = file.string();
  if (!canBeJson(name)) return;
  std::erase(recent, name);
  recent.insert(recent.begin(), name);
  if (recent.size() > kMostRecent) recent.resize(kMostRecent);
}

Settings settingsFromJson(const std::string& text, std::vector<std::string>& warnings) {
  Settings settings;
  const json root = parsed(text);
  if (!root.is_object()) {
    warnings.push_back("Settings: the file holds no JSON object; the defaults are taken.");
    return settings;
  }
  Reader reader(root, warnings);
  readNames(reader, settings);
  readBackground(reader, settings);
  readWindow(reader, settings);
  reader.number("ui_scale", settings.uiScale, 0, kMaxUiScale);
  if (settings.uiScale > 0) settings.uiScale = std::max(settings.uiScale, kMinUiScale);
  reader.strings("recent", kMostRecent, settings.recent);
  std::vector<std::string> hints;
  reader.strings("hints_dismissed", kMostHints, hints);
  settings.hints.insert(hints.begin(), hints.end());
  if (const json* found = reader.find("desktop_dialogs", &json::is_boolean, "true or false"))
    settings.desktopDialogs = *found;
  if (const json* found = reader.find("live", &json::is_boolean, "true or false"))
    settings.live = *found;
  if (const json* found = reader.find("texels", &json::is_boolean, "true or false"))
    settings.texels = *found;
  reader.unknown();
  return settings;
}

Settings peekSettings(const fs::path& folder) {
  std::vector<std::string> ignored;
  const auto text = folder.empty() ? std::nullopt : readSmallFile(folder / "settings.json");
  return text ? settingsFromJson(*text, ignored) : Settings();
}

SettingsFile::~SettingsFile() {
  if (writing_.valid()) writing_.wait();
  if (next_) writeIn(folder_, *next_);
}

Settings SettingsFile::read(std::vector<std::string>& warnings) {
  const fs::path path = folder_ / "settings.json";
  std::error_code error;
  if (folder_.empty() || !fs::exists(path, error)) return {};
  const std::optional<std::string> text = readSmallFile(path);
  if (text && parsed(*text).is_object()) {
    others_ = *text;
    return settingsFromJson(*text, warnings);
  }
  const fs::path aside = folder_ / "settings.broken.json";
  fs::rename(path, aside, error);
  warnings.push_back(
      error ? fmt::format("The settings cannot be read, and the defaults are taken: {}",
                          path.string())
            : fmt::format(
                  "The settings were damaged and are set aside as {}; the defaults are taken.",
                  aside.string()));
  return {};
}

void SettingsFile::write(const Settings& settings) {
  if (folder_.empty()) return;
  next_ = toJson(settings, others_);
  if (!writing_.valid()) begin();
}

void SettingsFile::begin() {
  writing_ = std::async(std::launch::async, writeIn, folder_, *std::exchange(next_, {}));
}

std::optional<std::string> SettingsFile::takeError() {
  if (!writing_.valid() || writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return {};
  const std::string error = writing_.get();
  if (next_) begin();
  if (error.empty()) return {};
  return error;
}

}  // namespace dapple
