// How directions on the surface are found. Apart, for whoever needs the names alone.
#pragma once

#include <cstdint>

#include "base/types.h"

namespace dapple {

enum class FieldMethod {
  Smooth,   // follows the strokes, smooth between them; upright where none is drawn
  Spread,   // each point as its neighbours nearer to a stroke
  Diffuse,  // as Smooth, by plain diffusion: slow, for comparison
  Up,       // towards `up`, whatever is drawn
  Random    // a direction of its own for each point, whatever is drawn
};

// By which turn a direction counts as the same: none but the full one, half of it, a quarter.
enum class FieldSymmetry { None, Half, Quarter };

enum class Creases {
  Carry,  // directions go on across creases
  Break   // and here each side has its own
};

struct FieldOptions {
  FieldMethod method = FieldMethod::Smooth;
  FieldSymmetry symmetry = FieldSymmetry::None;  // Smooth and Diffuse
  Creases creases = Creases::Carry;              // Smooth, Spread and Diffuse
  vec3 up{0, 1, 0};                              // local axes, any length > 0
  std::uint64_t seed = 1;                        // Random
  bool operator==(const FieldOptions&) const = default;
};

// Points whose normals differ by more are on either side of a crease (Creases::Break).
inline constexpr float kCreaseDegrees = 40;

// N of an N-fold symmetric direction: 1, 2 or 4.
constexpr int foldsOf(FieldSymmetry symmetry) {
  return symmetry == FieldSymmetry::None ? 1 : symmetry == FieldSymmetry::Half ? 2 : 4;
}

}  // namespace dapple
