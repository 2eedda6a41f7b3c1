// The picture in a window: in time and whole while the camera moves, complete soon after it rests.
#pragma once

#include <chrono>
#include <vector>

#include "app/render/cpu_splatter.h"
#include "app/render/level_order.h"

namespace dapple {

// Chooses the level of detail that can be drawn in a given time, from what the last pictures took.
class DetailPacer {
 public:
  using Milliseconds = std::chrono::duration<double, std::milli>;

  // For levels with so many points, the coarsest first.
  void start(const std::vector<std::size_t>& counts, Milliseconds budget);
  std::size_t level() const { return level_; }
  // The picture of level() took so long for so many splats, or was stopped then.
  void took(Milliseconds time, bool whole, std::size_t splats, Milliseconds budget);

 private:
  std::size_t level_ = 0, levels_ = 0;
  std::size_t tooFine_ = 0;  // this level took too long ...
  int patience_ = 0;         // ... and is not tried again for so many pictures
};

// What a window's picture is of, at full detail.
struct PictureRequest {
  Camera camera;
  int width = 0, height = 0;
  SplatOptions options;

  PictureRequest() = default;
  PictureRequest(const Camera& from, int w, int h, const SplatOptions& how)
      : camera(from), width(w), height(h), options(how) {
    options.count = kAllPoints, options.enlarge = 1;
  }
  bool operator==(const PictureRequest&) const = default;
};

class LiveView {
 public:
  enum class Progress { Coarse, Refining, Complete };

  explicit LiveView(Workers& workers) : splatter_(workers) {}

  // As CpuSplatter's, but the columns' order is the view's own: the points are in Morton order.
  void update(const SplatColumns& columns);
  void recolour(const std::vector<vec3>& colours, const PlainPoints& plain = {});
  void retexture(const SplatTexture* texture);
  // As CpuSplatter's; the scene has been made with the columns' order of these levels.
  void show(std::shared_ptr<SplatScene> scene, LevelOrder levels);
  void show(std::shared_ptr<const SplatTexels> texels);
  void swapColours(std::vector<std::uint32_t>& colours);
  void tint(std::span<const Index> points, const Tint& tint);
  std::span<const std::uint32_t> colours() const { return splatter_.colours(); }

  // Draws into picture() what the budget allows. When the camera, size or options (their level of
  // detail aside) differ from the last call's, or the points or colours were changed since, that is
  // the whole picture, of as many points as can be drawn in time; when they do not, tile by tile
  // the complete one, until that is there. Complete: there is nothing left to do. Throws
  // InvalidInput as SplatRenderer::draw().
  Progress frame(const Camera& camera, int width, int height, const SplatOptions& options,
                 DetailPacer::Milliseconds budget);

  // The picture is this one, complete or not.
  bool shows(const Camera& camera, int width, int height, const SplatOptions& options) const {
    return !stale_ && shown_ == PictureRequest(camera, width, height, options);
  }

  // With the points' ids and depths.
  const Raster& picture() const { return raster_; }
  // Another one whenever the picture has changed.
  std::uint64_t version() const { return version_; }
  // By the last whole picture: all, or what its level of detail has.
  std::size_t pointsDrawn() const { return pointsDrawn_; }

 private:
  using Clock = std::chrono::steady_clock;

  Progress drawWhole(const PictureRequest& wanted, Clock::time_point until,
                     DetailPacer::Milliseconds budget);
  Progress refine(Clock::time_point until);

  CpuSplatter splatter_;
  LevelOrder levels_;
  DetailPacer pacer_;
  Raster raster_{.trace = true};
  PictureRequest shown_;
  std::size_t pointsDrawn_ = 0;
  std::uint64_t version_ = 0;
  bool stale_ = true;     // the points or colours have changed
  bool started_ = false;  // the pacer knows the levels
  bool begun_ = false;    // the complete picture is being drawn
  Progress progress_ = Progress::Coarse;
};

}  // namespace dapple
