// Runs the program `dapple` as a shell would, in a folder of its own.
#pragma once

#include <sys/types.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace dapple::testing {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const;
  std::vector<std::string> names() const;  // sorted, hidden files too

 private:
  fs::path path_;
};

using Arguments = std::vector<std::string>;

struct Run {
  int code = -1;  // 256 + signal when a signal ended the program: no exit code can be that
  std::string out, err;
};

// A program that was started; its output goes to files outside the folder under test.
class Program {
 public:
  explicit Program(const Arguments& arguments);
  void signal(int number) const;
  std::string errors() const;  // so far
  Run wait();

 private:
  TemporaryFolder logs_;
  pid_t process_ = -1;
};

Run dapple(const Arguments& arguments);

std::string bytesOf(const std::string& path);
std::vector<std::string> linesOf(const std::string& text);
std::string asset(const std::string& name);  // a file of assets/

using Position = std::array<double, 3>;
std::vector<Position> spherePoints(std::size_t count, double radius);
std::string xyzText(const std::vector<Position>& points);
std::string plyText(const std::vector<Position>& points);  // ascii, doubles, nothing but x y z
std::string objText(const std::vector<Position>& points);

// An ascii PLY, read without the program's own reader: the lines of the header and of the body.
struct PlyText {
  std::vector<std::string> header, body;
};
PlyText readPlyText(const std::string& path);
std::vector<std::string> wordsOf(const std::string& line);

}  // namespace dapple::testing
