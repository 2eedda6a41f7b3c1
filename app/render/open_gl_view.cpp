#include "app/render/open_gl_view.h"

namespace dapple {

void OpenGlView::update(const SplatColumns& columns) {
  levels_ = levelOrder(columns.positions.size());
  SplatColumns ordered = columns;
  ordered.order = &levels_.order;
  renderer_.update(ordered);
  stale_ = true;
  started_ = false;
}

void OpenGlView::recolour(std::span<const std::uint32_t> packed) {
  renderer_.recolour(packed);
  stale_ = true;
}

void OpenGlView::retexture(const SplatTexture* texture) {
  renderer_.retexture(texture);
  stale_ = true;
}

void OpenGlView::draw(const PictureRequest& shown) {
  if (!picture_ || shown.width != shown_.width || shown.height != shown_.height) {
    picture_ = makeTexture(GL_RGBA8, shown.width, shown.height);
    framebuffer_ = makeFramebuffer(*picture_, nullptr);
  }
  renderer_.drawInto({framebuffer_->id()}, shown.camera, shown.width, shown.height, shown.options);
  glFinish();  // the pacer counts what it took, not what was asked for
}

LiveView::Progress OpenGlView::frame(const Camera& camera, int width, int height,
                                     const SplatOptions& options,
                                     DetailPacer::Milliseconds budget) {
  const PictureRequest wanted(camera, width, height, options);
  const bool other = stale_ || wanted != shown_;
  if (!other && progress_ == LiveView::Progress::Complete) return progress_;
  if (!started_) pacer_.start(levels_.counts, budget);
  started_ = true;
  const std::size_t finest = levels_.counts.size() - 1;
  const std::size_t level = other ? pacer_.level() : finest;
  PictureRequest drawn = wanted;
  drawn.options.count = levels_.counts[level];
  drawn.options.enlarge = levels_.enlargement(level);
  const auto start = std::chrono::steady_clock::now();
  draw(drawn);
  if (other)
    pacer_.took(std::chrono::steady_clock::now() - start, true, levels_.counts[level], budget);
  shown_ = wanted;
  stale_ = false;
  progress_ = level == finest ? LiveView::Progress::Complete : LiveView::Progress::Coarse;
  return progress_;
}

}  // namespace dapple
