#include "io/image_io.h"

#include <dlfcn.h>

#include "base/errors.h"
#include "io/file_names.h"
#include "io/image_formats.h"
#include "io/plain_png.h"

namespace dapple {
namespace {

// Throws IoError.
const ImageFormats& loadFormats() {
  void* const module = ::dlopen(kImageModule, RTLD_LAZY | RTLD_LOCAL);
  const auto entry = module == nullptr
                         ? nullptr
                         : reinterpret_cast<ImageModuleEntry*>(::dlsym(module, kImageModuleEntry));
  if (entry == nullptr)
    throw IoError(kImageModule, "",
                  fmt::format("this part of Dapple cannot be loaded: {}", ::dlerror()),
                  "Install Dapple, and OpenImageIO, again.");
  return *entry();
}

}  // namespace

const ImageFormats& imageFormats() {
  static const ImageFormats& formats = loadFormats();
  return formats;
}

bool isImageFile(const std::filesystem::path& path) {
  const std::string extension = lowerExtension(path);
  for (const char* known :
       {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".bmp", ".webp", ".tga", ".hdr", ".gif"})
    if (extension == known) return true;
  return false;
}

Image readImage(const std::filesystem::path& path) {
  if (std::optional<Image> image = readPlainPng(path)) return *std::move(image);
  return imageFormats().read(path);
}

void checkImageName(const std::filesystem::path& path) {
  imageFormats().checkName(path);
}

void writeImage(const std::filesystem::path& path, const Image& image, bool sixteenBit) {
  imageFormats().write(path, image, sixteenBit);
}

bool isAnimation(const std::filesystem::path& path) {
  return lowerExtension(path) == ".gif";
}

AnimationWriter::AnimationWriter(const std::filesystem::path& path, int pictures, int perSecond)
    : file_(imageFormats().animate(path, pictures, perSecond)) {
  DAPPLE_CHECK(isAnimation(path), ==, true);
}

AnimationWriter::~AnimationWriter() = default;

void AnimationWriter::add(const Image& picture) {
  file_->add(picture);
}

void AnimationWriter::finish() {
  file_->finish();
}

}  // namespace dapple
