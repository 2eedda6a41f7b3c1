// The picture of splat_renderer.h without OpenGL: tiles of the picture, drawn by all threads with
// SIMD. Many times faster than OpenGL in software (dapple_render_bench), and its reference. Discs
// are taken to be ellipses with the perspective of their centres: OpenGL is exact for large near
// ones.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "app/render/camera.h"
#include "app/render/splats.h"
#include "base/parallel.h"

namespace dapple {

// Top row first.
struct Raster {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;  // red in the lowest byte, then green, blue, alpha
  // Ask for these before drawing: the point that counts most in each pixel (kNone: background) and
  // how deep its surface lies along the view axis (infinite), at its first sample.
  bool trace = false;
  std::vector<Index> points;
  std::vector<float> depths;
};

Image toImage(const Raster& raster);

// What update() and retexture() take long for, made on any thread to be shown at once (show()).
// The columns are copied; `columns.texture` is left aside. `order`: SplatColumns'.
struct SplatScene;
struct SplatTexels;
std::shared_ptr<SplatScene> makeSplatScene(const SplatColumns& columns, Workers& workers);
std::shared_ptr<const SplatTexels> makeSplatTexels(const SplatTexture& texture,
                                                   const std::vector<Index>* order,
                                                   Workers& workers);

class CpuSplatter {
 public:
  explicit CpuSplatter(Workers& workers);
  ~CpuSplatter();

  // As SplatRenderer::update(); the columns are copied.
  void update(const SplatColumns& columns);
  // New colours for the same n points, in the order of the columns.
  void recolour(const std::vector<vec3>& colours, const PlainPoints& plain = {});
  // Another swatch inside the splats of the same n points; null: none.
  void retexture(const SplatTexture* texture);

  // Without any copy: another scene, without texels; texels of as many points, or null; colours as
  // packedColour() has them, in the order in which the points are drawn (n), exchanged for those
  // that were shown (n and more).
  void show(std::shared_ptr<SplatScene> scene);
  void show(std::shared_ptr<const SplatTexels> texels);
  void swapColours(std::vector<std::uint32_t>& colours);
  void tint(std::span<const Index> points, const Tint& tint);
  // As swapColours() has them.
  std::span<const std::uint32_t> colours() const;

  // The same bytes at any number of threads and on any processor. Throws InvalidInput as
  // SplatRenderer::draw().
  void draw(const Camera& camera, int width, int height, const SplatOptions& options, Raster& out);

  // The same in steps, for a window that must not wait: begin() and then advance() until it returns
  // true, with the same raster and no change in between. Each call draws until the time is up, a
  // tile at least, from the middle outwards; what is not drawn yet shows what was there before if
  // the size is the same.
  void begin(const Camera& camera, int width, int height, const SplatOptions& options, Raster& out);
  bool advance(std::chrono::steady_clock::time_point until, Raster& out);
  // Since begin(), each once for every tile that it may be seen in.
  std::size_t splatsDrawn() const;

 private:
  struct Drawing;
  Workers& workers_;
  std::shared_ptr<SplatScene> scene_;
  std::unique_ptr<Drawing> drawing_;
};

}  // namespace dapple
