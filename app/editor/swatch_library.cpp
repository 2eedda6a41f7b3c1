#include "app/editor/swatch_library.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>

#include "swatch/material_files.h"

namespace dapple {
namespace {

constexpr int kMipmaps = 5;  // 384 pixels to 12

// The mean of the pixels under each of the small one's, red, green, blue.
Image shrunk(const Image& image, int side) {
  const float factor = std::max(
      1.f, static_cast<float>(std::max(image.width, image.height)) / static_cast<float>(side));
  Image out{std::max(1, static_cast<int>(static_cast<float>(image.width) / factor)),
            std::max(1, static_cast<int>(static_cast<float>(image.height) / factor)),
            3,
            {}};
  out.pixels.resize(std::size_t{3} * out.width * out.height);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const int left = x * image.width / out.width, right = (x + 1) * image.width / out.width;
      const int top = y * image.height / out.height, low = (y + 1) * image.height / out.height;
      vec3 sum(0);
      for (int v = top; v < low; ++v)
        for (int u = left; u < right; ++u)
          for (int c = 0; c < 3; ++c) sum[c] += image.at(u, v, image.channels < 3 ? 0 : c);
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) = sum[c] / static_cast<float>(std::max(1, (right - left) * (low - top)));
    }
  return out;
}

GlTexture textureOf(const Image& image) {
  std::vector<std::uint8_t> bytes;
  for (const float v : image.pixels)
    bytes.push_back(static_cast<std::uint8_t>(std::clamp(v, 0.f, 1.f) * 255 + 0.5f));
  GlTexture texture = makeTexture(GL_RGB8, image.width, image.height);
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image.width, image.height, GL_RGB, GL_UNSIGNED_BYTE,
                  bytes.data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  // Shown at its own size and much smaller.
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, kMipmaps);
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glBindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

}  // namespace

void SwatchLibrary::read(std::vector<std::filesystem::path> files, bool first) {
  auto work = [files = std::move(files), read = read_] {
    std::vector<Read> out;
    for (const std::filesystem::path& file : files) {
      try {
        const Image image = read(file);
        out.push_back({file, shrunk(image, kThumbnail), image.width, image.height});
      } catch (const std::exception&) {
        // Not an image: a folder may hold anything.
      }
    }
    return out;
  };
  reading_.push_back({std::async(std::launch::async, std::move(work)), first});
}

void SwatchLibrary::addFolder(const std::filesystem::path& folder) {
  read(swatchesIn(folder), false);
}

void SwatchLibrary::add(const std::filesystem::path& file) {
  if (!find(file)) read({file}, true);
}

const SwatchLibrary::Entry* SwatchLibrary::wanted(const std::filesystem::path& path) {
  const Entry* entry = find(path);
  if (!entry && !loading() && asked_.insert(path).second) read({path}, true);
  return entry;
}

void SwatchLibrary::update() {
  for (auto& reading : reading_) {
    if (reading.files.wait_for(std::chrono::seconds(0)) != std::future_status::ready) continue;
    std::vector<Entry> read;
    for (const Read& file : reading.files.get())
      read.push_back({file.path, file.width, file.height, textureOf(file.image)});
    entries_.insert(reading.first ? entries_.begin() : entries_.end(),
                    std::make_move_iterator(read.begin()), std::make_move_iterator(read.end()));
  }
  std::erase_if(reading_, [](const Reading& reading) { return !reading.files.valid(); });
}

const SwatchLibrary::Entry* SwatchLibrary::find(const std::filesystem::path& path) const {
  for (const Entry& entry : entries_)
    if (entry.path == path) return &entry;
  return nullptr;
}

}  // namespace dapple
