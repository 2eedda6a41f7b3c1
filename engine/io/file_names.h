// What a file's name says of its kind.
#pragma once

#include <cctype>
#include <filesystem>
#include <string>

namespace dapple {

// With its dot, in lower case: ".ply"; empty when there is none.
inline std::string lowerExtension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace dapple
