#include "io/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/errors.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;
constexpr int kMostNames = 100;
constexpr std::size_t kLongestStem = 200;  // of 255 bytes: room for what the temporary name adds

fs::path followLinks(fs::path path) {
  std::error_code ignored;
  for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(path, ignored)); ++i) {
    const fs::path next = fs::read_symlink(path, ignored);
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  return path;
}

fs::path folderOf(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// Makes the rename itself last through a power cut. Some file systems cannot: not an error.
void syncFolder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

OutputFile::OutputFile(const fs::path& path, const std::string& extension)
    : path_(path.string()), target_(followLinks(path)) {
  struct stat status = {};
  const bool exists = ::stat(target_.c_str(), &status) == 0;
  if (!target_.has_filename() || (exists && S_ISDIR(status.st_mode)))
    throw IoError(path_, "", "this is a folder, not a file", "Add a file name.");
  if (exists && ::access(target_.c_str(), W_OK) != 0)
    throw IoError(path_, "", "the file is write-protected",
                  "Change its permissions or save under another name.");
  direct_ = exists && !S_ISREG(status.st_mode);
  if (direct_) {
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail(errno);
    return;
  }
  openTemporary(extension);
  if (exists) ::fchmod(descriptor_, status.st_mode & 07777);
}

void OutputFile::openTemporary(const std::string& extension) {
  const std::string stem =
      fmt::format(".{}.tmp-{}", target_.filename().string().substr(0, kLongestStem), ::getpid());
  for (int i = 0; i < kMostNames && descriptor_ < 0; ++i) {
    const std::string number = i == 0 ? "" : fmt::format("-{}", i);
    const fs::path name = folderOf(target_) / (stem + number + extension);
    descriptor_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) temporary_ = name;
    if (descriptor_ < 0 && errno != EEXIST) break;
  }
  if (descriptor_ < 0) fail(errno);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::fail(int error) const {
  const std::string folder = folderOf(target_).string();
  const std::string where = written_ > 0 ? fmt::format("byte {}", written_) : "";
  const std::string elsewhere = "Save to another folder.";
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      throw IoError(path_, where, "the disk is full", "Free some space or save to another disk.");
    case EFBIG:
      throw IoError(path_, where, "the file is too large for this disk", elsewhere);
    case EACCES:
    case EPERM:
      throw IoError(path_, where, "no permission to write in the folder " + folder, elsewhere);
    case EROFS:
      throw IoError(path_, where, "the disk is read-only", elsewhere);
    case ENOENT:
      throw IoError(path_, where, "there is no folder " + folder, "Create it or name another.");
    case ENOTDIR:
      throw IoError(path_, where, folder + " is not a folder", elsewhere);
    case ENAMETOOLONG:
      throw IoError(path_, where, "the name is too long", "Choose a shorter one.");
    default:
      throw IoError(path_, where, "cannot be written: " + std::generic_category().message(error),
                    elsewhere);
  }
}

void OutputFile::write(const void* bytes, std::size_t count) {
  const char* at = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t done = ::write(descriptor_, at, count);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail(errno);
    at += done;
    count -= static_cast<std::size_t>(done);
    written_ += static_cast<std::size_t>(done);
  }
}

void OutputFile::commit() {
  const bool canSync = ::fsync(descriptor_) == 0 || errno == EINVAL || errno == ENOTSUP;
  if (!canSync) fail(errno);
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0 && errno != EINTR) fail(errno);
  if (direct_) return;
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  temporary_.clear();
  syncFolder(folderOf(target_));
}

}  // namespace dapple
