#include <doctest/doctest.h>

#include <filesystem>

#include "app/gui/actions.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"
#include "gui_harness.h"
#include "io/image_io.h"

using namespace dapple;

namespace {

void savePicture(GuiHarness& harness, const std::string& name) {
  std::filesystem::create_directories(DAPPLE_GUI_PICTURES);
  writeImage(std::filesystem::path(DAPPLE_GUI_PICTURES) / (name + ".png"), harness.picture());
}

}  // namespace

TEST_CASE("a button is clicked by its name at any scale") {
  for (float scale : {1.0f, 2.0f}) {
    int clicks = 0;
    GuiHarness harness(400, 300, scale, [&] {
      ImGui::Begin("Window");
      if (ImGui::Button("Press me")) ++clicks;
      markItem("press");
      ImGui::End();
    });
    harness.settle();
    harness.click("press");
    CHECK(clicks == 1);
    savePicture(harness, scale == 1 ? "button" : "button@2");
    CHECK(harness.picture().pixels == harness.picture().pixels);
  }
}

namespace {

void gallery() {
  using namespace theme;
  static bool on = true, off = false, box = true;
  static int chosen = 1;
  static float value = 0.4f;
  static std::string words = "cat", empty;
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(ImGui::GetIO().DisplaySize);
  const scope::Window window("Gallery", nullptr, ImGuiWindowFlags_NoResize);
  {
    const scope::Child left("left", {px(kPanelWidth), 0});
    if (sectionHeader("Method")) {
      textButton("Synthesize region", ButtonKind::primary, Icon::play, -1, "primary");
      textButton("Normal", ButtonKind::normal, Icon::save);
      ImGui::SameLine();
      textButton("Quiet", ButtonKind::quiet);
      ImGui::SameLine();
      textButton("Delete", ButtonKind::danger, Icon::trash);
      ImGui::SliderFloat("Scale", &value, 0, 1);
      ImGui::Checkbox("Checkbox", &box);
      ImGui::SameLine();
      toggle("On", on);
      ImGui::SameLine();
      toggle("Off", off, "toggle");
      const char* const names[] = {"Auto", "Yes", "No"};
      segments("tileable", names, 3, chosen);
      searchField("search", "Search", words);
      searchField("search2", "Search swatches", empty);
      { const scope::Combo combo("Combo", "Value"); }
    }
    divider();
    if (sectionHeader("Regions", true)) {
      ImGui::Selectable("Body", true);
      ImGui::Selectable("Ears");
      mutedTextWrapped("34 834 points, no normals: estimated. Pick a swatch and press Synthesize.");
      keyCaps("Ctrl+Shift+Z");
    }
    sectionHeader("Folded", false);
  }
  ImGui::SameLine();
  const scope::Child right("right");
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
  for (Icon icon : {Icon::brush, Icon::lasso, Icon::wand, Icon::orientation, Icon::undo, Icon::gear,
                    Icon::eye, Icon::lock, Icon::fill}) {
    iconItem(icon, kText, px(48));
    ImGui::SameLine();
  }
}

}  // namespace

TEST_CASE("widgets draw themselves at scale 1 and 2") {
  for (float scale : {1.0f, 2.0f}) {
    GuiHarness harness(static_cast<int>(760 * scale), static_cast<int>(620 * scale), scale,
                       gallery);
    harness.settle();
    harness.moveMouse(harness.at("icon15"));
    harness.frames(40);
    savePicture(harness, scale == 1 ? "gallery" : "gallery@2");
  }
}
