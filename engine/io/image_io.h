// Images from and to files. All but plain PNG files go through OpenImageIO (image_formats.h).
#pragma once

#include <filesystem>
#include <memory>

#include "swatch/image.h"

namespace dapple {

class AnimationFile;

// Any format that OpenImageIO knows, 1 to 4 channels, 8 or 16 bit or float; two channels are grey
// and alpha. Alpha is unassociated. Throws IoError.
Image readImage(const std::filesystem::path& path);

// Whether its extension is that of a picture.
bool isImageFile(const std::filesystem::path& path);

// Throws IoError when no format that can be written has the extension of `path`.
void checkImageName(const std::filesystem::path& path);

// Format by extension; 8 bit, or 16 bit for a PNG/TIFF when `sixteenBit`. Written beside and
// renamed into place. Throws IoError.
void writeImage(const std::filesystem::path& path, const Image& image, bool sixteenBit = false);

// Whether `path` has the extension of a format that is written as one file of many pictures that
// viewers play: GIF.
bool isAnimation(const std::filesystem::path& path);

// Such a file, picture by picture; it appears under its name with finish() only, or not at all.
class AnimationWriter {
 public:
  // Of so many pictures, at so many a second (1 to 50; GIF rounds to hundredths of a second each).
  // All functions throw IoError.
  AnimationWriter(const std::filesystem::path& path, int pictures, int perSecond);
  ~AnimationWriter();

  // All of the same size; alpha is left out.
  void add(const Image& picture);
  void finish();

 private:
  std::unique_ptr<AnimationFile> file_;
};

}  // namespace dapple
