// A file read from front to back in blocks, whatever its size.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/monitor.h"

namespace dapple {

class InputFile {
 public:
  // Opens a regular, non-empty file. Every block read is a checkpoint of `monitor`, which must
  // outlive this. Throws IoError that says why not.
  InputFile(const std::filesystem::path& path, Monitor& monitor);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return path_; }
  std::size_t size() const { return size_; }
  std::size_t offset() const { return offset_; }
  std::size_t remaining() const { return size_ - offset_; }

  // At least min(count, remaining()) bytes from offset() on; valid until the next peek() or line().
  std::string_view peek(std::size_t count);
  // Goes on by `count` bytes, not beyond what the last peek() returned.
  void skip(std::size_t count);

  // The next line without its end (`ending`, and \r before it); false at the end of the file.
  bool line(std::string_view& text, char ending = '\n');
  std::size_t lineNumber() const { return lineNumber_; }  // of the last line(), from 1

  [[noreturn]] void failAtByte(const std::string& cause, const std::string& remedy) const;
  [[noreturn]] void failAtLine(const std::string& cause, const std::string& remedy) const;

 private:
  void fill(std::size_t count);

  std::string path_;
  Monitor& monitor_;
  int descriptor_ = -1;
  std::size_t size_ = 0, offset_ = 0, lineNumber_ = 0;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // the unread bytes in buffer_
};

}  // namespace dapple
