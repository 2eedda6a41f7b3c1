#include "base/errors.h"

namespace dapple {
namespace {

std::string describe(const std::string& path, const std::string& where, const std::string& cause,
                     const std::string& remedy) {
  std::string text = path;
  if (!where.empty()) text += ", " + where;
  text += ": " + cause;
  if (!remedy.empty()) text += ". " + remedy;
  return text;
}

}  // namespace

IoError::IoError(std::string path, std::string where, std::string cause, std::string remedy)
    : std::runtime_error(describe(path, where, cause, remedy)),
      path_(std::move(path)),
      where_(std::move(where)) {}

namespace detail {

void throwBug(const char* file, int line, const char* claim, const std::string& left,
              const std::string& right) {
  throw Bug(fmt::format("{}:{}: expected {}, but left is {} and right is {}", file, line, claim,
                        left, right));
}

}  // namespace detail
}  // namespace dapple
