#include "io/image_io.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "base/errors.h"
#include "io/image_formats.h"
#include "io/plain_png.h"

using namespace dapple;
namespace fs = std::filesystem;

namespace {

// A folder of its own that goes at the end of the test.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("dapple-image-" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(path), fs::directory_iterator()));
  }
};

Image makeImage(int width, int height, int channels, int levels) {
  Image image{.width = width, .height = height, .channels = channels};
  for (int i = 0; i < width * height * channels; ++i)
    image.pixels.push_back(static_cast<float>((i * 7919) % levels) /
                           static_cast<float>(levels - 1));
  return image;
}

double largestDifference(const Image& a, const Image& b) {
  REQUIRE(a.width == b.width);
  REQUIRE(a.height == b.height);
  REQUIRE(a.channels == b.channels);
  double largest = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    largest = std::fmax(largest, std::abs(a.pixels[i] - b.pixels[i]));
  return largest;
}

std::string readBytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void writeBytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string messageOfReading(const fs::path& path) {
  try {
    readImage(path);
  } catch (const IoError& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("an 8-bit image of 1 to 4 channels comes back exactly from PNG and TIFF") {
  const Folder folder;
  for (const char* name : {"a.png", "a.tif"})
    for (int channels = 1; channels <= 4; ++channels) {
      CAPTURE(name);
      CAPTURE(channels);
      const Image image = makeImage(7, 5, channels, 256);
      writeImage(folder.path / name, image);
      CHECK(largestDifference(readImage(folder.path / name), image) < 1e-6);
    }
  CHECK(folder.files() == 2);
}

TEST_CASE("plain PNGs are read without OpenImageIO, and to the same numbers") {
  const Folder folder;
  const fs::path path = folder.path / "a.png";
  for (int channels = 1; channels <= 4; ++channels) {
    writeImage(path, makeImage(32, 24, channels, 256));
    const std::optional<Image> plain = readPlainPng(path);
    REQUIRE(plain.has_value());
    CHECK(plain->channels == channels);
    CHECK(plain->width == 32);
    CHECK(plain->pixels == imageFormats().read(path).pixels);
  }
  const std::string bytes = readBytes(path);
  for (const std::size_t kept : {std::size_t{4}, std::size_t{40}, bytes.size() / 2}) {
    writeBytes(path, bytes.substr(0, kept));
    CHECK_FALSE(readPlainPng(path).has_value());
  }
  writeImage(path, makeImage(9, 6, 3, 65536), true);
  CHECK_FALSE(readPlainPng(path).has_value());
  CHECK_FALSE(readPlainPng(folder.path / "none.png").has_value());
}

TEST_CASE("a 16-bit image comes back exactly and 8 bits would not do") {
  const Folder folder;
  const Image image = makeImage(9, 6, 3, 65536);
  for (const char* name : {"a.png", "a.tiff"}) {
    writeImage(folder.path / name, image, true);
    CHECK(largestDifference(readImage(folder.path / name), image) < 1e-6);
    writeImage(folder.path / name, image, false);
    CHECK(largestDifference(readImage(folder.path / name), image) > 1e-4);
  }
}

TEST_CASE("colours under a transparent alpha survive") {
  const Folder folder;
  Image image{.width = 2, .height = 1, .channels = 4, .pixels = {1, 0.2f, 0.4f, 0, 0, 1, 0, 0.2f}};
  for (const char* name : {"a.png", "a.tif"}) {
    writeImage(folder.path / name, image);
    CHECK(largestDifference(readImage(folder.path / name), image) < 1e-6);
  }
}

TEST_CASE("the top row comes first and a 1 x 1 image can be read") {
  const Folder folder;
  writeImage(folder.path / "rows.png", {.width = 1, .height = 2, .channels = 1, .pixels = {1, 0}});
  const Image rows = readImage(folder.path / "rows.png");
  CHECK(rows.at(0, 0, 0) == 1);
  CHECK(rows.at(0, 1, 0) == 0);
  writeImage(folder.path / "one.png",
             {.width = 1, .height = 1, .channels = 3, .pixels = {1, 0, 1}});
  CHECK(readImage(folder.path / "one.png").pixels == std::vector<float>{1, 0, 1});
}

TEST_CASE("a JPEG comes back closely and a camera's orientation is undone") {
  const Folder folder;
  Image image{.width = 32, .height = 16, .channels = 3};
  for (int i = 0; i < 32 * 16; ++i)
    image.pixels.insert(image.pixels.end(), {i % 32 < 16 ? 0.1f : 0.9f, 0.5f, 0.5f});
  writeImage(folder.path / "a.jpg", image);
  CHECK(largestDifference(readImage(folder.path / "a.jpg"), image) < 0.2);
  // An EXIF block that says "the top row is on the right hand side" (6: turn a quarter clockwise).
  const std::string bytes = readBytes(folder.path / "a.jpg");
  const std::string exif(
      "\xff\xe1\x00\x22"
      "Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0",
      36);
  writeBytes(folder.path / "turned.jpg", bytes.substr(0, 2) + exif + bytes.substr(2));
  const Image turned = readImage(folder.path / "turned.jpg");
  CHECK(turned.width == 16);
  CHECK(turned.height == 32);
  CHECK(turned.at(8, 2, 0) < 0.2f);
  CHECK(turned.at(8, 29, 0) > 0.8f);
}

TEST_CASE("a palette PNG comes as RGB") {
  const Folder folder;
  // 2 x 1 pixels, palette {red, blue}, indices 1 0, stored without packing.
  const std::string png(
      "\x89PNG\r\n\x1a\n"
      "\0\0\0\x0dIHDR\0\0\0\x02\0\0\0\x01\x08\x03\0\0\0\x09\xd4\x03\xa0"
      "\0\0\0\x06PLTE\xff\0\0\0\0\xff\x6c\xa1\xfd\x8e"
      "\0\0\0\x0eIDAT\x78\x01\x01\x03\0\xfc\xff\0\x01\0\0\x05\0\x02",
      8 + 25 + 18 + 22);
  std::string bytes = png;
  const auto append = [&](std::uint32_t crc) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(crc >> shift);
  };
  const auto crcOf = [](std::string_view part) {
    std::uint32_t crc = 0xffffffffu;
    for (const char c : part) {
      crc ^= static_cast<unsigned char>(c);
      for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
    }
    return ~crc;
  };
  const auto fixCrc = [&](std::size_t chunk, std::size_t length) {
    const std::uint32_t crc = crcOf(std::string_view(bytes).substr(chunk + 4, 4 + length));
    for (std::size_t k = 0; k < 4; ++k)
      bytes[chunk + 8 + length + k] = static_cast<char>(crc >> (24 - 8 * k));
  };
  fixCrc(8, 13);
  fixCrc(33, 6);
  append(crcOf(std::string_view(bytes).substr(bytes.size() - 18)));
  bytes += std::string("\0\0\0\0IEND", 8);
  append(crcOf("IEND"));
  writeBytes(folder.path / "palette.png", bytes);
  const Image image = readImage(folder.path / "palette.png");
  REQUIRE(image.channels == 3);
  CHECK(image.pixels == std::vector<float>{0, 0, 1, 1, 0, 0});
}

TEST_CASE("what is no image is refused with cause and remedy") {
  const Folder folder;
  CHECK(contains(messageOfReading(folder.path / "none.png"), "no such file"));
  CHECK(contains(messageOfReading(folder.path), "folder"));
  writeBytes(folder.path / "empty.png", "");
  CHECK(contains(messageOfReading(folder.path / "empty.png"), "empty"));
  writeBytes(folder.path / "text.png", "this is no image\n");
  CHECK(contains(messageOfReading(folder.path / "text.png"), "not an image"));
  writeImage(folder.path / "five.tif", makeImage(4, 4, 5, 256));
  CHECK(contains(messageOfReading(folder.path / "five.tif"), "5 channels"));
}

TEST_CASE("an image in printing inks is refused") {
  const Folder folder;
  writeImage(folder.path / "a.tif", makeImage(4, 4, 4, 256));
  std::string bytes = readBytes(folder.path / "a.tif");
  // Tag 262, the photometric interpretation: RGB (2) becomes separated (5).
  const auto at = bytes.find(std::string("\x06\x01\x03\0\x01\0\0\0\x02\0", 10));
  REQUIRE(at != bytes.npos);
  bytes[at + 8] = 5;
  writeBytes(folder.path / "a.tif", bytes);
  CHECK(contains(messageOfReading(folder.path / "a.tif"), "CMYK"));
}

TEST_CASE("an image cut off anywhere is refused and never crashes") {
  const Folder folder;
  for (const char* name : {"a.png", "a.tif"}) {
    writeImage(folder.path / name, makeImage(16, 16, 3, 256));
    const std::string bytes = readBytes(folder.path / name);
    const fs::path cut = folder.path / ("cut-" + std::string(name));
    writeBytes(cut, bytes.substr(0, bytes.size() / 2));
    CHECK_THROWS_AS(readImage(cut), IoError);
    for (std::size_t length = 1; length < bytes.size(); length += 13) {
      writeBytes(cut, bytes.substr(0, length));
      try {
        readImage(cut);
      } catch (const IoError&) {
      }
    }
  }
}

TEST_CASE("a tiny file that claims a huge image is refused before memory is taken") {
  const Folder folder;
  writeImage(folder.path / "a.tif", makeImage(1, 1, 3, 256));
  std::string bytes = readBytes(folder.path / "a.tif");
  // The width (tag 256) and height (257) of a little-endian TIFF directory.
  for (std::size_t i = 8; i + 12 <= bytes.size(); ++i)
    for (const char* tag : {"\x00\x01", "\x01\x01"})
      if (bytes.compare(i, 2, std::string(tag, 2)) == 0 && bytes[i + 3] == 0 &&
          (bytes[i + 2] == 3 || bytes[i + 2] == 4) &&
          bytes.compare(i + 4, 4, std::string("\1\0\0\0", 4)) == 0)
        bytes.replace(i + 8, 2, std::string("\x00\x40", 2));
  writeBytes(folder.path / "a.tif", bytes);
  const std::string message = messageOfReading(folder.path / "a.tif");
  CHECK_MESSAGE(contains(message, "claims 16384 x 16384"), message);
}

TEST_CASE("a failed write says why and leaves the old image alone") {
  const Folder folder;
  const Image image = makeImage(4, 4, 3, 256);
  writeImage(folder.path / "a.png", image);
  const std::string before = readBytes(folder.path / "a.png");
  CHECK_THROWS_AS(writeImage(folder.path / "a.png" / "b.png", image), IoError);
  CHECK_THROWS_AS(writeImage(folder.path / "none" / "b.png", image), IoError);
  CHECK_THROWS_AS(writeImage(folder.path / "a.unheardof", image), IoError);
  CHECK_THROWS_AS(writeImage(folder.path / "noextension", image), IoError);
  CHECK_THROWS_AS(writeImage(folder.path, image), IoError);
  CHECK(readBytes(folder.path / "a.png") == before);
  CHECK(folder.files() == 1);
}

TEST_CASE("an animation holds its pictures and their rate, and appears when it is whole") {
  const Folder folder;
  const fs::path path = folder.path / "turn.gif";
  CHECK(isAnimation(path));
  CHECK(isAnimation("TURN.GIF"));
  CHECK(!isAnimation("turn.png"));
  const auto picture = [](float grey) {
    Image image{.width = 20, .height = 10, .channels = 4};
    for (int i = 0; i < 200; ++i)
      image.pixels.insert(image.pixels.end(), {1 - grey, grey, 0.5f, 1});
    return image;
  };
  {
    AnimationWriter unfinished(path, 3, 10);
    unfinished.add(picture(0));
    CHECK(!fs::exists(path));
  }
  CHECK(folder.files() == 0);

  AnimationWriter writer(path, 3, 10);
  for (const float grey : {0.f, 0.5f, 1.f}) writer.add(picture(grey));
  CHECK(!fs::exists(path));
  writer.finish();
  CHECK(folder.files() == 1);
  const std::string bytes = readBytes(path);
  CHECK(bytes.starts_with("GIF89a"));
  CHECK(bytes.find("NETSCAPE2.0") != bytes.npos);  // it repeats
  int pictures = 0;
  const std::string control("\x21\xf9\x04", 3);
  for (std::size_t at = bytes.find(control); at != bytes.npos; at = bytes.find(control, at + 1)) {
    ++pictures;
    CHECK(static_cast<unsigned char>(bytes[at + 4]) == 10);  // hundredths of a second
    CHECK(bytes[at + 5] == 0);
  }
  CHECK(pictures == 3);
  const Image first = readImage(path);
  CHECK(first.width == 20);
  CHECK(first.height == 10);
  CHECK(first.at(3, 3, 0) == doctest::Approx(1).epsilon(0.03));
  CHECK(first.at(3, 3, 1) == doctest::Approx(0).scale(1).epsilon(0.03));
  CHECK_THROWS_AS(AnimationWriter(folder.path / "nowhere" / "a.gif", 2, 10), IoError);
}
