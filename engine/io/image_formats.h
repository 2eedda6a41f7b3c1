// What OpenImageIO does for us, in a module of its own that is loaded when it is first asked for:
// OpenImageIO brings 260 libraries along, 100 MB of memory and 0.15 s at the start of a program.
#pragma once

#include <filesystem>
#include <memory>

#include "swatch/image.h"

namespace dapple {

// A file of many pictures that is being written.
class AnimationFile {
 public:
  virtual ~AnimationFile() = default;
  virtual void add(const Image& picture) = 0;
  virtual void finish() = 0;
};

// As the functions of image_io.h.
class ImageFormats {
 public:
  virtual Image read(const std::filesystem::path& path) const = 0;
  virtual void checkName(const std::filesystem::path& path) const = 0;
  virtual void write(const std::filesystem::path& path, const Image& image,
                     bool sixteenBit) const = 0;
  virtual std::unique_ptr<AnimationFile> animate(const std::filesystem::path& path, int pictures,
                                                 int perSecond) const = 0;

 protected:
  ~ImageFormats() = default;
};

// Loads the module: it is beside the program's libraries (the program's run path leads there).
// Throws IoError when it is not.
const ImageFormats& imageFormats();

// The one function that the module shows.
inline constexpr const char* kImageModule = "dapple_image_formats.so";
inline constexpr const char* kImageModuleEntry = "dappleImageFormats";
using ImageModuleEntry = const ImageFormats*();

}  // namespace dapple
