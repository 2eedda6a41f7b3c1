// The editor in process, with hands: what its tests share.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "app/editor/editor.h"
#include "io/image_io.h"
#include "tests/gui_harness.h"

namespace dapple {

inline constexpr int kWidth = 1280, kHeight = 800;
inline constexpr int kPatience = 20000;  // frames

inline std::string asset(const std::string& name) {
  return fmt::format("{}/{}", DAPPLE_ASSETS, name);
}

struct Desk {
  GuiHarness gui;
  Editor editor;

  // Not live: what is synthesized is asked for.
  explicit Desk(float uiScale = 1, int width = kWidth, int height = kHeight, bool live = false)
      : Desk({.assets = DAPPLE_ASSETS, .threads = 2, .live = live}, uiScale, width, height) {}
  explicit Desk(EditorOptions options, float uiScale = 1, int width = kWidth, int height = kHeight)
      : gui(width, height, uiScale), editor(std::move(options)) {
    gui.setBuild([this, width, height] { editor.frame(width, height); });
    gui.settle();
    REQUIRE(
        gui.frameUntil([&] { return gui.has("swatch.scales") && !editor.waiting(); }, kPatience));
    gui.frames(3);
  }
  // Until the engine rests and the picture is complete.
  void rest() {
    gui.settle();
    gui.frames(2);
    REQUIRE(gui.frameUntil(
        [&] {
          return !editor.engine().status().busy && !editor.waiting() &&
                 editor.engine().snapshot().get() == &editor.snapshot() && editor.view().complete();
        },
        kPatience));
    gui.frames(3);
  }
  void openScan() {
    gui.drop({asset("scans/creature.ply")});
    rest();
    REQUIRE(document().size() == 29945);
  }
  // Over the body, from left to right.
  void brushBody(unsigned modifiers = 0) {
    const ImVec2 view = gui.at("view");
    gui.drag(0, {view.x - 120, view.y}, {view.x + 60, view.y - 20}, 8, modifiers);
    rest();
  }
  std::size_t selected() { return document().selection ? document().selection->count() : 0; }
  Image save(const std::string& name) {
    std::filesystem::create_directories(DAPPLE_EDITOR_PICTURES);
    Image picture = gui.picture();
    writeImage(std::filesystem::path(DAPPLE_EDITOR_PICTURES) / (name + ".png"), picture);
    return picture;
  }
  const Document& document() { return editor.snapshot().document; }
};

}  // namespace dapple
