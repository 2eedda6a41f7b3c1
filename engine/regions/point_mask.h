// A set of a scan's points, one bit each: what selections and brushes are made of.
#pragma once

#include <span>
#include <vector>

#include "base/types.h"

namespace dapple {

class PointMask {
 public:
  PointMask() = default;
  explicit PointMask(std::size_t points, bool all = false);

  std::size_t size() const { return size_; }
  bool has(std::size_t i) const { return words_[i / 64] >> (i % 64) & 1; }
  void add(std::size_t i) { words_[i / 64] |= std::uint64_t{1} << (i % 64); }
  void remove(std::size_t i) { words_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }

  std::size_t count() const;
  std::vector<Index> points() const;  // ascending

  // Masks of the same size.
  PointMask& operator|=(const PointMask& other);
  PointMask& operator&=(const PointMask& other);
  PointMask& operator-=(const PointMask& other);
  void invert();

  // 64 points a word, the lowest bit first; the bits beyond size() are 0.
  std::span<const std::uint64_t> words() const { return words_; }
  bool operator==(const PointMask&) const = default;

 private:
  std::size_t size_ = 0;
  std::vector<std::uint64_t> words_;
};

// Throws InvalidInput when a point is not below `size`.
PointMask maskOf(std::span<const Index> points, std::size_t size);

}  // namespace dapple
