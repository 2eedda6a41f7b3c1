// The regions of a document as their borders see them: which take part, how they meet, and which
// points of their neighbours a pattern reaches.
#pragma once

#include <array>
#include <vector>

#include "document/document.h"

namespace dapple {

class BorderSides {
 public:
  static constexpr std::size_t kRegions = kMostRegions + 1;

  explicit BorderSides(const Document& document);

  bool takesPart(Index i) const { return takesPart_[i]; }
  RegionId of(Index i) const { return (*document_.labels)[i]; }
  bool locked(RegionId region) const { return locked_[region]; }
  // kNoSource: takes no part.
  std::uint16_t source(RegionId region) const { return source_[region]; }
  std::uint16_t sourceAt(Index i) const {
    return takesPart_[i] ? (*document_.results.source)[i] : kNoSource;
  }

  // How two regions meet (border_blend.h).
  BorderKind kind(RegionId a, RegionId b) const;
  // How far `from` reaches into `into`, local units; 0: not at all.
  float reach(RegionId from, RegionId into) const;
  float farthestReach(RegionId from) const;

  // Points of other regions that a region's pattern reaches, nearest first, and how far inside of
  // their own they lie. Where borders are cut, the inner half of what is narrower than the band is
  // left out: the cheapest cut around a narrow region, or an arm of one, is none.
  struct Halo {
    std::vector<Index> points;
    std::vector<float> inside;  // local units from the border
  };
  // By region. Throws Cancelled.
  std::array<Halo, kRegions> halos(Monitor& monitor) const;

 private:
  std::array<std::vector<Index>, kRegions> rims(Monitor& monitor) const;
  Halo haloOf(RegionId region, std::span<const float> distance) const;
  void spareNarrow(std::span<const float> depth, std::array<Halo, kRegions>& halos,
                   Monitor& monitor) const;

  const Document& document_;
  std::vector<bool> takesPart_;
  std::array<std::uint16_t, kRegions> source_{};
  std::array<BorderKind, kRegions> kind_{};
  std::array<float, kRegions> width_{};  // local units
  std::array<bool, kRegions> locked_{};
};

}  // namespace dapple
