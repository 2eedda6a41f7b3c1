#include "regions/point_mask.h"

#include <bit>

#include "base/errors.h"

namespace dapple {

PointMask::PointMask(std::size_t points, bool all)
    : size_(points), words_((points + 63) / 64, all ? ~std::uint64_t{0} : 0) {
  if (all && size_ % 64 != 0) words_.back() = (std::uint64_t{1} << (size_ % 64)) - 1;
}

std::size_t PointMask::count() const {
  std::size_t sum = 0;
  for (const std::uint64_t word : words_) sum += static_cast<std::size_t>(std::popcount(word));
  return sum;
}

std::vector<Index> PointMask::points() const {
  std::vector<Index> out;
  out.reserve(count());
  for (std::size_t w = 0; w < words_.size(); ++w)
    for (std::uint64_t word = words_[w]; word != 0; word &= word - 1)
      out.push_back(static_cast<Index>(w * 64 + static_cast<std::size_t>(std::countr_zero(word))));
  return out;
}

PointMask& PointMask::operator|=(const PointMask& other) {
  DAPPLE_CHECK(other.size_, ==, size_);
  for (std::size_t w = 0; w < words_.size(); ++w) words_[w] |= other.words_[w];
  return *this;
}

PointMask& PointMask::operator&=(const PointMask& other) {
  DAPPLE_CHECK(other.size_, ==, size_);
  for (std::size_t w = 0; w < words_.size(); ++w) words_[w] &= other.words_[w];
  return *this;
}

PointMask& PointMask::operator-=(const PointMask& other) {
  DAPPLE_CHECK(other.size_, ==, size_);
  for (std::size_t w = 0; w < words_.size(); ++w) words_[w] &= ~other.words_[w];
  return *this;
}

void PointMask::invert() {
  *this = [&] {
    PointMask all(size_, true);
    all -= *this;
    return all;
  }();
}

PointMask maskOf(std::span<const Index> points, std::size_t size) {
  PointMask mask(size);
  for (const Index i : points) {
    if (i >= size)
      throw InvalidInput(fmt::format("point {} is selected, but the scan has {} points", i, size));
    mask.add(i);
  }
  return mask;
}

}  // namespace dapple
