// The one SIMD kernel that compares a point's neighbourhood with every place in a swatch; placement
// of patches and all exhaustive matchers use it (methods: section 3.2).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "swatch/swatch.h"

namespace dapple {

enum class SimdPath { Scalar, Avx2, Avx512Vnni };
SimdPath bestSimdPath();  // of this processor

// One neighbour with a known colour.
struct SearchTerm {
  vec2 offset;       // from the searched place, swatch pixels (x right, y down)
  vec3 colour;       // 0..1
  int layer = 0;     // which layer of the search it is compared with
  float relief = 0;  // 0..1, where the swatch has one
};

struct SearchResult {
  vec2 texel{0};            // of the best place, pixel centres at +0.5
  std::uint32_t error = 0;  // sum over terms of squared 7-bit differences
  bool found = false;       // false when no place keeps all terms inside and opaque
};

// For each phase (a, b) of P x P a plane of 7-bit pixels, RGB and relief or 0, I(x + a/P, y + b/P).
// Immutable after construction; search() may be called from many threads.
class SwatchSearch {
 public:
  // `level` of the swatch's stack, `phases` P in {1, 2, 4, 8}. `layers` >= 1: layer 0 is `level`,
  // layer 1 the next coarser one and so on; past the end of the stack its last level stands in.
  SwatchSearch(const Swatch& swatch, int level, int phases, int layers = 1);
  ~SwatchSearch();
  SwatchSearch(SwatchSearch&&) noexcept;

  std::size_t bytes() const;

  // The place x over all pixels with the least sum over terms |I(x + offset) - colour|^2 (and,
  // where the swatch has a relief, of it likewise), offsets rounded to 1/P pixel (in layers from 1
  // on, to 1/2 when P > 2). Tileable: wrapped, all places; else only where every term stays inside
  // the image; places where a term or the place itself falls on a transparent texel are skipped.
  // Ties: smallest y, then x. All paths give the same result; one that this processor lacks is
  // replaced by its best. At most 2^16 terms.
  SearchResult search(std::span<const SearchTerm> terms, SimdPath path) const;
  SearchResult search(std::span<const SearchTerm> terms) const;  // on the best path

 private:
  struct Planes;
  std::unique_ptr<Planes> planes_;
};

// The search by these numbers, kept with the swatch.
std::shared_ptr<const SwatchSearch> searchOf(const Swatch& swatch, int level, int phases,
                                             int layers = 1);

}  // namespace dapple
