// The images that most swatches are, without OpenImageIO.
#pragma once

#include <filesystem>
#include <optional>

#include "swatch/image.h"

namespace dapple {

// A PNG of 8 bits a channel, grey or RGB, with or without alpha, and nothing that tells how to turn
// it: the same numbers as OpenImageIO's. Nothing for any other file, damaged ones and those that
// are not there among them.
std::optional<Image> readPlainPng(const std::filesystem::path& path);

}  // namespace dapple
