// Where the program's own swatches and its sample scan are.
#pragma once

#include <filesystem>

namespace dapple {

// The folder that holds swatches/ and scans/, empty when there is none. The first of:
// 1. $DAPPLE_ASSETS when it is set, whether it exists or not: what was asked for is never replaced;
// 2. share/dapple beside the program's bin/, where an installation has it, wherever it was moved
// to;
// 3. assets/ beside the program, which in a build tree is a link to the sources.
std::filesystem::path assetsFolder();

// The same for a program at `executable`. `chosen` is the variable's value; nullptr or "": not set.
std::filesystem::path assetsFolderOf(const std::filesystem::path& executable, const char* chosen);

}  // namespace dapple
