// LiveView's pictures by OpenGL, for graphics hardware: into a texture that a window shows.
#pragma once

#include <optional>

#include "app/render/gl_objects.h"
#include "app/render/live_view.h"
#include "app/render/splat_renderer.h"

namespace dapple {

// Needs the current OpenGL 3.3 core context for its whole life.
class OpenGlView {
 public:
  // As LiveView's.
  void update(const SplatColumns& columns);
  void recolour(std::span<const std::uint32_t> packed);  // as LiveView::swapColours() has them
  void retexture(const SplatTexture* texture);

  // The same promise as LiveView::frame(), but that the complete picture is drawn at once: in
  // software it is late. Throws InvalidInput as SplatRenderer::draw().
  LiveView::Progress frame(const Camera& camera, int width, int height, const SplatOptions& options,
                           DetailPacer::Milliseconds budget);

  bool shows(const Camera& camera, int width, int height, const SplatOptions& options) const {
    return !stale_ && shown_ == PictureRequest(camera, width, height, options);
  }

  // width x height of the last frame(), the lowest row first; 0 before.
  GLuint texture() const { return picture_ ? picture_->id() : 0; }

 private:
  void draw(const PictureRequest& shown);

  SplatRenderer renderer_;
  LevelOrder levels_;
  DetailPacer pacer_;
  bool started_ = false, stale_ = true;
  PictureRequest shown_;
  LiveView::Progress progress_ = LiveView::Progress::Coarse;
  std::optional<GlTexture> picture_;
  std::optional<GlFramebuffer> framebuffer_;
};

}  // namespace dapple
