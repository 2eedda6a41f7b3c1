// Lines of text taken apart.
#pragma once

#include <string_view>

namespace dapple {

// Takes the first word off `rest`, words being parted by any of `separators`; empty at the end.
inline std::string_view takeWord(std::string_view& rest, std::string_view separators) {
  std::size_t begin = 0;
  while (begin < rest.size() && separators.find(rest[begin]) != separators.npos) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && separators.find(rest[end]) == separators.npos) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

}  // namespace dapple
