#include "io/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kBlock = 256 << 10;        // under 10 ms of parsing between checkpoints
constexpr std::size_t kLongestLine = 256 << 20;  // beyond it a file is no text

[[noreturn]] void failToOpen(const std::string& path, int error) {
  if (error == ENOENT || error == ENOTDIR)
    throw IoError(path, "", "there is no such file", "Check the name and the folder.");
  if (error == EACCES || error == EPERM)
    throw IoError(path, "", "no permission to read it", "Change the permissions of the file.");
  throw IoError(path, "", std::generic_category().message(error), "Copy the file and try again.");
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path, Monitor& monitor)
    : path_(path.string()), monitor_(monitor) {
  struct stat status = {};
  if (::stat(path_.c_str(), &status) != 0) failToOpen(path_, errno);
  if (S_ISDIR(status.st_mode))
    throw IoError(path_, "", "this is a folder, not a file", "Name a file in it.");
  if (!S_ISREG(status.st_mode))
    throw IoError(path_, "", "this is a device or a pipe, not a file",
                  "Save what comes from it to a file and name that.");
  if (status.st_size == 0)
    throw IoError(path_, "", "the file is empty", "Export or copy it again.");
  size_ = static_cast<std::size_t>(status.st_size);
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) failToOpen(path_, errno);
}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void InputFile::fill(std::size_t count) {
  if (begin_ > 0) std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (buffer_.size() < std::max(count, kBlock)) buffer_.resize(std::max(count, kBlock));
  while (end_ < std::min(count, remaining())) {
    monitor_.checkpoint();
    const std::size_t wanted =
        std::min({buffer_.size() - end_, remaining() - end_, std::size_t{4} * kBlock});
    const ssize_t got = ::read(descriptor_, buffer_.data() + end_, wanted);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      failAtByte("cannot be read: " + std::generic_category().message(errno),
                 "Check the disk or copy the file again.");
    if (got == 0)
      failAtByte("the file became shorter while it was read", "Try again once it is complete.");
    end_ += static_cast<std::size_t>(got);
  }
}

std::string_view InputFile::peek(std::size_t count) {
  if (end_ - begin_ < std::min(count, remaining())) fill(count);
  return {buffer_.data() + begin_, end_ - begin_};
}

void InputFile::skip(std::size_t count) {
  DAPPLE_CHECK(count, <=, end_ - begin_);
  begin_ += count;
  offset_ += count;
}

bool InputFile::line(std::string_view& text, char ending) {
  if (remaining() == 0) return false;
  std::size_t searched = 0, wanted = 1;
  for (;;) {
    const std::string_view view = peek(wanted);
    const auto found = view.find(ending, searched);
    const bool last = found == std::string_view::npos && view.size() == remaining();
    if (found != std::string_view::npos || last) {
      text = view.substr(0, found);
      skip(last ? view.size() : found + 1);
      ++lineNumber_;
      while (!text.empty() && text.back() == '\r') text.remove_suffix(1);
      return true;
    }
    if (view.size() > kLongestLine)
      failAtByte("a line of more than 256 MB", "This is no text; check the kind of the file.");
    searched = view.size();
    wanted = std::max(2 * view.size(), kBlock);
  }
}

void InputFile::failAtByte(const std::string& cause, const std::string& remedy) const {
  throw IoError(path_, "byte " + std::to_string(offset_), cause, remedy);
}

void InputFile::failAtLine(const std::string& cause, const std::string& remedy) const {
  throw IoError(path_, "line " + std::to_string(lineNumber_), cause, remedy);
}

}  // namespace dapple
