#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "app/gui/action_views.h"
#include "app/gui/actions.h"
#include "app/gui/keymap.h"
#include "app/gui/navigation.h"
#include "app/gui/notices.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"
#include "base/errors.h"
#include "gui_harness.h"
#include "gui_pictures.h"

using namespace dapple;

namespace {

struct Runs {
  int undo = 0, redo = 0, smaller = 0, brush = 0, help = 0;
  bool canRedo = true;
};

ActionTable sampleTable(Runs& runs) {
  ActionTable table;
  table.add({.id = "file.open",
             .label = "Open...",
             .menu = "File",
             .shortcuts = shortcuts("Ctrl+O"),
             .help = "A scan, a swatch or a project.",
             .icon = Icon::folder,
             .run = [] {}});
  table.add({.id = "edit.undo",
             .label = "Undo",
             .menu = "Edit",
             .shortcuts = shortcuts("Ctrl+Z"),
             .help = "Takes back the last edit.",
             .icon = Icon::undo,
             .repeats = true,
             .run = [&] { ++runs.undo; }});
  table.add({.id = "edit.redo",
             .label = "Redo",
             .menu = "Edit",
             .shortcuts = shortcuts("Ctrl+Shift+Z, Ctrl+Y"),
             .icon = Icon::redo,
             .enabled = [&] { return runs.canRedo; },
             .run = [&] { ++runs.redo; }});
  table.add({.id = "select.grow",
             .label = "Grow selection",
             .menu = "Edit/Selection",
             .icon = Icon::grow,
             .run = [] {}});
  table.add({.id = "tool.brush",
             .label = "Brush",
             .menu = "Tools",
             .shortcuts = shortcuts("B"),
             .icon = Icon::brush,
             .checked = [] { return true; },
             .run = [&] { ++runs.brush; }});
  table.add({.id = "brush.smaller",
             .label = "Smaller brush",
             .menu = "Tools",
             .shortcuts = shortcuts("["),
             .repeats = true,
             .run = [&] { ++runs.smaller; }});
  table.add({.id = "view.top",
             .label = "From above",
             .menu = "View",
             .shortcuts = shortcuts("Numpad 7"),
             .icon = Icon::camera,
             .separatorBefore = true,
             .run = [] {}});
  table.add({.id = "help.overlay",
             .label = "What is here",
             .menu = "Help",
             .shortcuts = shortcuts("?"),
             .run = [&] { ++runs.help; }});
  return table;
}

}  // namespace

TEST_CASE("shortcuts are read as people write them and printed so that they are read again") {
  for (const char* text :
       {"Ctrl+Shift+Z", "B", "[", "?", "F1", "F12", "Numpad 1", "Numpad +", "Page Up",
        "Ctrl+Alt+Del", "Ctrl+,", "+", "Space", "Alt+Left", "Ctrl+Numpad Enter", "Super+K"}) {
    INFO(text);
    const auto shortcut = parseShortcut(text);
    REQUIRE(shortcut);
    CHECK(parseShortcut(toString(*shortcut)) == shortcut);
  }
  CHECK(toString(*parseShortcut(" shift + ctrl+z ")) == "Ctrl+Shift+Z");
  CHECK(toString(*parseShortcut("pgup")) == "Page Up");
  CHECK(toString(*parseShortcut("Shift+?")) == "?");
  for (const char* text :
       {"", "Ctrl+", "Hyper+Z", "F13", "F0", "F01", "Ctrl+?", "ZZ", "Ctrl", "é"}) {
    INFO(text);
    CHECK_FALSE(parseShortcut(text).has_value());
  }
  CHECK_THROWS_AS(shortcuts("Ctrl+Z, nonsense"), Bug);
  CHECK(shortcuts("Ctrl+Z,Ctrl+Y").size() == 2);
}

TEST_CASE("a key runs its action with exactly its modifiers, and none while text is typed") {
  Runs runs;
  ActionTable table = sampleTable(runs);
  std::string text;
  GuiHarness harness(400, 300, 1, [&] {
    table.dispatch();
    const scope::Window window("Window");
    ImGui::SetNextItemWidth(100);
    searchField("field", "Search", text, 100);
  });
  harness.settle();
  harness.key(Key::z, kCtrl);
  CHECK(runs.undo == 1);
  harness.key(Key::z, kCtrl | kShift);
  harness.key(Key::y, kCtrl);
  CHECK(runs.undo == 1);
  CHECK(runs.redo == 2);
  runs.canRedo = false;
  harness.key(Key::y, kCtrl);
  CHECK(runs.redo == 2);
  harness.key(Key::z);
  harness.key(Key::z, kAlt);
  CHECK(runs.undo == 1);
  harness.key(Key::b);
  CHECK(runs.brush == 1);
  harness.key(Key::leftBracket);
  CHECK(runs.smaller == 1);
  harness.key(Key::slash, kShift);
  CHECK(runs.help == 1);

  harness.click("field");
  harness.key(Key::b);
  harness.key(Key::leftBracket);
  CHECK(text == "b[");
  CHECK(runs.brush == 1);
  CHECK(runs.smaller == 1);
  harness.key(Key::escape);
  harness.key(Key::b);
  CHECK(runs.brush == 2);
}

TEST_CASE("a held key runs only those actions again that say so") {
  Runs runs;
  ActionTable table = sampleTable(runs);
  GuiHarness harness(200, 200, 1, [&] { table.dispatch(); });
  harness.settle();
  harness.keyDown(Key::b);
  harness.frames(60);
  harness.keyUp(Key::b);
  CHECK(runs.brush == 1);
  harness.keyDown(Key::z, kCtrl);
  harness.frames(60);
  harness.keyUp(Key::z, kCtrl);
  CHECK(runs.undo > 5);
}

TEST_CASE("keys pressed and released between two frames are all seen") {
  Runs runs;
  ActionTable table = sampleTable(runs);
  std::string text;
  GuiHarness harness(400, 300, 1, [&] {
    table.dispatch();
    const scope::Window window("Window");
    searchField("field", "", text, 100);
  });
  harness.settle();
  InputQueue& input = harness.gui().input();
  for (int i = 0; i < 3; ++i) {
    input.push(KeyChanged{Key::b, true});
    input.push(CharacterTyped{'b'});
    input.push(KeyChanged{Key::b, false});
  }
  harness.settle();
  CHECK(runs.brush == 3);
  const ImVec2 at = harness.at("field");
  input.push(MouseMoved{at.x, at.y});
  input.push(MouseButtonChanged{0, true});
  input.push(MouseButtonChanged{0, false});
  input.pushText("Bär");
  harness.settle();
  CHECK(text == "Bär");
}

TEST_CASE("losing the focus releases every key and button") {
  GuiHarness harness(200, 200);
  harness.settle();
  harness.keyDown(Key::z, kCtrl);
  harness.press(1);
  harness.gui().input().push(FocusChanged{false});
  harness.settle();
  CHECK_FALSE(ImGui::GetIO().KeyCtrl);
  CHECK_FALSE(ImGui::IsAnyMouseDown());
}

TEST_CASE("a keymap changes keys, keeps what it does not name and warns of what it cannot use") {
  Runs runs;
  ActionTable table = sampleTable(runs);
  const auto warnings = applyKeymap(table, R"({
    "edit.undo": ["Alt+Backspace", "F9"], "tool.brush": "Ctrl+O", "edit.redo": [],
    "no.such": ["X"], "view.top": ["Hyper+X"], "brush.smaller": 7})");
  CHECK(table.keysOf("edit.undo") == "Alt+Backspace");
  CHECK(table.shortcutsOf("edit.undo").size() == 2);
  CHECK(table.shortcutsOf("edit.redo").empty());
  CHECK(table.keysOf("view.top") == "Numpad 7");
  CHECK(table.keysOf("brush.smaller") == "[");
  REQUIRE(warnings.size() == 4);
  const auto warned = [&](const char* part) {
    return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& text) {
      return text.find(part) != std::string::npos;
    });
  };
  CHECK(warned("no.such"));
  CHECK(warned("Hyper+X"));
  CHECK(warned("brush.smaller"));
  CHECK(warned("share a key"));

  ActionTable again = sampleTable(runs);
  CHECK(applyKeymap(again, keymapJson(table)).size() == 1);  // the shared key
  CHECK(keymapJson(again) == keymapJson(table));
  CHECK(keymapJson(again, true) == keymapJson(table, true));
  table.resetShortcuts();
  CHECK(keymapJson(table) == "{}\n");
  CHECK(applyKeymap(table, "[1, 2").size() == 1);
  CHECK(table.keysOf("edit.undo") == "Ctrl+Z");
}

TEST_CASE("navigation presets say what a button does with exactly its modifiers") {
  const NavigationPreset& usual = navigationPreset("Default");
  CHECK(motionOf(usual, 1, kNoModifiers) == CameraMotion::orbit);
  CHECK(motionOf(usual, 0, kAlt) == CameraMotion::orbit);
  CHECK(motionOf(usual, 0, kNoModifiers) == std::nullopt);
  CHECK(motionOf(navigationPreset("blender"), 2, kShift) == CameraMotion::pan);
  CHECK(gesturesOf(navigationPreset("Maya"), CameraMotion::zoom) ==
        std::vector<std::string>{"Alt+RMB"});
  CHECK(&navigationPreset("no such") == &usual);
  for (const NavigationPreset& preset : navigationPresets()) {
    INFO(preset.name);
    CHECK(motionOf(preset, 0, kNoModifiers) == std::nullopt);  // the tool's
    for (CameraMotion motion : {CameraMotion::orbit, CameraMotion::pan})
      CHECK_FALSE(gesturesOf(preset, motion).empty());
  }
}

TEST_CASE("commands are found by letters in order, the most fitting first, then the last used") {
  Runs runs;
  ActionTable table = sampleTable(runs);
  CHECK(searchActions(table, "undo").front() == "edit.undo");
  CHECK(searchActions(table, "gs").front() == "select.grow");
  CHECK(searchActions(table, "SMALL br").front() == "brush.smaller");
  CHECK(searchActions(table, "xyz").empty());
  CHECK(searchActions(table, "").front() == "file.open");
  table.run("view.top");
  CHECK(searchActions(table, "").front() == "view.top");
  CHECK(fuzzyScore("br", "Brush") > fuzzyScore("br", "Timber"));
  CHECK(fuzzyScore("hsurb", "Brush") == 0);
}

TEST_CASE("the command search runs what one types, arrows choose, Escape leaves") {
  Runs runs;
  ActionTable table = sampleTable(runs);
  CommandSearch search;
  table.add({.id = "help.commands",
             .label = "Search commands",
             .menu = "Help",
             .shortcuts = shortcuts("Ctrl+K, F3"),
             .run = [&] { search.open(); }});
  GuiHarness harness(900, 640, 1, [&] {
    table.dispatch(search.isOpen());
    search.draw(table);
  });
  harness.settle();
  harness.key(Key::k, kCtrl);
  CHECK(search.isOpen());
  harness.type("do");
  savePicture(harness, "commands");
  REQUIRE(harness.has("command.edit.undo"));
  harness.key(Key::down);
  harness.key(Key::enter);
  CHECK_FALSE(search.isOpen());
  CHECK(runs.undo + runs.redo == 1);
  harness.key(Key::f3);
  harness.type("bru");
  harness.click("command.tool.brush");
  CHECK(runs.brush == 1);
  CHECK_FALSE(search.isOpen());
  harness.key(Key::f3);
  CHECK(search.isOpen());
  harness.key(Key::escape);
  if (search.isOpen()) harness.key(Key::escape);
  CHECK_FALSE(search.isOpen());
}

TEST_CASE("the F1 sheet shows every key and can be searched") {
  Runs runs;
  ActionTable table = sampleTable(runs);
  ShortcutSheet sheet;
  table.add({.id = "help.keys",
             .label = "Shortcuts",
             .menu = "Help",
             .shortcuts = shortcuts("F1"),
             .run = [&] { sheet.open(); }});
  std::vector<ShortcutSheet::Extra> extras;
  for (const std::string& keys : gesturesOf(navigationPreset("Default"), CameraMotion::orbit))
    extras.push_back({"View", keys, "Orbit"});
  GuiHarness harness(1000, 700, 1, [&] {
    table.dispatch(sheet.isOpen());
    sheet.draw(table, extras);
  });
  harness.settle();
  harness.key(Key::f1);
  CHECK(sheet.isOpen());
  savePicture(harness, "sheet");
  const Image all = harness.picture();
  harness.type("redo");
  CHECK(harness.picture().pixels != all.pixels);
  harness.click("shortcuts.close");
  CHECK_FALSE(sheet.isOpen());
  harness.key(Key::f1);
  CHECK(sheet.isOpen());
  harness.click(ImVec2(5, 5));
  CHECK_FALSE(sheet.isOpen());
}

TEST_CASE("menus are drawn from the table and run its actions") {
  Runs runs;
  ActionTable table = sampleTable(runs);
  GuiHarness harness(600, 400, 1, [&] {
    const scope::MainMenuBar bar;
    actionMenus(table);
  });
  harness.settle();
  harness.click("menu.Edit");
  harness.click("menu-item.edit.undo");
  CHECK(runs.undo == 1);
  runs.canRedo = false;
  harness.click("menu.Edit");
  REQUIRE(harness.has("menu-item.edit.redo"));
  harness.moveMouse(harness.at("menu.Edit/Selection"));
  harness.frames(30);
  CHECK(harness.has("menu-item.select.grow"));
  savePicture(harness, "menu");
  harness.click("menu-item.edit.redo");
  CHECK(runs.redo == 0);
}

TEST_CASE("a notice passes, an error stays until it is closed, the log keeps both") {
  Notices notices;
  GuiHarness harness(640, 480, 1, [&] {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    {
      ImGui::SetNextWindowSize({theme::px(400), theme::px(200)});
      const scope::Window window("Log");
      notices.drawLog();
    }
    notices.drawToasts(size.x - theme::px(12), size.y - theme::px(12));
  });
  harness.settle();
  notices.good("Saved leopard.ply.");
  notices.warn("The scan has no normals; they were estimated from the neighbours.");
  notices.error(
      "cat.ply, byte 120: the header says 9000 points and the file ends after 12. "
      "Copy it again from where it came.");
  notices.error(notices.log().back().text);
  harness.frames(20);
  CHECK(notices.log().size() == 3);
  CHECK(notices.log().back().count == 2);
  savePicture(harness, "notices");
  CHECK(notices.passing());
  harness.frames(60 * 13);
  CHECK_FALSE(notices.passing());
  CHECK(harness.has("notice.0"));
  CHECK_FALSE(harness.has("notice.1"));
  harness.click("notice.0.close");
  CHECK_FALSE(harness.has("notice.0"));
  std::string copied;
  ImGui::GetIO().ClipboardUserData = &copied;
  ImGui::GetIO().SetClipboardTextFn = [](void* user, const char* text) {
    *static_cast<std::string*>(user) = text;
  };
  harness.click("log.copy");
  CHECK(copied.find("Saved leopard.ply.") != std::string::npos);
  harness.click("log.clear");
  CHECK(notices.log().empty());
}

TEST_CASE("a question is answered by button and key, one after another") {
  Questions questions;
  std::string answers;
  const auto ask = [&](bool danger) {
    questions.ask({.title = "Save the changes to bunny.dapple?",
                   .text = "Otherwise what was done since it was opened is lost.",
                   .yes = "Save",
                   .no = "Do not save",
                   .danger = danger,
                   .answered = [&](Answer answer) { answers += "ync"[static_cast<int>(answer)]; }});
  };
  GuiHarness harness(640, 480, 1, [&] { questions.draw(); });
  ask(false);
  ask(false);
  ask(true);
  harness.settle();
  savePicture(harness, "question");
  harness.click("question.no");
  harness.key(Key::enter);
  harness.key(Key::enter);  // not for what is dangerous
  CHECK(answers == "ny");
  harness.key(Key::escape);
  CHECK(answers == "nyc");
  CHECK_FALSE(questions.isOpen());
}

TEST_CASE("progress shows figures and its buttons are told") {
  ProgressView view{.stage = "Matching, level 3 of 5",
                    .fraction = 0.42f,
                    .pointsPerSecond = 123456,
                    .secondsLeft = 75};
  ProgressButton last = ProgressButton::none;
  GuiHarness harness(420, 160, 1, [&] {
    const scope::Window window("Work", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
    const ProgressButton pressed = progressWidget(view, theme::px(360));
    if (pressed != ProgressButton::none) last = pressed;
  });
  harness.settle();
  savePicture(harness, "progress");
  harness.click("progress.pause");
  CHECK(last == ProgressButton::pause);
  view.paused = true;
  harness.click("progress.pause");
  CHECK(last == ProgressButton::resume);
  harness.click("progress.stop");
  CHECK(last == ProgressButton::stop);
  harness.click("progress.cancel");
  CHECK(last == ProgressButton::cancel);
  CHECK(shownDuration(59.4) == "59 s");
  CHECK(shownDuration(75) == "1 min 15 s");
  CHECK(shownDuration(7500) == "2 h 5 min");
  CHECK(shownRate(123456) == "123.5 k points/s");
  CHECK(shownCount(1234567) == "1\u202f234\u202f567");
}

TEST_CASE("every icon draws something inside its square, at scale 1 and 2") {
  for (int scale : {1, 2}) {
    const int side = 24 * scale, cell = side + 8;
    GuiHarness harness(cell * kIconCount, cell, static_cast<float>(scale), [&] {
      for (int i = 1; i < kIconCount; ++i)
        drawIcon(*ImGui::GetForegroundDrawList(), static_cast<Icon>(i),
                 {static_cast<float>(i * cell + 4), 4}, static_cast<float>(side), IM_COL32_WHITE);
    });
    harness.settle();
    const Image image = harness.picture();
    for (int i = 1; i < kIconCount; ++i) {
      INFO("icon ", i, " at scale ", scale);
      int inked = 0, outside = 0;
      for (int y = 0; y < cell; ++y)
        for (int x = 0; x < cell; ++x) {
          const bool ink = image.at(i * cell + x, y, 1) > 0.3f;
          const bool inside = x >= 4 && x < 4 + side && y >= 4 && y < 4 + side;
          inked += ink && inside;
          outside += ink && !inside;
        }
      CHECK(inked > side * side / 40);
      CHECK(inked < side * side * 3 / 4);
      CHECK(outside == 0);
    }
  }
}

TEST_CASE("the same frame gives the same bytes, and a user texture is drawn as it is") {
  std::optional<GlTexture> texture;
  GuiHarness harness(64, 64, 1, [&] {
    ImGui::GetForegroundDrawList()->AddImage(guiTexture(texture->id()), {8, 8}, {56, 56});
  });
  texture.emplace();
  glBindTexture(GL_TEXTURE_2D, texture->id());
  const unsigned char texels[] = {255, 0, 0,   255, 0,   255, 0,   255,
                                  0,   0, 255, 255, 255, 255, 255, 255};
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 2, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glBindTexture(GL_TEXTURE_2D, 0);
  harness.settle();
  const Image image = harness.picture();
  CHECK(image.pixels == harness.picture().pixels);
  const auto pixel = [&](int x, int y) {
    return vec3(image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2));
  };
  CHECK(pixel(20, 20) == vec3(1, 0, 0));  // the first texel is top left
  CHECK(pixel(44, 20) == vec3(0, 1, 0));
  CHECK(pixel(20, 44) == vec3(0, 0, 1));
  CHECK(pixel(44, 44) == vec3(1, 1, 1));
}

TEST_CASE("a change of scale takes effect with the next frame, text and sizes alike") {
  float height = 0;
  GuiHarness harness(300, 200, 1, [&] {
    const scope::Window window("Window");
    ImGui::Button("Press");
    markItem("press");
    height = ImGui::GetItemRectSize().y;
  });
  harness.settle();
  const float before = height;
  harness.picture();
  harness.gui().setUiScale(2);
  harness.settle();
  CHECK(height == doctest::Approx(2 * before).epsilon(0.04));
  CHECK(theme::px(theme::kGap) == 16);
  harness.picture();
  harness.gui().setUiScale(99);
  harness.frame();
  CHECK(harness.gui().uiScale() == kMaxUiScale);
}

namespace {

struct Gallery {
  bool on = true, off = false, box = true;
  int chosen = 1;
  float value = 0.4f;
  std::string words = "cat", empty;

  void left() {
    using namespace theme;
    const scope::Child child("left", {px(kPanelWidth), 0});
    if (sectionHeader("Method")) {
      textButton("Synthesize region", ButtonKind::primary, Icon::play, -1, "primary");
      textButton("Normal", ButtonKind::normal, Icon::save);
      ImGui::SameLine();
      textButton("Quiet", ButtonKind::quiet);
      ImGui::SameLine();
      textButton("Delete", ButtonKind::danger, Icon::trash);
      slider({.label = "Scale", .usual = 0.25f, .mark = "scale"}, value);
      ImGui::Checkbox("Checkbox", &box);
      ImGui::SameLine();
      toggle("On", on);
      ImGui::SameLine();
      toggle("Off", off, "toggle");
      const char* const names[] = {"Auto", "Yes", "No"};
      segments("tileable", names, 3, chosen);
      searchField("search", "Search", words);
      searchField("search2", "Search swatches", empty);
      const scope::Combo combo("Combo", "Value");
    }
    divider();
    if (sectionHeader("Regions", true)) {
      listRow({.id = "Body", .selected = true, .icon = Icon::layers, .note = "12 034"});
      listRow({.id = "Ears", .icon = Icon::layers, .note = "1 204"});
      mutedTextWrapped("34 834 points, no normals: estimated. Pick a swatch, then synthesize.");
      keyCaps("Ctrl+Shift+Z");
    }
    sectionHeader("Folded", false);
  }
  void right() const {
    using namespace theme;
    const scope::Child child("right");
    for (int i = 1; i < kIconCount; ++i) {
      const std::string id = "icon" + std::to_string(i);
      iconButton({.icon = static_cast<Icon>(i),
                  .id = id.c_str(),
                  .tooltip = "Undo\nTakes back the last edit.",
                  .keys = "Ctrl+Z",
                  .selected = i % 9 == 1,
                  .enabled = i % 7 != 0});
      if (i % 8 != 0) ImGui::SameLine();
    }
    ImGui::NewLine();
    for (Icon icon : {Icon::brush, Icon::lasso, Icon::wand, Icon::orientation, Icon::undo,
                      Icon::gear, Icon::eye}) {
      iconItem(icon, kText, px(48));
      ImGui::SameLine();
    }
  }
  void draw() {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(ImGui::GetIO().DisplaySize);
    const scope::Window window("Gallery", nullptr, ImGuiWindowFlags_NoResize);
    left();
    ImGui::SameLine();
    right();
  }
};

}  // namespace

TEST_CASE("widgets draw themselves and work at scale 1 and 2") {
  for (float scale : {1.0f, 2.0f}) {
    Gallery gallery;
    GuiHarness harness(static_cast<int>(760 * scale), static_cast<int>(680 * scale), scale,
                       [&] { gallery.draw(); });
    harness.settle();
    harness.moveMouse(harness.at("icon15"));
    harness.frames(40);
    savePicture(harness, scale == 1 ? "gallery" : "gallery@2");
    harness.click("toggle");
    CHECK(gallery.off);
    harness.click("tileable.No");
    CHECK(gallery.chosen == 2);
    harness.fill("search", "dog");
    CHECK(gallery.words == "dog");
    const ImVec2 at = harness.at("scale");
    harness.drag(0, at, {at.x + 500 * scale, at.y});
    CHECK(gallery.value == 1);
    harness.doubleClick(harness.at("scale"));  // back to the default
    CHECK(gallery.value == 0.25f);
  }
}
