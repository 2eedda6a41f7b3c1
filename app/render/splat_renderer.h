// EWA-style surface splats: visibility, accumulation of Gaussian-weighted elliptical discs,
// normalisation (Zwicker et al. 2001; Botsch et al. 2005).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "app/render/camera.h"
#include "app/render/splats.h"

namespace dapple {

// Which columns differ from those of the last update.
struct SplatChanges {
  bool positions = true, normals = true, colours = true, radii = true, texture = true;
};

// Where a picture goes: its lower left corner in a framebuffer (0: the window's own).
struct SplatTarget {
  std::uint32_t framebuffer = 0;
  int x = 0, y = 0;
};

// Needs the current OpenGL 3.3 core context for its whole life.
class SplatRenderer {
 public:
  SplatRenderer();
  ~SplatRenderer();

  // What is drawn from now on; columns that have not changed are not uploaded again. Throws Bug
  // when the columns differ in length, or are said not to have changed but differ from the last
  // ones in length.
  void update(const SplatColumns& columns, const SplatChanges& changes = {});
  // New colours for the same n points: 4 n bytes are uploaded, nothing else happens.
  void recolour(const std::vector<vec3>& colours, const PlainPoints& plain = {});
  // The same, as packedColour() has them, in the order in which the points are drawn.
  void recolour(std::span<const std::uint32_t> packed);
  // Another swatch inside the splats of the same n points; null: none.
  void retexture(const SplatTexture* texture);
  // By update() and recolour() so far.
  std::size_t uploadedBytes() const;

  // A picture of its own: w x h x 4, opaque, 8 bits a channel, the same bytes at any number of GL
  // threads. Throws InvalidInput unless 1 <= w, h <= 16384 and the options are in range.
  Image draw(const Camera& camera, int width, int height, const SplatOptions& options);

  // The same into w x h pixels of a framebuffer, without reading it back, whatever OpenGL's state
  // is. Afterwards no program, vertex array, framebuffer or texture is bound (texture unit 0 is
  // active), blending, culling and all tests are off, and the viewport is anywhere.
  void drawInto(const SplatTarget& target, const Camera& camera, int width, int height,
                const SplatOptions& options);

 private:
  struct Pipeline;
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace dapple
