// Pictures for other programs from where no image library is linked.
#pragma once

#include <filesystem>
#include <span>

#include "base/types.h"

namespace dapple {

// w x h colours, 0..1, top row first, as a BMP of 24 bits; appears whole or not at all. Throws
// IoError.
void saveBitmap(const std::filesystem::path& path, int width, int height,
                std::span<const vec3> colours);

}  // namespace dapple
