#include "app/editor/settings.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

using namespace dapple;
namespace fs = std::filesystem;

namespace {

struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("dapple_settings_test_{}", ::getpid());
  Folder() { fs::remove_all(path); }
  ~Folder() { fs::remove_all(path); }
};

Settings unusual() {
  Settings settings;
  settings.navigation = "Blender";
  settings.uiScale = 1.5f;
  settings.background = {0.25f, 0.5f, 1};
  settings.shading = Shading::Studio;
  settings.opened("/scans/old.ply");
  settings.opened("/scans/new \xc3\xa4.ply");
  settings.folders["scan"] = "/scans";
  settings.windowWidth = 1000;
  settings.windowHeight = 700;
  settings.hints = {"segment", "swatch"};
  settings.desktopDialogs = false;
  settings.live = settings.texels = false;
  return settings;
}

std::vector<std::string> warningsOf(const std::string& text, Settings* read = nullptr) {
  std::vector<std::string> warnings;
  const Settings settings = settingsFromJson(text, warnings);
  if (read) *read = settings;
  return warnings;
}

}  // namespace

TEST_CASE("settings come back as they were written, in a folder for the user alone") {
  const Folder folder;
  const fs::path inner = folder.path / "a" / "b";
  { SettingsFile(inner).write(unusual()); }
  std::vector<std::string> warnings;
  CHECK(SettingsFile(inner).read(warnings) == unusual());
  CHECK(warnings.empty());
  CHECK(peekSettings(inner) == unusual());
  struct stat status = {};
  REQUIRE(::stat(inner.c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0700);
}

TEST_CASE("keys that are not ours stay in the file, and are told") {
  const Folder folder;
  fs::create_directories(folder.path);
  std::ofstream(folder.path / "settings.json") << R"({"ui_scale": 2, "future": {"a": [1, 2]}})";
  std::vector<std::string> warnings;
  {
    SettingsFile file(folder.path);
    Settings settings = file.read(warnings);
    CHECK(settings.uiScale == 2);
    settings.navigation = "Maya";
    file.write(settings);
  }
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0] == "Settings: there is no \"future\"; it is left alone.");
  const auto root =
      nlohmann::json::parse(*readSmallFile(folder.path / "settings.json"), nullptr, false);
  CHECK(root["future"] == nlohmann::json::parse(R"({"a": [1, 2]})"));
  CHECK(root["navigation"] == "Maya");
}

TEST_CASE("values out of range are clamped, values of the wrong kind are the defaults") {
  Settings read;
  CHECK(warningsOf(R"({"ui_scale": 99, "window": [1, 1e9], "background": [-1, 0.5, 2]})", &read)
            .size() == 5);
  CHECK(read.uiScale == 4);
  CHECK(read.windowWidth == 480);
  CHECK(read.windowHeight == 16384);
  CHECK(read.background == vec3(0, 0.5f, 1));
  const char* wrong = R"({"ui_scale": "big", "window": [1], "background": "red", "light": "sun",
      "navigation": 3, "recent": {}, "folders": [], "hints_dismissed": 1, "desktop_dialogs": 1})";
  CHECK(warningsOf(wrong, &read).size() == 9);
  CHECK(read == Settings());
  CHECK(warningsOf(R"({"ui_scale": 0.1})", &read).empty());
  CHECK(read.uiScale == 0.75f);
}

TEST_CASE("no text ends the program") {
  for (const std::string& text :
       {std::string(), std::string("null"), std::string("[1]"),
        std::string("{\"recent\": [1, {}]}"),
        std::string("{\"a\":") + std::string(200000, '[') + std::string(200000, ']') + "}",
        std::string(300000, '{'), std::string("{\"recent\": [\"\xff\xfe\"]}")}) {
    const Folder folder;
    fs::create_directories(folder.path);
    std::ofstream(folder.path / "settings.json") << text;
    std::vector<std::string> warnings;
    SettingsFile file(folder.path);
    CHECK(file.read(warnings).recent.empty());
    file.write({});
  }
}

TEST_CASE("a damaged file is set aside and told") {
  const Folder folder;
  fs::create_directories(folder.path);
  std::ofstream(folder.path / "settings.json") << R"({"ui_scale": 2, "rec)";
  std::vector<std::string> warnings;
  {
    SettingsFile file(folder.path);
    CHECK(file.read(warnings) == Settings());
  }
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("settings.broken.json") != std::string::npos);
  CHECK_FALSE(fs::exists(folder.path / "settings.json"));
  CHECK(*readSmallFile(folder.path / "settings.broken.json") == R"({"ui_scale": 2, "rec)");
}

TEST_CASE("settings that cannot be written are told and harm nothing") {
  SettingsFile file("/proc/dapple");  // nobody can make that
  file.write(unusual());
  std::optional<std::string> error;
  for (int k = 0; k < 1000 && !error; ++k) {
    error = file.takeError();
    ::usleep(2000);
  }
  REQUIRE(error);
  CHECK(error->starts_with("The settings were not saved."));
}

TEST_CASE("without a folder nothing is read or written") {
  SettingsFile file({});
  std::vector<std::string> warnings;
  CHECK(file.read(warnings) == Settings());
  file.write(unusual());
  CHECK_FALSE(file.takeError());
}

TEST_CASE("the ten files that were opened last are remembered, each once, newest first") {
  Settings settings;
  for (int k = 0; k < 15; ++k) settings.opened(fmt::format("/scans/{}.ply", k));
  settings.opened("/scans/9.ply");
  REQUIRE(settings.recent.size() == kMostRecent);
  CHECK(settings.recent[0] == "/scans/9.ply");
  CHECK(settings.recent[1] == "/scans/14.ply");
  CHECK(settings.recent[9] == "/scans/5.ply");
  settings.opened("/scans/\xff.ply");  // JSON cannot hold it
  CHECK(settings.recent[0] == "/scans/9.ply");
}

TEST_CASE("the folders follow XDG's variables") {
  const auto with = [](const char* name, const char* value, const auto& folder) {
    const char* set = std::getenv(name);
    const std::string before = set ? set : "";
    ::setenv(name, value, 1);
    const fs::path path = folder();
    if (set)
      ::setenv(name, before.c_str(), 1);
    else
      ::unsetenv(name);
    return path;
  };
  CHECK(with("XDG_CONFIG_HOME", "/x/config", userConfigFolder) == "/x/config/dapple");
  CHECK(with("XDG_STATE_HOME", "/x/state", userStateFolder) == "/x/state/dapple");
  if (const char* home = std::getenv("HOME"); home && home[0] == '/') {
    CHECK(with("XDG_CONFIG_HOME", "relative", userConfigFolder) ==
          fs::path(home) / ".config/dapple");
    CHECK(with("XDG_STATE_HOME", "", userStateFolder) == fs::path(home) / ".local/state/dapple");
  }
}
