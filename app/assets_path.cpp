#include "app/assets_path.h"

#include <cstdlib>

namespace dapple {
namespace fs = std::filesystem;

fs::path assetsFolderOf(const fs::path& executable, const char* chosen) {
  if (chosen != nullptr && *chosen != '\0') return chosen;
  if (!executable.is_absolute()) return {};  // not what happens to be in the working directory
  const fs::path bin = executable.parent_path();
  for (const fs::path& folder : {bin / DAPPLE_ASSETS_FROM_BIN, bin / "assets"}) {
    std::error_code ignored;  // a folder that may not be read is as good as none
    if (fs::is_directory(folder / "swatches", ignored)) return folder.lexically_normal();
  }
  return {};
}

fs::path assetsFolder() {
  std::error_code ignored;
  return assetsFolderOf(fs::read_symlink("/proc/self/exe", ignored), std::getenv("DAPPLE_ASSETS"));
}

}  // namespace dapple
