// Lines of text taken apart.
#pragma once

#include <array>
#include <string_view>

namespace dapple {

// A set of characters, asked once for each character of a file.
class CharSet {
 public:
  constexpr explicit CharSet(std::string_view members) {
    for (const char c : members) has_[static_cast<unsigned char>(c)] = true;
  }
  constexpr bool has(char c) const { return has_[static_cast<unsigned char>(c)]; }

 private:
  std::array<bool, 256> has_{};
};

// Takes the first word off `rest`, words being parted by any of `separators`; empty at the end.
inline std::string_view takeWord(std::string_view& rest, const CharSet& separators) {
  std::size_t begin = 0;
  while (begin < rest.size() && separators.has(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !separators.has(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

}  // namespace dapple
