// Pixels in memory.
#pragma once

#include <vector>

#include "base/types.h"

namespace dapple {

// w x h x channels, 0..1 as stored in the file (no colour conversion), top row first.
struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> pixels;

  float& at(int x, int y, int c) {
    return pixels[(static_cast<std::size_t>(y) * width + x) * channels + c];
  }
  float at(int x, int y, int c) const {
    return pixels[(static_cast<std::size_t>(y) * width + x) * channels + c];
  }
};

}  // namespace dapple
