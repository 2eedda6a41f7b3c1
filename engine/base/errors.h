// What can go wrong, by cause. Thrown anywhere in the engine, caught in two places only: the job
// loop of the engine and main() of the command line.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace dapple {

// A value that the user gave cannot be worked with. The message names the value, its range and a
// remedy, and stands by itself. Exit code 2.
class InvalidInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A file cannot be read or written. Exit code 2.
class IoError : public std::runtime_error {
 public:
  // `where` is "byte 120", "line 7", or empty; `remedy` tells the user what to do.
  IoError(std::string path, std::string where, std::string cause, std::string remedy);

  const std::string& path() const { return path_; }
  const std::string& where() const { return where_; }

 private:
  std::string path_;
  std::string where_;
};

// The user stopped the work. Exit code 130.
class Cancelled : public std::exception {
 public:
  const char* what() const noexcept override { return "cancelled"; }
};

// A broken promise inside Dapple itself. Exit code 1.
class Bug : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

namespace detail {
[[noreturn]] void throwBug(const char* file, int line, const char* claim, const std::string& left,
                           const std::string& right);
}  // namespace detail

}  // namespace dapple

// Checks a promise of the code itself, in every build; throws Bug with both values.
#define DAPPLE_CHECK(left, op, right)                                                            \
  do {                                                                                           \
    const auto& dappleLeft = (left);                                                             \
    const auto& dappleRight = (right);                                                           \
    if (!(dappleLeft op dappleRight))                                                            \
      ::dapple::detail::throwBug(__FILE__, __LINE__, #left " " #op " " #right,                   \
                                 fmt::format("{}", dappleLeft), fmt::format("{}", dappleRight)); \
  } while (false)
