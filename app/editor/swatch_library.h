// The swatches that are offered: small pictures of the files in a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <vector>

#include "app/render/gl_objects.h"
#include "swatch/image.h"

namespace dapple {

class SwatchLibrary {
 public:
  using ReadImage = std::function<Image(const std::filesystem::path&)>;
  static constexpr int kThumbnail = 96;  // pixels a side, at most

  explicit SwatchLibrary(ReadImage read) : read_(std::move(read)) {}

  // All images of a folder, by name; read on another thread. Files that cannot be read are left
  // out.
  void addFolder(const std::filesystem::path& folder);
  // One file, at the front of the list.
  void add(const std::filesystem::path& file);

  struct Entry {
    std::filesystem::path path;
    int width = 0, height = 0;  // of the thumbnail
    GlTexture thumbnail;
  };
  // What is there by now. Needs the OpenGL context.
  const std::vector<Entry>& entries();
  const Entry* find(const std::filesystem::path& path) const;
  bool loading() const { return !reading_.empty(); }

 private:
  struct Read {
    std::filesystem::path path;
    Image image;  // of the thumbnail's size
  };
  void read(std::vector<std::filesystem::path> files);

  ReadImage read_;
  std::vector<std::future<std::vector<Read>>> reading_;
  std::vector<Entry> entries_;
};

}  // namespace dapple
