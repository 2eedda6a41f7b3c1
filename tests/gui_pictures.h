// Pictures of tests to be looked at.
#pragma once

#include <filesystem>
#include <string>

#include "gui_harness.h"
#include "io/image_io.h"

namespace dapple {

// Into the tests' folder of the build.
inline void savePicture(GuiHarness& harness, const std::string& name) {
  std::filesystem::create_directories(DAPPLE_GUI_PICTURES);
  writeImage(std::filesystem::path(DAPPLE_GUI_PICTURES) / (name + ".png"), harness.picture());
}

}  // namespace dapple
