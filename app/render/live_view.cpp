#include "app/render/live_view.h"

#include <algorithm>

namespace dapple {
namespace {

// Of the budget: what a picture is expected to take at most, as one that is late cannot be taken
// back, and what it may take before the next one is coarser.
constexpr double kExpected = 0.75, kTooLong = 0.9;
// Milliseconds of a picture and of a splat, of software on one processor: a first guess, and how
// much of a picture's time is due to its splats and not to its pixels.
constexpr double kPicture = 5, kSplat = 5e-5;
constexpr int kPatience = 60;  // pictures: a second or two

}  // namespace

void DetailPacer::start(const std::vector<std::size_t>& counts, Milliseconds budget) {
  levels_ = counts.size();
  level_ = 0, patience_ = 0;
  while (level_ + 1 < levels_ &&
         kPicture + kSplat * static_cast<double>(counts[level_ + 1]) <= kExpected * budget.count())
    ++level_;
}

void DetailPacer::took(Milliseconds time, bool whole, std::size_t splats, Milliseconds budget) {
  patience_ = std::max(0, patience_ - 1);
  if (!whole || time.count() > kTooLong * budget.count()) {
    tooFine_ = level_, patience_ = kPatience;
    level_ -= std::min<std::size_t>(level_, whole ? 1 : 2);
    return;
  }
  // The next level has twice the splats at most, each of half the size.
  const double finer = time.count() + std::min(time.count(), kSplat * static_cast<double>(splats));
  const bool allowed = patience_ == 0 || level_ + 1 < tooFine_;
  if (level_ + 1 < levels_ && allowed && finer <= kExpected * budget.count()) ++level_;
}

void LiveView::update(const SplatColumns& columns) {
  levels_ = levelOrder(columns.positions.size());
  SplatColumns ordered = columns;
  ordered.order = &levels_.order;
  splatter_.update(ordered);
  stale_ = true;
  started_ = false;
}

void LiveView::recolour(const std::vector<vec3>& colours, const PlainPoints& plain) {
  splatter_.recolour(colours, plain);
  stale_ = true;
}

void LiveView::retexture(const SplatTexture* texture) {
  splatter_.retexture(texture);
  stale_ = true;
}

void LiveView::show(std::shared_ptr<SplatScene> scene, LevelOrder levels) {
  splatter_.show(std::move(scene));
  levels_ = std::move(levels);
  stale_ = true;
  started_ = false;
}

void LiveView::show(std::shared_ptr<const SplatTexels> texels) {
  splatter_.show(std::move(texels));
  stale_ = true;
}

void LiveView::swapColours(std::vector<std::uint32_t>& colours) {
  splatter_.swapColours(colours);
  stale_ = true;
}

void LiveView::tint(std::span<const Index> points, const Tint& tint) {
  if (points.empty()) return;
  splatter_.tint(points, tint);
  stale_ = true;
}

LiveView::Progress LiveView::drawWhole(const PictureRequest& wanted, Clock::time_point until,
                                       DetailPacer::Milliseconds budget) {
  if (!started_) pacer_.start(levels_.counts, budget);
  started_ = true;
  const std::size_t level = pacer_.level();
  SplatOptions options = wanted.options;
  options.count = levels_.counts[level];
  options.enlarge = levels_.enlargement(level);
  const Clock::time_point start = Clock::now();
  splatter_.begin(wanted.camera, wanted.width, wanted.height, options, raster_);
  const bool whole = splatter_.advance(until, raster_);
  pacer_.took(Clock::now() - start, whole, splatter_.splatsDrawn(), budget);
  pointsDrawn_ = options.count;
  begun_ = options.count == levels_.order.size();
  return !begun_ ? Progress::Coarse : whole ? Progress::Complete : Progress::Refining;
}

LiveView::Progress LiveView::refine(Clock::time_point until) {
  if (!begun_) splatter_.begin(shown_.camera, shown_.width, shown_.height, shown_.options, raster_);
  begun_ = true;
  return splatter_.advance(until, raster_) ? Progress::Complete : Progress::Refining;
}

LiveView::Progress LiveView::frame(const Camera& camera, int width, int height,
                                   const SplatOptions& options, DetailPacer::Milliseconds budget) {
  const Clock::time_point until =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(budget);
  const PictureRequest wanted(camera, width, height, options);
  const bool other = stale_ || wanted != shown_;
  if (other || progress_ != Progress::Complete) ++version_;
  if (other) {
    progress_ = drawWhole(wanted, until, budget);
    shown_ = wanted;
    stale_ = false;
  } else if (progress_ != Progress::Complete) {
    progress_ = refine(until);
  }
  return progress_;
}

}  // namespace dapple
