// A shuffle that takes no memory.
#pragma once

#include "base/hash_rng.h"
#include "base/types.h"

namespace dapple {

// 0 ... n - 1 in a hashed order, computed one by one: a four-round Feistel network over the next
// even number of bits, walked until it lands inside.
class HashedOrder {
 public:
  HashedOrder(std::size_t n, std::uint64_t seed) : n_(n), seed_(seed) {
    while ((std::uint64_t{1} << (2 * half_)) < n) ++half_;
  }
  Index at(std::size_t i) const {
    std::uint64_t x = i;
    do x = permuted(x);
    while (x >= n_);
    return static_cast<Index>(x);
  }

 private:
  std::uint64_t permuted(std::uint64_t x) const {
    const std::uint64_t mask = (std::uint64_t{1} << half_) - 1;
    std::uint64_t left = x >> half_, right = x & mask;
    for (std::uint64_t round = 0; round < 4; ++round) {
      const std::uint64_t mixed = (left ^ hashBits(seed_, right, round, 7)) & mask;
      left = right;
      right = mixed;
    }
    return (left << half_) | right;
  }
  std::uint64_t n_, seed_;
  int half_ = 1;
};

}  // namespace dapple
