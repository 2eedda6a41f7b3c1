// The module: OpenImageIO behind the functions of image_io.h.
#include "io/image_formats.h"

#include <OpenImageIO/imageio.h>
#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#endif

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>

#include "base/errors.h"
#include "io/file_names.h"
#include "io/output_file.h"

namespace dapple {
namespace {

constexpr int kLargestSide = 16384;
// A small file that claims to unpack to more than this must stay within the best ratio that the
// usual packings reach (deflate 1032, LZW 2730), before memory is taken for it.
constexpr std::uint64_t kTrustedBytes = std::uint64_t{64} << 20;
constexpr std::uint64_t kBestRatio = 4096;
constexpr char kGifEnd = ';';
constexpr const char* kKnown = "Use a PNG, JPEG or TIFF image.";

// While one lives, the leak sanitizer does not count what is taken. Of a damaged PNG OpenImageIO
// asks for its error text and leaves by libpng's longjmp, so that the string is never destroyed.
#if defined(__SANITIZE_ADDRESS__)
using UncountedLeaks = __lsan::ScopedDisabler;
#else
struct UncountedLeaks {
  ~UncountedLeaks() {}  // or it would be unused
};
#endif

struct Opened {
  std::unique_ptr<OIIO::ImageInput> input;
  std::uint64_t fileBytes = 0;
};

// The extension without its dot.
std::string kindOf(const std::filesystem::path& path) {
  const std::string extension = lowerExtension(path);
  return extension.empty() ? extension : extension.substr(1);
}

std::string firstLine(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

Opened openImage(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    throw IoError(path.string(), "", "there is no such file", "Check the name and the folder.");
  if (!fs::is_regular_file(status))
    throw IoError(path.string(), "", "this is no file, but a folder or a device",
                  "Name an image file.");
  Opened opened{.fileBytes = fs::file_size(path, error)};
  if (error || opened.fileBytes == 0)
    throw IoError(path.string(), "", "the file is empty", "Export or copy it again.");
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  const UncountedLeaks uncounted;
  opened.input = OIIO::ImageInput::open(path.string(), &config);
  if (opened.input) return opened;
  OIIO::geterror();  // clears what it says about the file's plugins: no help to a user
  throw IoError(path.string(), "", "this is not an image of a known format", kKnown);
}

// Ink colours come as four channels, too, or already turned to RGB by a guess at the inks.
bool isCmyk(const OIIO::ImageSpec& spec) {
  for (const char* key : {"oiio:ColorSpace", "tiff:ColorSpace", "jpeg:ColorSpace"})
    if (spec.get_string_attribute(key) == "CMYK") return true;
  return spec.nchannels >= 4 && spec.channelnames.size() >= 4 && spec.channelnames[0] == "C" &&
         spec.channelnames[3] == "K";
}

void checkSpec(const OIIO::ImageSpec& spec, const std::string& path, std::uint64_t fileBytes) {
  if (isCmyk(spec))
    throw IoError(path, "", "the image is in printing inks (CMYK)", "Convert it to RGB.");
  if (spec.nchannels < 1 || spec.nchannels > 4 || spec.deep)
    throw IoError(path, "", fmt::format("the image has {} channels", spec.nchannels),
                  "Save it as grey, RGB or RGBA.");
  if (spec.depth > 1) throw IoError(path, "", "this is a volume, not an image", kKnown);
  if (spec.width < 1 || spec.height < 1 || spec.width > kLargestSide || spec.height > kLargestSide)
    throw IoError(path, "", fmt::format("the image has {} x {} pixels", spec.width, spec.height),
                  fmt::format("1 to {} a side are possible.", kLargestSide));
  const std::uint64_t bytes = spec.image_bytes(true);
  if (bytes > kTrustedBytes && bytes / kBestRatio > fileBytes)
    throw IoError(path, "",
                  fmt::format("the image claims {} x {} pixels, but the file has {} bytes only",
                              spec.width, spec.height, fileBytes),
                  "It is damaged. Export it again.");
}

// Turns the picture as the camera was held: the eight values of EXIF's Orientation tag.
Image upright(Image image, int orientation) {
  if (orientation <= 1 || orientation > 8) return image;
  const bool swapped = orientation >= 5;
  Image out{.width = swapped ? image.height : image.width,
            .height = swapped ? image.width : image.height,
            .channels = image.channels};
  out.pixels.resize(image.pixels.size());
  const int right = image.width - 1, bottom = image.height - 1;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      // Where pixel (x, y) of the upright picture is stored, by orientation - 1.
      const std::array<std::array<int, 2>, 8> from = {{{x, y},
                                                       {right - x, y},
                                                       {right - x, bottom - y},
                                                       {x, bottom - y},
                                                       {y, x},
                                                       {y, bottom - x},
                                                       {right - y, bottom - x},
                                                       {right - y, x}}};
      const auto [fromX, fromY] = from[static_cast<std::size_t>(orientation - 1)];
      for (int c = 0; c < image.channels; ++c) out.at(x, y, c) = image.at(fromX, fromY, c);
    }
  return out;
}

OIIO::TypeDesc pixelType(const std::string& extension, bool sixteenBit) {
  if (extension == "exr" || extension == "hdr") return OIIO::TypeDesc::FLOAT;
  const bool canSixteen = extension == "png" || extension == "tif" || extension == "tiff";
  return sixteenBit && canSixteen ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
}

std::unique_ptr<OIIO::ImageOutput> writerFor(const std::filesystem::path& path) {
  const std::string extension = kindOf(path);
  auto writer = extension.empty() ? nullptr : OIIO::ImageOutput::create(extension);
  if (writer) return writer;
  OIIO::geterror();
  throw IoError(path.string(), "",
                fmt::format("no image format has the extension \"{}\"", extension),
                "Use .png, .jpg or .tif.");
}

Image readImage(const std::filesystem::path& path) {
  const Opened opened = openImage(path);
  const OIIO::ImageSpec spec = opened.input->spec();
  checkSpec(spec, path.string(), opened.fileBytes);
  Image image{.width = spec.width, .height = spec.height, .channels = spec.nchannels};
  image.pixels.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                      static_cast<std::size_t>(spec.nchannels));
  const UncountedLeaks uncounted;
  if (!opened.input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT,
                                image.pixels.data()))
    throw IoError(path.string(), "", "the image is damaged: " + firstLine(opened.input->geterror()),
                  "Export or copy it again.");
  for (float& value : image.pixels)
    if (!std::isfinite(value)) value = 0;
  return upright(std::move(image), spec.get_int_attribute("Orientation", 1));
}

void writeImage(const std::filesystem::path& path, const Image& image, bool sixteenBit) {
  DAPPLE_CHECK(image.width, >, 0);
  DAPPLE_CHECK(image.height, >, 0);
  DAPPLE_CHECK(image.pixels.size(), ==,
               static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                   static_cast<std::size_t>(image.channels));
  const auto output = writerFor(path);
  OIIO::ImageSpec spec(image.width, image.height, image.channels,
                       pixelType(kindOf(path), sixteenBit));
  if (image.channels == 2 || image.channels == 4) spec.alpha_channel = image.channels - 1;
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("CompressionQuality", 95);
  OutputFile file(path, "." + kindOf(path));
  const auto fail = [&] {
    throw IoError(path.string(), "", "cannot be written: " + firstLine(output->geterror()),
                  "Is the disk full? Save to another folder or in another format.");
  };
  if (!output->open(file.temporary().string(), spec)) fail();
  if (!output->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data())) fail();
  if (!output->close()) fail();
  file.commit();
}

class GifFile : public AnimationFile {
 public:
  GifFile(const std::filesystem::path& path, int pictures, int perSecond)
      : path_(path.string()),
        pictures_(pictures),
        perSecond_(perSecond),
        bytes_(path, "." + kindOf(path)),
        output_(writerFor(path)) {}

  void add(const Image& picture) override {
    DAPPLE_CHECK(written_, <, pictures_);
    OIIO::ImageSpec spec(picture.width, picture.height, 3, OIIO::TypeDesc::UINT8);
    const int rate[] = {perSecond_, 1};
    spec.attribute("FramesPerSecond", OIIO::TypeRational, rate);
    spec.attribute("gif:LoopCount", 0);  // for ever
    const std::string name = bytes_.temporary().string();
    if (written_ == 0) {
      const std::vector<OIIO::ImageSpec> all(static_cast<std::size_t>(pictures_), spec);
      if (!output_->open(name, pictures_, all.data())) fail();
    } else if (!output_->open(name, spec, OIIO::ImageOutput::AppendSubimage)) {
      fail();
    }
    const auto step =
        static_cast<OIIO::stride_t>(picture.channels) * static_cast<OIIO::stride_t>(sizeof(float));
    DAPPLE_CHECK(picture.channels, >=, 3);
    if (!output_->write_image(OIIO::TypeDesc::FLOAT, picture.pixels.data(), step)) fail();
    ++written_;
  }

  void finish() override {
    DAPPLE_CHECK(written_, ==, pictures_);
    if (!output_->close()) fail();
    // OpenImageIO's GIF writer does not look whether its bytes were taken: the last of them tells.
    const std::filesystem::path& name = bytes_.temporary();
    if (std::filesystem::is_regular_file(name)) {
      std::ifstream written(name, std::ios::binary);
      written.seekg(-1, std::ios::end);
      if (written.get() != kGifEnd) fail();
    }
    bytes_.commit();
  }

 private:
  [[noreturn]] void fail() {
    throw IoError(path_, "", "cannot be written: " + firstLine(output_->geterror()),
                  "Is the disk full? Save to another folder, or to .png for one file a picture.");
  }

  std::string path_;
  int pictures_, perSecond_, written_ = 0;
  OutputFile bytes_;
  std::unique_ptr<OIIO::ImageOutput> output_;  // closes before the bytes are taken away
};

class OpenImageFormats : public ImageFormats {
 public:
  Image read(const std::filesystem::path& path) const override { return readImage(path); }
  void checkName(const std::filesystem::path& path) const override { writerFor(path); }
  void write(const std::filesystem::path& path, const Image& image,
             bool sixteenBit) const override {
    writeImage(path, image, sixteenBit);
  }
  std::unique_ptr<AnimationFile> animate(const std::filesystem::path& path, int pictures,
                                         int perSecond) const override {
    return std::make_unique<GifFile>(path, pictures, perSecond);
  }
};

}  // namespace
}  // namespace dapple

extern "C" const dapple::ImageFormats* dappleImageFormats() {
  static const dapple::OpenImageFormats formats;
  return &formats;
}
