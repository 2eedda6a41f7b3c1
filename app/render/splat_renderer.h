// EWA-style surface splats: visibility, accumulation of Gaussian-weighted elliptical discs,
// normalisation (Zwicker et al. 2001; Botsch et al. 2005).
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "app/render/camera.h"
#include "base/monitor.h"
#include "swatch/image.h"

namespace dapple {

// What is drawn: n elements a column, borrowed for the call of update() only.
struct SplatColumns {
  const std::vector<vec3>& positions;
  const std::vector<vec3>& normals;
  const std::vector<vec3>& colours;  // 0..1, drawn as they are
  const std::vector<float>& radii;   // local units
};

struct SplatOptions {
  bool shading = false;  // headlight
  glm::vec3 background{1.0f, 1.0f, 1.0f};
  float lowPass = 1.0f;  // pixels: radius of the screen-space filter
};

// Needs a current OpenGL 3.3 core context for its whole life.
class SplatRenderer {
 public:
  SplatRenderer();
  ~SplatRenderer();

  void update(const SplatColumns& columns);
  // Draws w x h pixels into an image of its own and reads it back: RGBA.
  Image draw(const Camera& camera, int width, int height, const SplatOptions& options);

 private:
  struct Pipeline;
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace dapple
