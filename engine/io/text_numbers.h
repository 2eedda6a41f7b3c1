// Numbers from text as programs write them, whatever the locale.
#pragma once

#include <string_view>

namespace dapple {

// The number that the whole of `token` is: digits, a leading +, exponents, nan and inf in their
// usual spellings (Visual C++'s 1.#QNAN too). Too large is infinite, too small 0. False when the
// token is no number.
bool parseNumber(std::string_view token, double& value);
bool parseNumber(std::string_view token, float& value);

}  // namespace dapple
