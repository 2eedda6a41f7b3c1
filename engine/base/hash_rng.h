// Randomness as a pure function of (seed, ids): the same at any number of threads and in any order.
#pragma once

#include <cstdint>

namespace dapple {

// 64 well-mixed bits (the finaliser of SplitMix64; Steele, Lea, Flood 2014).
constexpr std::uint64_t mixBits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

constexpr std::uint64_t hashBits(std::uint64_t seed, std::uint64_t a, std::uint64_t b = 0,
                                 std::uint64_t c = 0) {
  return mixBits(mixBits(mixBits(mixBits(seed) ^ a) ^ b) ^ c);
}

// Uniform in [0, 1), 24 bits.
constexpr float hashUniform(std::uint64_t seed, std::uint64_t a, std::uint64_t b = 0,
                            std::uint64_t c = 0) {
  return static_cast<float>(hashBits(seed, a, b, c) >> 40) * 0x1.0p-24f;
}

// Uniform in [0, count), count >= 1.
constexpr std::uint64_t hashBelow(std::uint64_t count, std::uint64_t seed, std::uint64_t a,
                                  std::uint64_t b = 0, std::uint64_t c = 0) {
  const auto wide = static_cast<unsigned __int128>(hashBits(seed, a, b, c)) * count;
  return static_cast<std::uint64_t>(wide >> 64);
}

}  // namespace dapple
