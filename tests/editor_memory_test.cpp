// What the editor remembers and never loses, with the whole window in process.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>

#include "app/editor/recovery.h"
#include "app/editor/settings.h"
#include "tests/child_process.h"
#include "tests/editor_desk.h"

using namespace dapple;
namespace fs = std::filesystem;

namespace {

constexpr const char* kChildState = "DAPPLE_TEST_CHILD_STATE";

// The user's folders, empty at first.
struct Home {
  fs::path path = fs::temp_directory_path() / fmt::format("dapple_memory_test_{}", ::getpid());
  Home() {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Home() { fs::remove_all(path); }
  fs::path config() const { return path / "config"; }
  fs::path recovery() const { return path / "state" / "recovery"; }
  EditorOptions options() const {
    return {.assets = DAPPLE_ASSETS,
            .threads = 2,
            .live = false,
            .config = config(),
            .state = path / "state",
            .autosaveQuiet = 0.02,
            .autosaveLongest = 0.1};
  }
  // Copies of unsaved work.
  std::size_t copies() const {
    std::size_t count = 0;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(recovery(), error))
      count += entry.path().extension() == ".dapple";
    return count;
  }
  // One of them is of the document as this edit left it.
  bool copied(const std::string& edit) const {
    std::error_code error;
    for (const auto& file : fs::directory_iterator(recovery(), error))
      if (file.path().extension() == ".json" &&
          readSmallFile(file.path()).value_or("").find(edit) != std::string::npos)
        return true;
    return false;
  }
  Settings settings() const { return peekSettings(config()); }
};

struct Session : Desk {
  using Desk::Desk;

  void edit() {  // two steps of the history
    gui.key(letterKey('A'), kCtrl);
    rest();
    gui.key(letterKey('G'), kCtrl);
    rest();
  }
  bool run(const std::string& command) {
    gui.key(letterKey('K'), kCtrl);
    gui.type(command);
    gui.key(Key::enter);
    gui.settle();
    return true;
  }
  // Of the last edit: an earlier one may have been copied before it.
  bool copied(const Home& home) {
    const Snapshot& now = editor.snapshot();
    const std::string edit = (*now.history)[now.cursor];
    return gui.frameUntil([&] { return home.copies() == 1 && home.copied(edit); }, kPatience);
  }
};

fs::path savedProject(const Home& home) {
  const fs::path file = home.path / "work.dapple";
  Session session(home.options());
  session.openScan();
  session.edit();
  session.editor.engine().submit(SaveProject{file.string()});
  session.rest();
  CHECK(session.editor.title() == "work - Dapple");
  return file;
}

}  // namespace

TEST_CASE("habits are kept from one run to the next, unless factory settings are asked for") {
  const Home home;
  {
    Session session(home.options());
    session.run("Blender");
    session.run("studio");
    session.run("white");
    session.run("125 %");
    session.gui.frames(3);
    CHECK(session.gui.gui().uiScale() == 1.25f);
    session.save("scale-125");
  }
  const Settings kept = home.settings();
  CHECK(kept.navigation == "Blender");
  CHECK(kept.shading == Shading::Studio);
  CHECK(kept.background == vec3(1));
  CHECK(kept.uiScale == 1.25f);
  CHECK(kept.windowWidth == kWidth);
  CHECK(kept.windowHeight == kHeight);
  {
    Session session(home.options());
    CHECK(session.gui.gui().uiScale() == 1.25f);
    session.openScan();
    session.save("remembered");
    // Blender's middle button turns, the right one does nothing.
    const ImVec2 view = session.gui.at("view");
    const auto pose = [&] { return session.editor.view().pictureCamera(); };
    const Camera before = pose();
    session.gui.drag(1, view, {view.x + 100, view.y});
    session.rest();
    CHECK(pose() == before);
    session.gui.drag(2, view, {view.x + 100, view.y});
    session.rest();
    CHECK_FALSE(pose() == before);
  }
  {
    EditorOptions factory = home.options();
    factory.config.clear();
    Session session(factory);
    CHECK(session.gui.gui().uiScale() == 1);
    session.run("Maya");
  }
  CHECK(home.settings().navigation == "Blender");
}

TEST_CASE("the user's keys are read, and written with all actions") {
  const Home home;
  fs::create_directories(home.config());
  std::ofstream(home.config() / "keymap.json")
      << R"({"select.all": ["Ctrl+Alt+P"], "no.such": ["A"], "select.invert": "Ctrl+Hyper"})";
  Session session(home.options());
  CHECK(session.gui.has("notice.0"));
  CHECK(session.gui.has("notice.1"));
  session.save("keymap-warnings");
  session.openScan();
  session.gui.key(letterKey('A'), kCtrl);
  session.rest();
  CHECK_FALSE(session.document().selection);
  session.gui.key(letterKey('P'), kCtrl | kAlt);
  session.rest();
  REQUIRE(session.document().selection);
  CHECK(session.document().selection->count() == 29945);
  session.run("Write the keys");
  REQUIRE(session.gui.has("question.yes"));
  session.gui.click("question.yes");
  const std::string text = readSmallFile(home.config() / "keymap.json").value();
  for (const char* part :
       {"\"select.all\": [\n    \"Ctrl+Alt+P\"", "\"select.invert\": [\n    \"Ctrl+I\"",
        "\"file.quit\"", "\"size.300\": []"})
    CHECK_MESSAGE(text.find(part) != std::string::npos, part);
  CHECK(text.find("no.such") == std::string::npos);
  std::ofstream(home.config() / "keymap.json") << R"({"select.none": ["Ctrl+Alt+N"]})";
  session.run("Read the keys");
  session.gui.key(letterKey('N'), kCtrl | kAlt);
  session.rest();
  CHECK((!session.document().selection || session.document().selection->count() == 0));
}

TEST_CASE("what was opened is offered again, newest first, while it exists") {
  const Home home;
  const fs::path project = savedProject(home), gone = home.path / "gone.ply";
  fs::copy_file(asset("scans/creature.ply"), gone);
  {
    Session session(home.options());
    session.gui.drop({gone});
    session.rest();
  }
  CHECK(home.settings().recent ==
        std::vector<std::string>{gone.string(), project.string(), asset("scans/creature.ply")});
  fs::remove(gone);
  Session session(home.options());
  REQUIRE(session.gui.has("start.recent.1"));
  CHECK_FALSE(session.gui.has("start.recent.2"));
  session.save("start-recent");
  session.gui.click("menu.File");
  session.gui.click("menu.File/Open recent");
  session.gui.settle();
  CHECK(session.gui.has("menu-item.recent.1"));
  CHECK_FALSE(session.gui.has("menu-item.recent.2"));
  session.save("menu-recent");
  session.gui.click("menu-item.recent.1");
  session.rest();
  CHECK(session.editor.title() == "creature.ply - Dapple");
  Session other(home.options());
  other.gui.click("start.recent.1");
  other.rest();
  CHECK(other.editor.title() == "work - Dapple");
  CHECK(other.document().regions->size() == 2);
}

TEST_CASE("unsaved work is asked about before it would be lost") {
  const Home home;
  const fs::path project = savedProject(home);
  Session session(home.options());
  session.gui.drop({project});
  session.rest();
  const Document opened = session.document();
  CHECK(session.editor.title() == "work - Dapple");
  session.gui.key(letterKey('A'), kCtrl | kShift);
  session.rest();
  CHECK(session.editor.title() == "\u2022 work - Dapple");
  session.gui.key(letterKey('Z'), kCtrl);
  session.rest();
  CHECK(session.editor.title() == "work - Dapple");  // undone: as it is saved
  session.gui.key(letterKey('Z'), kCtrl | kShift);
  session.rest();

  SUBCASE("cancel goes on") {
    session.gui.drop({asset("scans/creature.ply")});
    session.rest();
    REQUIRE(session.gui.has("question.cancel"));
    session.save("unsaved");
    session.gui.click("question.cancel");
    session.rest();
    CHECK(session.editor.title() == "\u2022 work - Dapple");
    CHECK_FALSE(session.editor.mayClose());
    session.gui.frames(2);
    session.gui.key(Key::escape);
    session.gui.frames(2);
    CHECK_FALSE(session.editor.wantsToClose());
  }
  SUBCASE("do not save opens the other, whose project is not this one") {
    session.gui.drop({asset("scans/creature.ply")});
    session.rest();
    session.gui.click("question.no");
    session.rest();
    CHECK(session.editor.title() == "creature.ply - Dapple");
    // Undo brings the first back, still not saved.
    session.gui.key(letterKey('Z'), kCtrl);
    session.rest();
    CHECK(session.editor.title() == "\u2022 work - Dapple");
  }
  SUBCASE("save saves, then leaves") {
    session.gui.key(letterKey('Q'), kCtrl);
    session.rest();
    CHECK_FALSE(session.editor.wantsToClose());
    session.gui.click("question.yes");
    REQUIRE(session.gui.frameUntil([&] { return session.editor.wantsToClose(); }, kPatience));
    const Document left = session.document();
    Session again(home.options());
    again.gui.drop({project});
    again.rest();
    CHECK(sameContent(again.document(), left));
    CHECK_FALSE(sameContent(again.document(), opened));
  }
  SUBCASE("save that cannot be done does not leave") {
    fs::permissions(project, fs::perms::owner_read);
    fs::remove(project);
    fs::create_directory(project);  // for root, too
    CHECK_FALSE(session.editor.mayClose());
    session.gui.frames(2);
    session.gui.click("question.yes");
    session.rest();
    CHECK(session.gui.has("notice.0"));
    CHECK_FALSE(session.editor.wantsToClose());
    CHECK(session.editor.title() == "\u2022 work - Dapple");
  }
}

TEST_CASE("work that was never saved asks for a name first, and giving that up leaves nothing") {
  const Home home;
  Session session(home.options());
  session.openScan();
  CHECK(session.editor.title() == "creature.ply - Dapple");
  session.edit();
  CHECK(session.editor.title() == "\u2022 creature.ply - Dapple");
  session.gui.key(letterKey('Q'), kCtrl);
  session.gui.settle();
  session.gui.click("question.yes");
  session.gui.settle();
  REQUIRE(session.gui.has("files.cancel"));
  session.gui.click("files.cancel");
  session.rest();
  CHECK_FALSE(session.editor.wantsToClose());
  session.gui.key(letterKey('Q'), kCtrl);
  session.gui.settle();
  session.gui.click("question.yes");
  session.gui.settle();
  const fs::path file = home.path / "named.dapple";
  session.gui.fill("files.field", file.string());
  session.gui.click("files.accept");
  REQUIRE(session.gui.frameUntil([&] { return session.editor.wantsToClose(); }, kPatience));
  CHECK(fs::exists(file));
  // The next dialog of this purpose begins there.
  CHECK(home.settings().folders.at("project") == home.path.string());
}

TEST_CASE("several files that are dropped ask once, and the swatch is for the scan among them") {
  const Home home;
  Session session(home.options());
  session.openScan();
  session.edit();
  session.gui.drop({asset("swatches/wood.png"), asset("scans/creature.ply")});
  session.rest();
  session.gui.click("question.no");
  session.rest();
  CHECK(session.document().regions->size() == 1);
  CHECK(session.document().regions->front().reference.path == asset("swatches/wood.png"));
}

TEST_CASE("the title tells how far the work is") {
  const Home home;
  Session session(home.options());
  session.openScan();
  session.gui.click("hint.none");
  session.gui.click("swatch.bricks");
  session.rest();
  SetRegion slow{kUnassigned};
  slow.options = TextureOptions{.method = Method::Match, .levels = 4, .coherent = false};
  session.editor.engine().submit(slow);
  session.rest();
  session.gui.click("synthesize.all");
  CHECK(session.gui.frameUntil(
      [&] { return session.editor.title().ends_with(" % - \u2022 creature.ply - Dapple"); },
      kPatience));
  session.gui.key(Key::escape);
  session.rest();
  CHECK(session.editor.title() == "\u2022 creature.ply - Dapple");
}

TEST_CASE("a child that works until it is killed" * doctest::skip()) {
  const char* state = std::getenv(kChildState);
  REQUIRE(state);
  EditorOptions options{
      .assets = DAPPLE_ASSETS, .threads = 1, .state = state, .autosaveQuiet = 0.02};
  Session session(options);
  session.openScan();
  session.edit();
  session.gui.frameUntil([] { return false; }, 1 << 20, 20);
}

TEST_CASE("work of a process that was killed is offered at the next start and comes back") {
  const Home home;
  ::setenv(kChildState, (home.path / "state").c_str(), 1);
  ChildProcess child(
      {"/proc/self/exe", "--no-skip", "--test-case=a child that works until it is killed"});
  ::unsetenv(kChildState);
  for (int k = 0; k < 4500 && !home.copied("Add region"); ++k) ::usleep(20000);
  REQUIRE(home.copied("Add region"));
  {
    Session meanwhile(home.options());  // it lives: its work is not ours
    CHECK_FALSE(meanwhile.gui.has("recovery.0.recover"));
  }
  child.kill(SIGKILL);

  Session reference(EditorOptions{.assets = DAPPLE_ASSETS, .threads = 2});
  reference.openScan();
  reference.edit();
  Session session(home.options());
  REQUIRE(session.gui.has("recovery.0.recover"));
  session.save("recovery");
  session.gui.click("recovery.0.recover");
  session.rest();
  CHECK(sameContent(session.document(), reference.document()));
  CHECK(session.editor.title() == "\u2022 creature.ply - Dapple");
  session.save("recovered");
  // Our own copy takes its place; leaving takes it away.
  CHECK(session.copied(home));
  session.gui.frames(5);
  session.gui.key(letterKey('Q'), kCtrl);
  session.gui.settle();
  session.gui.click("question.no");
  CHECK(session.editor.wantsToClose());
}

TEST_CASE(
    "a copy goes when the work is saved, undone or left, and stays when the program breaks off") {
  const Home home;
  const fs::path project = home.path / "work.dapple";
  {
    Session session(home.options());
    session.openScan();
    CHECK(home.copies() == 0);
    session.edit();
    CHECK(session.copied(home));
    session.editor.engine().submit(SaveProject{project.string()});
    CHECK(session.gui.frameUntil([&] { return home.copies() == 0; }, kPatience));
    session.gui.key(letterKey('A'), kCtrl | kShift);
    session.rest();
    CHECK(session.copied(home));
    session.gui.key(letterKey('Z'), kCtrl);
    CHECK(session.gui.frameUntil([&] { return home.copies() == 0; }, kPatience));
    session.gui.key(letterKey('Z'), kCtrl | kShift);
    session.rest();
    CHECK(session.copied(home));
  }
  CHECK(home.copies() == 1);
  {
    Session session(home.options());
    REQUIRE(session.gui.has("recovery.0.discard"));
    session.gui.click("recovery.0.recover");
    session.rest();
    // It is the project's again, and saving it asks no name.
    CHECK(session.editor.title() == "\u2022 work - Dapple");
    session.gui.key(letterKey('S'), kCtrl);
    session.rest();
    CHECK(session.editor.title() == "work - Dapple");
    CHECK(session.gui.frameUntil([&] { return home.copies() == 0; }, kPatience));
    session.edit();
    CHECK(session.copied(home));
  }
  Session session(home.options());
  session.gui.click("recovery.0.discard");
  session.gui.frames(3);
  CHECK_FALSE(session.gui.has("recovery.0.discard"));
  CHECK(home.copies() == 0);
  CHECK(fs::is_empty(home.recovery()));
}

TEST_CASE("a copy whose opening ended the program is set aside, one that only failed is not") {
  const Home home;
  {
    Session session(home.options());
    session.openScan();
    session.edit();
    REQUIRE(session.copied(home));
  }
  std::vector<std::string> notices;
  std::vector<RecoveryEntry> offered = recoverable(home.recovery(), notices);
  REQUIRE(offered.size() == 1);
  const std::string bytes = readSmallFile(offered[0].file, 1 << 26).value();
  std::ofstream(offered[0].file) << "ply\n";
  {
    Session session(home.options());
    session.gui.click("recovery.0.recover");
    session.rest();
    CHECK(session.editor.engine().status().errors == 1);
    CHECK(session.gui.has("recovery.0.recover"));
  }
  std::ofstream(offered[0].file) << bytes;
  offered = recoverable(home.recovery(), notices);
  REQUIRE(offered.size() == 1);
  CHECK(notices.empty());
  markTried(offered[0], true);  // and then nothing more is heard of it
  Session session(home.options());
  CHECK_FALSE(session.gui.has("recovery.0.recover"));
  CHECK(session.gui.has("notice.0"));
  session.save("quarantine");
  CHECK(fs::exists(home.recovery() / "quarantine" / offered[0].file.filename()));
  session.gui.drop({home.recovery() / "quarantine" / offered[0].file.filename()});
  session.rest();
  CHECK(session.document().regions->size() == 2);
}

TEST_CASE("five copies are kept, and debris of killed processes goes") {
  const Home home;
  fs::create_directories(home.recovery());
  for (int k = 0; k < 8; ++k) {
    const std::string id = fmt::format("{}-0000000{}", 100 + k, k);
    std::ofstream(home.recovery() / (id + ".dapple")) << "x";
    std::ofstream(home.recovery() / (id + ".json")) << fmt::format(
        R"({{"time": {}, "label": "Edit", "project": "/p/{}.dapple"}})", 1000 + k, k);
    std::ofstream(home.recovery() / (id + ".lock"));
  }
  std::ofstream(home.recovery() / ".100-00000000.dapple.tmp-100") << "half";
  std::ofstream(home.recovery() / "77-0.lock");
  std::ofstream(home.recovery() / "notes.txt") << "the user's own";
  std::vector<std::string> notices;
  const std::vector<RecoveryEntry> offered = recoverable(home.recovery(), notices);
  REQUIRE(offered.size() == kMostRecoveries);
  CHECK(offered[0].name() == "7.dapple");
  CHECK(offered[4].time == 1003);
  CHECK(home.copies() == 5);
  CHECK_FALSE(fs::exists(home.recovery() / ".100-00000000.dapple.tmp-100"));
  CHECK_FALSE(fs::exists(home.recovery() / "77-0.lock"));
  CHECK_FALSE(fs::exists(home.recovery() / "100-00000000.lock"));
  CHECK(fs::exists(home.recovery() / "notes.txt"));
  CHECK(notices.empty());
}

TEST_CASE("edits without a pause are kept after a while, too, and the newest wins") {
  const Home home;
  EditorOptions options = home.options();
  Session session(options);
  session.openScan();
  Autosave autosave({.folder = home.path / "busy", .quiet = 60, .longest = 0.2});
  std::vector<std::string> notices;
  for (int k = 0; k < 200 && autosave.written() == 0; ++k) {
    autosave.follow({session.document(), "", fmt::format("Edit {}", k)});
    ::usleep(10000);
  }
  CHECK(autosave.written() == 1);
  autosave.forget();
  Autosave calm({.folder = home.path / "calm", .quiet = 0.05, .longest = 60});
  for (int k = 0; k < 5; ++k) calm.follow({session.document(), "", fmt::format("Edit {}", k)});
  for (int k = 0; k < 300 && calm.written() == 0; ++k) ::usleep(10000);
  CHECK(calm.written() == 1);
  CHECK(recoverable(home.path / "calm", notices).empty());  // we live
}

TEST_CASE("a copy that cannot be written is told once") {
  const Home home;
  EditorOptions options = home.options();
  options.state = "/proc/dapple";
  Session session(options);
  session.openScan();
  session.edit();
  CHECK(session.gui.frameUntil([&] { return session.gui.has("notice.0"); }, kPatience));
  session.save("no-recovery");
}

TEST_CASE("four hints are shown one at a time, and never again") {
  const Home home;
  {
    Session session(home.options());
    CHECK_FALSE(session.gui.has("hint.segment"));
    session.openScan();
    for (const char* hint : {"segment", "swatch", "strokes", "synthesize"}) {
      CHECK(session.gui.has(fmt::format("hint.{}", hint)));
      session.save(fmt::format("hint-{}", hint));
      session.gui.click("hint.next");
      session.gui.frames(2);
      CHECK_FALSE(session.gui.has(fmt::format("hint.{}", hint)));
    }
    CHECK_FALSE(session.gui.has("hint.next"));
    // They take no part in the work: nothing was selected by the clicks.
    CHECK_FALSE(session.document().selection);
  }
  Session session(home.options());
  session.openScan();
  CHECK_FALSE(session.gui.has("hint.next"));
  session.run("Show the hints");
  session.gui.frames(2);
  CHECK(session.gui.has("hint.segment"));
  session.gui.click("hint.none");
  session.gui.frames(2);
  CHECK_FALSE(session.gui.has("hint.next"));
}

TEST_CASE("the desktop's dialog is used when it is there, ours when not") {
  const Home home;
  EditorOptions options = home.options();
  struct Played {
    std::mutex mutex;
    DialogAnswer answer;
    std::vector<std::string> asked;
  } played;
  options.askDesktop = [&played](const FileQuestion& question, const std::stop_token&) {
    const std::lock_guard lock(played.mutex);
    played.asked.push_back(question.title + " " + question.folder.string());
    return played.answer;
  };
  const auto play = [&](DialogAnswer answer) {
    const std::lock_guard lock(played.mutex);
    played.answer = std::move(answer);
  };
  Session session(options);
  using Kind = DialogAnswer::Kind;
  play({Kind::Chosen, asset("scans/creature.ply"), {}});
  session.gui.click("start.open-scan");
  session.rest();
  CHECK(session.document().size() == 29945);
  session.edit();
  // What the desktop leaves out is added, and then asked about.
  const fs::path file = home.path / "work.dapple";
  std::ofstream(file) << "older";
  play({Kind::Chosen, home.path / "work", {}});
  session.gui.key(letterKey('S'), kCtrl);
  session.rest();
  REQUIRE(session.gui.has("question.yes"));
  session.gui.click("question.yes");
  session.rest();
  CHECK(session.editor.title() == "work - Dapple");
  CHECK(fs::file_size(file) > 1000);
  play({Kind::Cancelled, {}, {}});
  session.gui.key(letterKey('O'), kCtrl);
  session.rest();
  CHECK_FALSE(session.gui.has("files.field"));
  CHECK(played.asked.back() == "Open scan " + asset("scans"));
  play({Kind::Failed, {}, "It broke."});
  session.gui.key(letterKey('O'), kCtrl);
  session.rest();
  CHECK(session.gui.has("files.field"));
  CHECK(session.gui.has("notice.0"));
  session.save("dialog-failed");
  session.gui.key(Key::escape);
  // Not asked again in this run.
  const std::size_t asked = played.asked.size();
  session.gui.key(letterKey('O'), kCtrl);
  session.rest();
  CHECK(session.gui.has("files.field"));
  CHECK(played.asked.size() == asked);
}
