#include "cli_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>
#include <stdexcept>

extern char** environ;

namespace dapple::testing {

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "dapple-cli-XXXXXX").string();
  if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& bytes) const {
  std::ofstream(path_ / name, std::ios::binary) << bytes;
  return *this / name;
}

std::vector<std::string> TemporaryFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(path_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

Program::Program(const Arguments& arguments) {
  std::vector<std::string> words{DAPPLE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  const std::string out = logs_ / "out", err = logs_ / "err";
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), flags, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), flags, 0600);
  // A shell starts background jobs with SIGINT ignored, and children inherit that.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t interrupts;
  sigemptyset(&interrupts);
  sigaddset(&interrupts, SIGINT);
  posix_spawnattr_setsigdefault(&attributes, &interrupts);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  const int error =
      posix_spawn(&process_, DAPPLE_PROGRAM, &files, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) throw std::runtime_error("cannot start " DAPPLE_PROGRAM);
}

void Program::signal(int number) const {
  ::kill(process_, number);
}

std::string Program::errors() const {
  return bytesOf(logs_ / "err");
}

Run Program::wait() {
  int status = 0;
  ::waitpid(process_, &status, 0);
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
  return {.code = code, .out = bytesOf(logs_ / "out"), .err = bytesOf(logs_ / "err")};
}

Run dapple(const Arguments& arguments) {
  return Program(arguments).wait();
}

std::string bytesOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> wordsOf(const std::string& line) {
  std::istringstream in(line);
  return {std::istream_iterator<std::string>(in), {}};
}

std::string asset(const std::string& name) {
  return DAPPLE_ASSETS "/" + name;
}

std::vector<Position> spherePoints(std::size_t count, double radius) {
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Position> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double at = static_cast<double>(i), y = 1 - (2 * at + 1) / static_cast<double>(count);
    const double r = std::sqrt(1 - y * y);
    points[i] = {radius * r * std::cos(at * turn), radius * y, radius * r * std::sin(at * turn)};
  }
  return points;
}

namespace {

std::string linesWith(const char* prefix, const std::vector<Position>& points) {
  std::string text;
  for (const auto& [x, y, z] : points) text += fmt::format("{}{} {} {}\n", prefix, x, y, z);
  return text;
}

}  // namespace

std::string xyzText(const std::vector<Position>& points) {
  return linesWith("", points);
}

std::string objText(const std::vector<Position>& points) {
  return linesWith("v ", points);
}

std::string plyText(const std::vector<Position>& points) {
  return fmt::format(
             "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
             "property double z\nend_header\n",
             points.size()) +
         linesWith("", points);
}

PlyText readPlyText(const std::string& path) {
  PlyText ply;
  bool inHeader = true;
  for (const std::string& line : linesOf(bytesOf(path))) {
    (inHeader ? ply.header : ply.body).push_back(line);
    if (line == "end_header") inHeader = false;
  }
  return ply;
}

}  // namespace dapple::testing
