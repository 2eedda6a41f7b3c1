// The windows of a swatch, in many places and turns, ready to be searched for the ones most like a
// given window.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "synthesis/score_image.h"

namespace dapple {

inline constexpr int kPatchNumbers = 24;  // principal components kept of a window
inline constexpr int kPatchStarts = 6;    // placements that a search proposes

using PatchCode = std::array<float, kPatchNumbers>;
using PatchStarts = std::array<Placement, kPatchStarts>;

// Which code searches; all give the same bits. Best: the widest that the processor knows.
enum class SearchPath { Best, Portable };

// Windows of an image at places spread evenly over it, each in several turns: the full circle's, or
// those within the limit.
class PatchGrid {
 public:
  PatchGrid(const ScoreImage& image, TurnLimit limit, std::uint64_t seed);  // keeps the image

  const ScoreImage& image() const { return image_; }
  TurnLimit limit() const { return limit_; }
  std::size_t windows() const { return places_.size() * turns_; }
  Placement placement(std::size_t window) const;

 private:
  const ScoreImage& image_;
  TurnLimit limit_;
  std::size_t turns_;  // a place
  std::vector<vec2> places_;
  std::vector<float> firstTurns_;  // one a place
};

// The principal components of a grid's windows.
class PatchCoder {
 public:
  PatchCoder(const PatchGrid& grid, Monitor& monitor);  // throws Cancelled

  PatchCode encode(const Window& window) const;
  // 24 numbers a row from rows of 192; `numbers` is used up.
  void encodeRows(std::size_t rows, std::span<float> numbers, std::span<float> codes) const;

 private:
  std::array<float, kWindowNumbers> mean_{};
  std::vector<float> components_;  // kWindowNumbers x kPatchNumbers
};

// The codes of all windows of a grid, to be searched.
class ScorePatches {
 public:
  // Both are kept by reference. Throws Cancelled.
  ScorePatches(const PatchGrid& grid, const PatchCoder& coder, Monitor& monitor);

  // For each code the placements whose codes are nearest, nearest first, each from another part of
  // the swatch (48 parts). Throws Cancelled.
  std::vector<PatchStarts> search(std::span<const PatchCode> codes, Monitor& monitor,
                                  SearchPath path = SearchPath::Best) const;

 private:
  const PatchGrid& grid_;
  std::size_t blocks_;
  // Blocks of windows, each a number after the other for all windows of the block. The head holds
  // the first components and half the sum of their squares (huge where no window fits), the tail
  // the others.
  std::vector<float> heads_, tails_;
};

}  // namespace dapple
