// Files for tests: made in a folder of their own that goes with the test.
#pragma once

#include <doctest/doctest.h>
#include <unistd.h>

#include <atomic>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "base/errors.h"
#include "io/point_io.h"

namespace dapple::testing {

namespace fs = std::filesystem;

class Folder {
 public:
  Folder() {
    static std::atomic<int> next = 0;
    path_ = fs::temp_directory_path() / fmt::format("dapple-test-{}-{}", ::getpid(), ++next);
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  fs::path operator/(const std::string& name) const { return path_ / name; }
  const fs::path& path() const { return path_; }

  fs::path write(const std::string& name, const std::string& bytes) const {
    fs::remove(path_ / name);  // some file systems wait for the disk when a file is overwritten
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
  }

 private:
  fs::path path_;
};

inline std::string readBytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline Scan load(const fs::path& path, const LoadOptions& options = {}) {
  Workers workers(2);
  Monitor monitor(workers);
  return loadScan(path, options, monitor);
}

inline void save(const fs::path& path, const RecordTable& table, bool ascii = false) {
  Workers workers(1);
  Monitor monitor(workers);
  savePly(path, table, ascii, monitor);
}

// What the refusal says; empty when the file was taken.
inline std::string whyNot(const fs::path& path, const LoadOptions& options = {}) {
  try {
    load(path, options);
  } catch (const IoError& error) {
    return error.what();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != text.npos;
}

// The bytes of a number, in either order.
template <class T>
std::string bytesOf(T value, bool bigEndian = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (bigEndian) bytes = std::string(bytes.rbegin(), bytes.rend());
  return bytes;
}

// A file of ../shared/data, or an empty path (and a message) where that is not there.
inline fs::path sharedModel(const std::string& name) {
  const fs::path path = fs::path(DAPPLE_SHARED_DATA) / "models" / name;
  if (fs::exists(path)) return path;
  MESSAGE("skipped: no ", path.string());
  return {};
}

}  // namespace dapple::testing
