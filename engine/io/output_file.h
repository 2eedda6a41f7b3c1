// A file that appears whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace dapple {

// Writes to a temporary file beside the target and renames it over the target on commit(); until
// then, and when commit() is never reached, the target stays as it was and the temporary file goes.
// A symbolic link is followed: its target is replaced. A device or pipe is written directly.
class OutputFile {
 public:
  // `extension` (with its dot) ends the temporary name. Throws IoError, as all functions here.
  explicit OutputFile(const std::filesystem::path& path, const std::string& extension = "");
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::string& path() const { return path_; }
  // Where the bytes go before commit(), for a library that opens its file itself.
  const std::filesystem::path& temporary() const { return temporary_; }

  void write(const void* bytes, std::size_t count);
  void commit();

 private:
  void openTemporary(const std::string& extension);
  [[noreturn]] void fail(int error) const;

  std::string path_;              // as the user named it
  std::filesystem::path target_;  // with links followed
  std::filesystem::path temporary_;
  bool direct_ = false;  // a device: no temporary file
  int descriptor_ = -1;
  std::size_t written_ = 0;
};

}  // namespace dapple
