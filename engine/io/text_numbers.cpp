#include "io/text_numbers.h"

#include <charconv>
#include <limits>

namespace dapple {
namespace {

template <class T>
bool parse(std::string_view token, T& value) {
  const bool plus = token.size() > 1 && token[0] == '+' && token[1] != '-';
  const char* begin = token.data() + (plus ? 1 : 0);
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error == std::errc() && stop == end) return true;
  if (error == std::errc::invalid_argument) return false;
  const bool negative = !token.empty() && token[0] == '-';
  if (error == std::errc::result_out_of_range && stop == end) {
    // from_chars says only that it does not fit, not on which side.
    const auto exponent = token.find_first_of("eE");
    const bool small = exponent != token.npos ? token[exponent + 1] == '-'
                                              : token.find_first_not_of("+-0") == token.find('.');
    value = small ? T(0) : std::numeric_limits<T>::infinity();
    if (negative) value = -value;
    return true;
  }
  const std::string_view rest(stop, static_cast<std::size_t>(end - stop));
  if (!rest.starts_with('#')) return false;
  const bool infinite = rest.starts_with("#INF");
  value = infinite ? std::numeric_limits<T>::infinity() : std::numeric_limits<T>::quiet_NaN();
  if (negative) value = -value;
  return true;
}

}  // namespace

bool parseNumber(std::string_view token, double& value) {
  return parse(token, value);
}

bool parseNumber(std::string_view token, float& value) {
  return parse(token, value);
}

}  // namespace dapple
