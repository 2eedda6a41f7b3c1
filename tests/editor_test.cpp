// The whole window in process: clicks and keys go in, pictures come out.
#include <cstdlib>
#include <fstream>

#include "app/render/image_compare.h"
#include "base/hash_rng.h"
#include "tests/editor_desk.h"

using namespace dapple;
namespace fs = std::filesystem;

TEST_CASE("from the start screen one click leads to a textured scan") {
  Desk desk;
  desk.save("start");
  desk.gui.click("start.open-sample");
  desk.rest();
  CHECK(desk.document().size() == 29945);
  REQUIRE(desk.document().results.colour);
  CHECK(desk.editor.engine().status().errors == 0);
  CHECK_FALSE(desk.gui.has("start.open-sample"));
  desk.save("sample");
}

TEST_CASE("a part is brushed, made a region and textured; all of it is undone and redone") {
  Desk desk;
  desk.openScan();
  const Document first = desk.document();
  desk.brushBody();
  const std::size_t brushed = desk.selected();
  CHECK(brushed > 700);
  CHECK(brushed < 1500);
  desk.save("brushed");
  desk.gui.key(letterKey('G'), kCtrl);
  desk.rest();
  REQUIRE(desk.document().regions->size() == 2);
  const RegionId region = desk.document().regions->back().id;
  CHECK(pointsOf(desk.document(), region).size() == brushed);
  desk.gui.click(fmt::format("region.row.{}", region));
  desk.gui.click("swatch.pebbles");
  desk.rest();
  desk.gui.key(Key::enter, kCtrl);
  desk.rest();
  REQUIRE(desk.document().results.source);
  const auto& source = *desk.document().results.source;
  CHECK(source.size() -
            static_cast<std::size_t>(std::count(source.begin(), source.end(), kNoSource)) ==
        brushed);
  desk.gui.key(letterKey('A'), kCtrl | kShift);
  desk.rest();
  desk.save("region");
  const Document last = desk.document();
  const std::size_t steps = desk.editor.snapshot().cursor;
  for (std::size_t k = 0; k < steps; ++k) desk.gui.key(letterKey('Z'), kCtrl);
  desk.rest();
  CHECK(desk.editor.snapshot().cursor == 0);
  for (std::size_t k = 0; k < steps; ++k) desk.gui.key(letterKey('Z'), kCtrl | kShift);
  desk.rest();
  CHECK(sameContent(desk.document(), last));
  desk.gui.click("panel.swatch");  // folded: the history comes into sight
  desk.gui.click("panel.synthesis");
  desk.gui.click("history.1");
  desk.rest();
  CHECK(sameContent(desk.document(), first));
}

TEST_CASE("a selection made from the front leaves the back alone, through takes it too") {
  Desk desk;
  desk.openScan();
  const ImVec2 view = desk.gui.at("view");
  desk.gui.key(letterKey('R'));
  const auto rectangle = [&](unsigned modifiers) {
    desk.gui.drag(0, {view.x - 150, view.y - 60}, {view.x + 150, view.y + 60}, 6, modifiers);
    desk.rest();
    return desk.selected();
  };
  const std::size_t seen = rectangle(0);
  desk.gui.key(letterKey('X'));
  const std::size_t all = rectangle(0);
  CHECK(all > seen * 3 / 2);
  // Taking away what is seen leaves what is behind.
  desk.gui.key(letterKey('X'));
  CHECK(rectangle(kCtrl) == all - seen);
  CHECK(rectangle(kShift) == all);
}

TEST_CASE("a hidden region is neither seen nor selected") {
  Desk desk;
  desk.openScan();
  const Image whole = desk.save("whole");
  desk.brushBody();
  const std::size_t brushed = desk.selected();
  desk.gui.key(letterKey('G'), kCtrl);
  desk.rest();
  desk.gui.click("region.visible.1");
  desk.rest();
  REQUIRE_FALSE(desk.document().regions->back().visible);
  desk.save("hidden");
  const ImVec2 view = desk.gui.at("view");
  desk.gui.key(letterKey('R'));
  desk.gui.key(letterKey('X'));
  desk.gui.drag(0, {view.x - 450, view.y + 350}, {view.x + 450, view.y - 350});
  desk.rest();
  CHECK(desk.selected() == 29945 - brushed);
  desk.gui.click("region.visible.1");
  desk.gui.key(letterKey('A'), kCtrl | kShift);
  desk.gui.click("region.row.0");
  desk.rest();
  CHECK(desk.document().regions->back().visible);
}

TEST_CASE("Escape leaves a synthesis, and the scan is as before") {
  Desk desk;
  desk.openScan();
  desk.gui.click("swatch.bricks");
  desk.rest();
  SetRegion slow{kUnassigned};  // seconds, so that Escape does not come too late
  slow.options = TextureOptions{.method = Method::Match, .levels = 4, .coherent = false};
  desk.editor.engine().submit(slow);
  desk.rest();
  const Document before = desk.document();
  desk.gui.click("synthesize.all");
  REQUIRE(desk.gui.frameUntil([&] { return desk.gui.has("progress.cancel"); }, kPatience));
  desk.save("working");
  desk.gui.key(Key::escape);
  desk.rest();
  CHECK(sameContent(desk.document(), before));
}

TEST_CASE("files that are dropped are opened, and what cannot be is told") {
  Desk desk;
  desk.openScan();
  desk.gui.drop({asset("swatches/wood.png")});
  desk.rest();
  CHECK(desk.document().regions->front().reference.path == asset("swatches/wood.png"));
  const Document before = desk.document();
  const fs::path bad = fs::temp_directory_path() / "dapple_editor_test_bad.ply";
  std::ofstream(bad) << "ply\nformat ascii 1.0\nelement vertex 3\n";
  desk.gui.drop({bad});
  desk.rest();
  desk.gui.click("question.no");  // the swatch is not saved
  desk.rest();
  CHECK(desk.editor.engine().status().errors == 1);
  CHECK(desk.gui.has("notice.0"));
  CHECK(sameContent(desk.document(), before));
  desk.save("refused");
  fs::remove(bad);
}

TEST_CASE("a saved project opens as the same document") {
  Desk desk;
  desk.gui.click("start.open-sample");
  desk.rest();
  desk.brushBody();
  desk.gui.key(letterKey('G'), kCtrl);
  desk.rest();
  const Document saved = desk.document();
  const fs::path file = fs::temp_directory_path() / "dapple_editor_test.dapple";
  fs::remove(file);
  desk.gui.key(letterKey('S'), kCtrl);
  desk.gui.settle();
  REQUIRE(desk.gui.has("files.field"));
  desk.gui.fill("files.field", file.string());
  desk.gui.click("files.accept");
  desk.rest();
  REQUIRE(fs::exists(file));
  Desk other;
  other.gui.drop({file});
  other.rest();
  CHECK(sameContent(other.document(), saved));
  fs::remove(file);
}

TEST_CASE("the right button turns, the wheel comes nearer, F shows all again") {
  Desk desk;
  desk.openScan();
  const Image front = desk.save("front");
  const ImVec2 view = desk.gui.at("view");
  desk.gui.drag(1, view, {view.x + 200, view.y + 40});
  desk.rest();
  CHECK(desk.save("turned").pixels != front.pixels);
  CHECK(desk.selected() == 0);
  desk.gui.wheel(5);
  desk.rest();
  desk.save("near");
  desk.gui.key(Key::numpad1);
  desk.gui.key(letterKey('F'));
  desk.gui.moveMouse({view.x - 300, view.y - 300});
  desk.rest();
  CHECK(desk.save("again").pixels == front.pixels);
}

TEST_CASE("OpenGL draws the same picture, the same tools work on it") {
  Desk desk;
  desk.gui.click("start.open-sample");
  desk.rest();
  const Image processor = desk.save("processor");
  desk.gui.key(letterKey('K'), kCtrl);
  desk.gui.type("OpenGL");
  desk.gui.key(Key::enter);
  desk.rest();
  REQUIRE(desk.editor.view().drawnByOpenGl());
  CHECK(structuralSimilarity(processor, desk.save("opengl")) > 0.98);
  desk.brushBody();
  CHECK(desk.selected() > 700);
}

TEST_CASE("undoing what was typed before the search was emptied does no harm") {
  Desk desk;
  for (int k = 0; k < 4; ++k) {
    desk.gui.key(letterKey('K'), kCtrl);
    desk.gui.type("frame");
    desk.gui.key(Key::backspace);
    desk.gui.key(letterKey('Z'), kCtrl);
    desk.gui.key(Key::escape);
    desk.gui.key(letterKey('K'), kCtrl);
    desk.gui.key(letterKey('Y'), kCtrl);
    desk.gui.key(letterKey('Z'), kCtrl | kShift);
    desk.gui.key(Key::escape);
  }
  // And the search still finds: a rectangle takes more of the scan than a brush would.
  desk.openScan();
  desk.gui.key(letterKey('K'), kCtrl);
  desk.gui.type("Rectangle");
  desk.gui.key(Key::enter);
  const ImVec2 view = desk.gui.at("view");
  desk.gui.drag(0, {view.x - 450, view.y + 350}, {view.x + 450, view.y - 350});
  desk.rest();
  CHECK(desk.selected() > 10000);
}

TEST_CASE("at twice the scale everything is twice as large and nothing overflows") {
  Desk desk(2, 2 * kWidth, 2 * kHeight);
  desk.gui.click("start.open-sample");
  desk.rest();
  CHECK(desk.document().results.colour);
  desk.save("double");
  Desk usual;
  usual.openScan();
  for (const char* id : {"synthesize.all", "view", "tool.brush", "swatch.wood", "region.row.0"}) {
    CAPTURE(id);
    const ItemMark* large = desk.gui.gui().marks().find(id);
    const ItemMark* small = usual.gui.gui().marks().find(id);
    REQUIRE(large);
    REQUIRE(small);
    CHECK(large->max.x - large->min.x ==
          doctest::Approx(2 * (small->max.x - small->min.x)).epsilon(0.03));
    CHECK(large->max.x <= 2 * kWidth);
    CHECK(large->max.y <= 2 * kHeight);
  }
}

TEST_CASE("whatever is pressed, nothing breaks") {
  // DAPPLE_MONKEY=100000 for a long walk; DAPPLE_MONKEY_SEED=2 for another one.
  const char* asked = std::getenv("DAPPLE_MONKEY");
  const char* other = std::getenv("DAPPLE_MONKEY_SEED");
  const int events = asked ? std::atoi(asked) : 1500;
  const int seed = 20261122 + (other ? std::atoi(other) : 0);
  Desk desk;
  // A copy: what is pressed may save, beside the scan.
  const std::filesystem::path folder = DAPPLE_EDITOR_PICTURES, scan = folder / "monkey.ply";
  std::filesystem::create_directories(folder);
  std::filesystem::copy_file(asset("scans/creature.ply"), scan,
                             std::filesystem::copy_options::overwrite_existing);
  desk.gui.drop({scan});
  desk.rest();
  constexpr Key kKeys[] = {Key::escape, Key::enter,     Key::backspace, Key::tab, Key::del,
                           Key::space,  Key::numpad1,   Key::numpad5,   Key::up,  Key::down,
                           Key::home,   Key::numpadAdd, Key::f1,        Key::f3};
  const auto random = [seed](int event, unsigned what, unsigned below) {
    return hashBelow(below, static_cast<std::uint64_t>(seed),
                     static_cast<std::uint64_t>(event) * 16 + what);
  };
  for (int e = 0; e < events; ++e) {
    if (asked && e % 1000 == 0) fmt::print(stderr, "event {}\n", e);
    const ImVec2 at(static_cast<float>(random(e, 1, kWidth)),
                    static_cast<float>(random(e, 2, kHeight)));
    const unsigned modifiers = random(e, 3, 3) == 0 ? random(e, 4, 8) : 0;
    const int button = static_cast<int>(random(e, 5, 3));
    switch (random(e, 6, 8)) {
      case 0:
      case 1:
        desk.gui.click(at, button, modifiers);
        break;
      case 2:
        desk.gui.drag(
            button, at,
            {static_cast<float>(random(e, 7, kWidth)), static_cast<float>(random(e, 8, kHeight))},
            3, modifiers);
        break;
      case 3:
        desk.gui.wheel(static_cast<float>(random(e, 9, 7)) - 3, modifiers);
        break;
      case 4:
        // Not Ctrl+Q, S, O, E: they leave the program or write files.
        desk.gui.key(letterKey(static_cast<char>('A' + random(e, 10, 26))),
                     modifiers & ~static_cast<unsigned>(kCtrl));
        break;
      case 5:
        desk.gui.key(kKeys[random(e, 11, std::size(kKeys))], modifiers);
        break;
      case 6:
        desk.gui.key(letterKey("ZYAIGK"[random(e, 12, 6)]), kCtrl | (modifiers & kShift));
        break;
      default:
        desk.gui.moveMouse(at);
    }
  }
  desk.editor.engine().cancel();
  desk.gui.frames(5);
  CHECK(desk.document().size() == 29945);
}
