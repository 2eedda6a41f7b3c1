// What a user may ask of a synthesis. The rows of document/options_table.h name, bound and explain
// every field.
#pragma once

#include <cstdint>

#include "regions/field_options.h"
#include "swatch/swatch.h"

namespace dapple {

// Auto: chosen by the swatch, before a synthesis begins (document/automatic_options.h).
enum class Method {
  Auto,
  Hybrid,
  Coordinates,
  Tiling,
  Patches,
  Match,
  Grid,
  Mapping,
  Triplanar,
  Random
};
enum class GapFill {
  Cut,    // patches are aligned, overlap, and are cut where they differ least
  Match,  // as printed: gap points are matched with the swatch
};

enum class GridAssign {
  Single,  // one point for each match
  Multi,   // all open points that the grid reaches
};

struct TextureOptions {
  Method method = Method::Auto;
  int neighbours = 25;
  int levels = 1;
  bool coherent = true;
  double scale = 1;
  GapFill gaps = GapFill::Cut;
  bool expand = false;
  int grid = 21;
  GridAssign assign = GridAssign::Multi;
  bool gridSeams = true;
  int gridNeighbours = 0;
  int passes = 1;
  double repair = 3;
  double heightWeight = 0.5;
  Tileable tileable = Tileable::Auto;
  vec3 up{0, 1, 0};  // model axes
  FieldMethod field = FieldMethod::Smooth;
  FieldSymmetry symmetry = FieldSymmetry::None;
  Creases creases = Creases::Carry;
  bool follow = true;
  double distortion = 1.6;
  double sizeLimit = 0.8;
  std::uint64_t seed = 1;
  int threads = 0;

  bool operator==(const TextureOptions&) const = default;
};

}  // namespace dapple
