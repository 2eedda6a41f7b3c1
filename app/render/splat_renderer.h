// EWA-style surface splats: visibility, accumulation of Gaussian-weighted elliptical discs,
// normalisation (Zwicker et al. 2001; Botsch et al. 2005).
#pragma once

#include <memory>

#include "app/render/camera.h"
#include "app/render/splats.h"

namespace dapple {

// Needs the current OpenGL 3.3 core context for its whole life.
class SplatRenderer {
 public:
  SplatRenderer();
  ~SplatRenderer();

  // Replaces what is drawn. Throws Bug when the columns differ in length.
  void update(const SplatColumns& columns);

  // A picture of its own: w x h x 4, opaque, the same bytes at any number of GL threads. Throws
  // InvalidInput unless 1 <= w, h <= 16384 and the options are in range.
  Image draw(const Camera& camera, int width, int height, const SplatOptions& options);

 private:
  struct Pipeline;
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace dapple
