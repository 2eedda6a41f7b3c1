#include <doctest/doctest.h>

#include <filesystem>

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
