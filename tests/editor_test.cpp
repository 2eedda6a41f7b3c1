// The whole window in process: clicks and keys go in, pictures come out.
#include "app/editor/editor.h"

#include <doctest/doctest.h>

#include <filesystem>

#include "io/image_io.h"
#include "tests/gui_harness.h"

using namespace dapple;
namespace fs = std::filesystem;

namespace {

constexpr int kWidth = 1280, kHeight = 800;

struct Desk {
  GuiHarness gui;
  Editor editor;

  explicit Desk(float uiScale = 1, int width = kWidth, int height = kHeight)
      : gui(width, height, uiScale), editor({.assets = DAPPLE_ASSETS, .threads = 2}) {
    gui.setBuild([this, width, height] { editor.frame(width, height); });
    gui.settle();
    REQUIRE(gui.frameUntil([&] { return gui.has("swatch.scales"); }));
  }
  // Until the engine rests and the picture is complete.
  void rest() {
    REQUIRE(gui.frameUntil(
        [&] { return !editor.engine().status().busy && editor.view().complete(); }, 20000));
    gui.frames(3);
  }
  void save(const std::string& name) {
    fs::create_directories(DAPPLE_EDITOR_PICTURES);
    writeImage(fs::path(DAPPLE_EDITOR_PICTURES) / (name + ".png"), gui.picture());
  }
  const Document& document() { return editor.snapshot().document; }
};

}  // namespace

TEST_CASE("from the start screen one click leads to a textured scan") {
  Desk desk;
  desk.save("start");
  desk.gui.click("start.open-sample");
  desk.rest();
  CHECK(desk.document().size() == 29945);
  REQUIRE(desk.document().results.colour);
  CHECK(desk.editor.engine().status().error == "");
  desk.save("sample");
}
