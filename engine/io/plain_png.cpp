#include "io/plain_png.h"

#include <png.h>

#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string_view>
#include <vector>

namespace dapple {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20;  // larger claims are looked into
constexpr std::uint32_t kLargestSide = 16384;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

// libpng leaves by longjmp: what it may skip lives in members, not on the stack.
class PngReader {
 public:
  explicit PngReader(std::FILE* file)
      : png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore)),
        info_(png_ ? png_create_info_struct(png_) : nullptr),
        file_(file) {}
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  bool read() {
    if (!info_ || setjmp(png_jmpbuf(png_))) return false;
    png_init_io(png_, file_);
    png_read_info(png_, info_);
    if (!isPlain()) return false;
    bytes_.resize(png_get_rowbytes(png_, info_) * height());
    rows_.resize(height());
    for (std::size_t y = 0; y < rows_.size(); ++y) rows_[y] = &bytes_[y * bytes_.size() / height()];
    png_read_image(png_, rows_.data());
    return true;
  }

  Image image() const {
    Image image{.width = static_cast<int>(png_get_image_width(png_, info_)),
                .height = static_cast<int>(height()),
                .channels = png_get_channels(png_, info_)};
    image.pixels.reserve(bytes_.size());
    for (const std::uint8_t byte : bytes_)
      image.pixels.push_back(static_cast<float>(byte) * (1 / 255.f));
    return image;
  }

 private:
  [[noreturn]] static void fail(png_structp png, png_const_charp) { png_longjmp(png, 1); }
  static void ignore(png_structp, png_const_charp) {}

  png_uint_32 height() const { return png_get_image_height(png_, info_); }

  bool isPlain() const {
    const std::uint64_t width = png_get_image_width(png_, info_),
                        channels = png_get_channels(png_, info_);
    return png_get_bit_depth(png_, info_) == 8 &&
           !(png_get_color_type(png_, info_) & PNG_COLOR_MASK_PALETTE) &&
           png_get_valid(png_, info_, PNG_INFO_tRNS | PNG_INFO_eXIf) == 0 && !hasTurn() &&
           width <= kLargestSide && height() <= kLargestSide &&
           width * height() * channels <= kMostBytes;
  }

  // Whether some text may hold an orientation.
  bool hasTurn() const {
    png_textp text = nullptr;
    int count = 0;
    png_get_text(png_, info_, &text, &count);
    for (int i = 0; i < count; ++i) {
      const std::string_view key = text[i].key;
      if (key.find("rientation") != key.npos || key.find("xmp") != key.npos) return true;
    }
    return false;
  }

  png_structp png_;
  png_infop info_;
  std::FILE* file_;
  std::vector<std::uint8_t> bytes_;
  std::vector<png_bytep> rows_;
};

}  // namespace

std::optional<Image> readPlainPng(const std::filesystem::path& path) {
  constexpr std::size_t kSignature = 8;
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rbe"));
  if (!file) return {};
  std::uint8_t start[kSignature];
  if (std::fread(start, 1, kSignature, file.get()) != kSignature ||
      png_sig_cmp(start, 0, kSignature) != 0)
    return {};
  std::rewind(file.get());
  PngReader reader(file.get());
  if (!reader.read()) return {};
  return reader.image();
}

}  // namespace dapple
