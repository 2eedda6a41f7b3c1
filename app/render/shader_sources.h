// The GLSL files of shaders/, embedded at build.
#pragma once

#include <string_view>

namespace dapple {

// The text of shaders/<name>, without a #version line. Throws Bug for another name.
std::string_view shaderSource(std::string_view name);

}  // namespace dapple
