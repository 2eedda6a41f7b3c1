// What a point near borders mixes of the patterns that reach it.
//
// A plain mix shows both patterns at once, each with half its contrast. Here each pattern's weight,
// by the distance to the border, is raised where it stands out from its swatch's mean, and lowered
// where it does not: features stay whole and pass in front of what is plain. With w the weights by
// distance, p the deviation of a pattern's colour from the mean of its swatch, in standard
// deviations,
//   weight = (w exp(a p))^g / sum over patterns of the same
// so that what has no weight gets none, and the weights are what the colours are mixed by: no gain
// is needed to know them. (Height blending of game engines, with contrast in place of height; the
// powers after Mikkelsen, Practical Real-Time Hex-Tiling, 2022, section 4.)
#pragma once

#include <optional>

#include "document/border_shares.h"

namespace dapple {

class BorderWeights {
 public:
  explicit BorderWeights(const Results& results)
      : results_(results), look_(results.sources.size()) {}

  // Sets the weights of the terms of all shares of one point, of whose own source `own` is the
  // colour; what they leave of 1 is the own one's.
  void settle(std::uint16_t ownSource, const vec3& own, std::span<BorderShare> shares);

 private:
  struct Look {
    vec3 mean{0};
    float contrast = 1;  // standard deviation
  };
  // Of one source at a point: its own, or what shares give to it.
  struct Part {
    std::size_t begin = 0, end = 0;  // shares; none: its own
    float weight = 0;
    vec3 colour{0};
    std::uint16_t source = 0;
  };

  void gather(std::uint16_t ownSource, const vec3& own, std::span<const BorderShare> shares);
  void sharpen();
  const Look& lookOf(std::uint16_t source);

  const Results& results_;
  std::vector<std::optional<Look>> look_;  // by source; when first asked for
  std::vector<Part> parts_;                // its own first
};

}  // namespace dapple
