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

class ScorePatches {
 public:
  // Up to 12000 places x 16 turns (over the full circle, or evenly within the limit). `image` is
  // kept by reference. Throws Cancelled.
  ScorePatches(const ScoreImage& image, TurnLimit limit, std::uint64_t seed, Monitor& monitor);

  TurnLimit limit() const { return limit_; }
  const ScoreImage& image() const { return image_; }

  PatchCode encode(const Window& window) const;

  // For each code the placements whose codes are nearest, nearest first, each from another part of
  // the swatch (48 parts).
  std::vector<PatchStarts> search(std::span<const PatchCode> codes,
                                  SearchPath path = SearchPath::Best) const;

 private:
  using Numbers = std::array<float, kWindowNumbers>;
  Placement placementOf(std::size_t place, std::size_t turn) const;
  void choosePlaces(std::uint64_t seed);
  void findComponents(Monitor& monitor);
  void encodePlaces(Monitor& monitor);

  const ScoreImage& image_;
  TurnLimit limit_;
  std::vector<vec2> places_;
  std::vector<float> firstTurns_;  // one a place
  Numbers mean_{};
  std::vector<float> components_;  // kWindowNumbers x kPatchNumbers
  std::vector<float> codes_;       // places x kPatchNumbers x 16 turns
  std::vector<float> halfNorms_;   // places x 16: |code|^2 / 2, huge where no window fits
};

}  // namespace dapple
