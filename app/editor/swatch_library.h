// The swatches that are offered: small pictures of the files in a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <set>
#include <vector>

#include "app/render/gl_objects.h"
#include "swatch/image.h"

namespace dapple {

class SwatchLibrary {
 public:
  using ReadImage = std::function<Image(const std::filesystem::path&)>;
  static constexpr int kThumbnail = 384;  // pixels a side, at most

  explicit SwatchLibrary(ReadImage read) : read_(std::move(read)) {}

  // All images of a folder that are no maps of others, by name; read on another thread. Files that
  // cannot be read are left out.
  void addFolder(const std::filesystem::path& folder);
  // One file, at the front of the list once it is read.
  void add(const std::filesystem::path& file);

  struct Entry {
    std::filesystem::path path;
    int imageWidth = 0, imageHeight = 0;  // of the file
    GlTexture thumbnail;
  };
  // Takes what has been read, once a frame. Needs the OpenGL context.
  void update();
  const std::vector<Entry>& entries() const { return entries_; }
  const Entry* find(const std::filesystem::path& path) const;
  // The same; when it is not there it is read, once, and comes with one of the next frames.
  const Entry* wanted(const std::filesystem::path& path);
  bool loading() const { return !reading_.empty(); }

 private:
  struct Read {
    std::filesystem::path path;
    Image image;                // of the thumbnail's size
    int width = 0, height = 0;  // of the file
  };
  void read(std::vector<std::filesystem::path> files, bool first);

  ReadImage read_;
  struct Reading {
    std::future<std::vector<Read>> files;
    bool first;  // they come to the front of the list
  };
  std::vector<Reading> reading_;
  std::set<std::filesystem::path> asked_;
  std::vector<Entry> entries_;
};

}  // namespace dapple
