// Bends what is laid into the swatch so that its features meet those around it.
#pragma once

#include <span>
#include <vector>

#include "swatch/texel_reader.h"
#include "synthesis/placement_box.h"

namespace dapple {

// 2-D displacements at the nodes of a lattice of squares, bilinear between them, the border's
// beyond it; none at all when made by default.
class DisplacementLattice {
 public:
  DisplacementLattice() = default;
  // Of 0 over the box, nodes at most `cell` pixels apart unless there would be more than 9 a side.
  DisplacementLattice(const PlacementBox& box, float cell);

  struct Weights {  // of the four nodes around a place
    std::size_t node[4];
    float weight[4];
  };
  Weights weightsAt(vec2 place) const;
  vec2 at(vec2 place) const;

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::span<vec2> nodes() { return nodes_; }  // columns() x rows(), pixels
  std::span<const vec2> nodes() const { return nodes_; }

 private:
  vec2 low_{0}, perPixel_{0};
  int columns_ = 0, rows_ = 0;
  std::vector<vec2> nodes_;
};

// A place of the flattened domain, and where in the swatch that lies which is seen there.
struct BorderSample {
  vec2 place;  // pixels
  vec2 texel;  // swatch pixels
};

struct RelaxationOptions {
  float cell = 12;          // pixels between nodes
  float smoothness = 0.4f;  // weight of differences between nodes, of the data's
  float decay = 0.01f;      // weight of the displacements themselves
  float most = 5;           // pixels, along each axis
};

struct Relaxation {
  DisplacementLattice lattice;
  float before = 0, after = 0;  // root mean square colour difference per channel; never more
};

// `fine` and `coarse` read the swatch as it is compared and blurred further; `placement` is where
// the domain's 0 lies. Displacements may lead out of a swatch that does not tile.
Relaxation relaxBorder(const TexelReader& coarse, const TexelReader& fine,
                       std::span<const BorderSample> samples, vec2 placement,
                       const RelaxationOptions& options = {});

}  // namespace dapple
