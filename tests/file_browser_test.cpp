#include "app/gui/file_browser.h"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "gui_harness.h"
#include "gui_pictures.h"

using namespace dapple;
namespace fs = std::filesystem;

namespace {

// A folder that goes with the test.
struct Folder {
  fs::path path;

  Folder() {
    std::string name = (fs::temp_directory_path() / "dapple-files-XXXXXX").string();
    path = mkdtemp(name.data());
  }
  ~Folder() {
    chmod((path / "locked").c_str(), 0700);
    std::error_code error;
    fs::remove_all(path, error);
  }
  void file(const std::string& name, std::size_t bytes = 10, int hoursAgo = 0) const {
    std::ofstream(path / name) << std::string(bytes, 'x');
    fs::last_write_time(path / name,
                        fs::file_time_type::clock::now() - std::chrono::hours(hoursAgo));
  }
};

const std::vector<FileKind> kScans{{"Scans", {".ply", ".obj"}}, {"All files", {}}};

struct Studio {
  Folder folder;
  FileBrowser browser;
  std::optional<fs::path> chosen;
  GuiHarness harness;

  explicit Studio(float scale = 1)
      : harness(static_cast<int>(960 * scale), static_cast<int>(640 * scale), scale, [this] {
          if (const auto path = browser.draw()) chosen = path;
        }) {}
  void open(FileQuestion question) {
    chosen.reset();
    if (question.folder.empty()) question.folder = folder.path;
    browser.open(std::move(question));
    wait();
  }
  void wait() {
    harness.settle();
    REQUIRE(harness.frameUntil([&] { return !browser.busy(); }));
    harness.settle();
  }
  // Names in the order shown, by their place on the screen.
  std::vector<std::string> shown() {
    std::vector<std::pair<float, std::string>> rows;
    for (const auto& [id, mark] : harness.gui().marks().all())
      if (id.starts_with("files.entry.")) rows.push_back({mark.min.y, id.substr(12)});
    std::sort(rows.begin(), rows.end());
    std::vector<std::string> names;
    for (auto& [y, name] : rows) names.push_back(std::move(name));
    return names;
  }
};

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("folders come first, names sort with their numbers, kinds and hidden files filter") {
  Studio studio;
  fs::create_directory(studio.folder.path / "zoo");
  for (const char* name : {"scan10.ply", "scan2.PLY", "Bunny.obj", "photo.png", ".secret.ply"})
    studio.folder.file(name);
  studio.open({.title = "Open scan", .kinds = kScans});
  CHECK(studio.shown() == Names{"zoo", "Bunny.obj", "scan2.PLY", "scan10.ply"});
  studio.harness.click("files.sort.name");
  CHECK(studio.shown() == Names{"zoo", "scan10.ply", "scan2.PLY", "Bunny.obj"});
  studio.harness.click("files.sort.name");
  studio.harness.click("files.hidden");
  CHECK(studio.shown() == Names{"zoo", ".secret.ply", "Bunny.obj", "scan2.PLY", "scan10.ply"});
  studio.harness.click("files.hidden");
  studio.harness.click("files.kind");
  studio.harness.click("files.kind.All files");
  CHECK(studio.shown() == Names{"zoo", "Bunny.obj", "photo.png", "scan2.PLY", "scan10.ply"});
}

TEST_CASE("sorting by size and by date has the largest and the newest where one expects") {
  Studio studio;
  studio.folder.file("a.ply", 5000, 1);
  studio.folder.file("b.ply", 10, 3);
  studio.folder.file("c.ply", 200, 2);
  studio.open({.title = "Open scan", .kinds = kScans});
  studio.harness.click("files.sort.size");
  CHECK(studio.shown() == Names{"b.ply", "c.ply", "a.ply"});
  studio.harness.click("files.sort.size");
  CHECK(studio.shown() == Names{"a.ply", "c.ply", "b.ply"});
  studio.harness.click("files.sort.date");
  CHECK(studio.shown() == Names{"b.ply", "c.ply", "a.ply"});
}

TEST_CASE("a file is opened by double click, by keys, by letters and by its typed path") {
  Studio studio;
  fs::create_directory(studio.folder.path / "in");
  studio.folder.file("in/cat.ply");
  studio.folder.file("in/dog.ply");
  studio.open({.title = "Open scan", .kinds = kScans});
  studio.harness.doubleClick(studio.harness.at("files.entry.in"));
  studio.wait();
  CHECK(studio.shown() == Names{"cat.ply", "dog.ply"});
  studio.harness.doubleClick(studio.harness.at("files.entry.dog.ply"));
  CHECK(studio.chosen == studio.folder.path / "in/dog.ply");
  CHECK_FALSE(studio.browser.isOpen());

  studio.open({.title = "Open scan", .kinds = kScans});
  studio.harness.key(Key::down);
  studio.harness.key(Key::enter);
  studio.wait();
  studio.harness.key(Key::d);
  studio.harness.key(Key::enter);
  CHECK(studio.chosen == studio.folder.path / "in/dog.ply");

  studio.open({.title = "Open scan", .folder = studio.folder.path / "in", .kinds = kScans});
  studio.harness.key(Key::backspace);
  studio.wait();
  CHECK(studio.shown() == Names{"in"});
  studio.harness.fill("files.field", "i");
  studio.harness.key(Key::tab);
  studio.harness.type("c");
  studio.harness.key(Key::tab);
  savePicture(studio.harness, "files-completion");
  studio.harness.key(Key::enter);
  CHECK(studio.chosen == studio.folder.path / "in/cat.ply");

  studio.open({.title = "Open scan", .kinds = kScans});
  studio.harness.fill("files.field", "no-such.ply");
  studio.harness.key(Key::enter);
  CHECK_FALSE(studio.chosen.has_value());
  CHECK(studio.browser.isOpen());
  savePicture(studio.harness, "files-error");
  studio.harness.click("files.cancel");
  CHECK_FALSE(studio.browser.isOpen());
  CHECK_FALSE(studio.chosen.has_value());
  studio.open({.title = "Open scan", .kinds = kScans});
  studio.harness.key(Key::escape);
  CHECK_FALSE(studio.browser.isOpen());
}

TEST_CASE("saving adds the extension and asks before it replaces a file") {
  Studio studio;
  studio.folder.file("old.ply");
  const FileQuestion question{
      .purpose = BrowseFor::save, .title = "Export", .name = "new", .kinds = {{"PLY", {".ply"}}}};
  studio.open(question);
  studio.harness.key(Key::enter);
  CHECK(studio.chosen == studio.folder.path / "new.ply");

  studio.open(question);
  studio.harness.fill("files.field", "old");
  studio.harness.click("files.accept");
  CHECK_FALSE(studio.chosen.has_value());
  savePicture(studio.harness, "files-replace");
  studio.harness.click("files.keep");
  CHECK_FALSE(studio.chosen.has_value());
  studio.harness.click("files.accept");
  studio.harness.click("files.replace");
  CHECK(studio.chosen == studio.folder.path / "old.ply");

  studio.open(question);
  studio.harness.fill("files.field", "nowhere/new");
  studio.harness.click("files.accept");
  CHECK_FALSE(studio.chosen.has_value());
  studio.harness.fill("files.field", "shape.PLY");
  studio.harness.click("files.accept");
  CHECK(studio.chosen == studio.folder.path / "shape.PLY");

  studio.open(question);
  studio.harness.doubleClick(studio.harness.at("files.entry.old.ply"));
  CHECK_FALSE(studio.chosen.has_value());
  studio.harness.click("files.replace");
  CHECK(studio.chosen == studio.folder.path / "old.ply");
}

TEST_CASE("a folder is chosen, a new one is made") {
  Studio studio;
  fs::create_directory(studio.folder.path / "out");
  studio.folder.file("a.ply");
  studio.open({.purpose = BrowseFor::folder, .title = "Choose a folder"});
  CHECK(studio.shown() == Names{"out"});
  studio.harness.click("files.accept");
  CHECK(studio.chosen == studio.folder.path);
  studio.open({.purpose = BrowseFor::folder, .title = "Choose a folder"});
  studio.harness.click("files.entry.out");
  studio.harness.click("files.accept");
  CHECK(studio.chosen == studio.folder.path / "out");
  studio.open({.purpose = BrowseFor::folder, .title = "Choose a folder"});
  studio.harness.click("files.new-folder");
  studio.wait();
  CHECK(studio.shown() == Names{"New folder", "out"});
  CHECK(fs::is_directory(studio.folder.path / "New folder"));
}

TEST_CASE("a folder that cannot be read says so in its place") {
  Studio studio;
  fs::create_directory(studio.folder.path / "locked");
  chmod((studio.folder.path / "locked").c_str(), 0);
  const FolderListing gone = readFolder(studio.folder.path / "gone");
  CHECK(gone.error.find("is not there") != std::string::npos);
  studio.folder.file("a.ply");
  CHECK(readFolder(studio.folder.path / "a.ply").error.find("is no folder") != std::string::npos);
  if (geteuid() == 0) {
    MESSAGE("skipped the locked folder: root may read everything");
    return;
  }
  studio.open({.title = "Open scan"});
  studio.harness.doubleClick(studio.harness.at("files.entry.locked"));
  studio.wait();
  CHECK(studio.shown().empty());
  CHECK(readFolder(studio.folder.path / "locked").error.find("may not be read") !=
        std::string::npos);
  savePicture(studio.harness, "files-locked");
}

TEST_CASE("a name that is no UTF-8 is shown with a stand-in and chosen by its own bytes") {
  Studio studio;
  const std::string name = "caf\xe9.ply";
  studio.folder.file(name);
  studio.open({.title = "Open scan", .kinds = kScans});
  CHECK(studio.shown() == Names{"caf\xef\xbf\xbd.ply"});
  studio.harness.click("files.entry.caf\xef\xbf\xbd.ply");
  studio.harness.click("files.accept");
  REQUIRE(studio.chosen.has_value());
  CHECK(studio.chosen->filename().native() == name);
  CHECK(shownText("ok \xc3\xa4 \xf0\x9f\x90\xb0 \xed\xa0\x80 \xc0\xaf\x01") ==
        "ok \xc3\xa4 \xf0\x9f\x90\xb0 \xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd "
        "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");
}

TEST_CASE("ten thousand files are listed and only those in sight are drawn") {
  Studio studio;
  for (int i = 0; i < 10000; ++i)
    std::ofstream(studio.folder.path / ("scan" + std::to_string(i) + ".ply"));
  studio.open({.title = "Open scan", .kinds = kScans});
  CHECK(studio.shown().size() < 40);
  CHECK(studio.shown().front() == "scan0.ply");
  studio.harness.key(Key::end);
  CHECK(studio.shown().back() == "scan9999.ply");
  const auto start = std::chrono::steady_clock::now();
  studio.harness.frames(100);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  CHECK(taken.count() < 1.0);  // 10 ms a frame at the very most
}

TEST_CASE("sizes and dates are told for people") {
  CHECK(shownSize(999) == "999 B");
  CHECK(shownSize(1000) == "1.0 kB");
  CHECK(shownSize(1234567) == "1.2 MB");
  CHECK(shownSize(999999) == "1.0 MB");
  CHECK(shownSize(123456789) == "123 MB");
  CHECK(shownDate({}).empty());
  CHECK(shownDate(fs::file_time_type::clock::now()).size() == 16);
}

TEST_CASE("the browser looks as it should at scale 1 and 2") {
  for (float scale : {1.0f, 2.0f}) {
    Studio studio(scale);
    fs::create_directory(studio.folder.path / "museum");
    fs::create_directory(studio.folder.path / "swatches");
    studio.folder.file("bunny.ply", 1234567, 5);
    studio.folder.file(
        "a scan with a very long name that does not fit into its column at all, no.ply", 52000, 50);
    studio.folder.file("dragon.obj", 43000000, 900);
    studio.open({.title = "Open scan",
                 .kinds = kScans,
                 .recentFolders = {studio.folder.path / "museum", "/usr/share"}});
    studio.harness.click("files.entry.bunny.ply");
    savePicture(studio.harness, scale == 1 ? "files" : "files@2");
    studio.harness.picture();
  }
}
