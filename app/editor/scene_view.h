// The 3D view of the window: what a snapshot of the document shows, from where the user looks.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>

#include "app/editor/scene_painter.h"
#include "app/render/gl_objects.h"
#include "app/render/live_view.h"
#include "app/render/open_gl_view.h"
#include "app/render/orbit_camera.h"
#include "app/render/picking.h"

namespace dapple {

// What draws the points; Automatic: OpenGL on graphics hardware, else the processor.
enum class DrawnBy { Automatic, Processor, OpenGl };

struct ViewSettings {
  DrawnBy drawnBy = DrawnBy::Automatic;
  View show = View::Colour;
  Shading shading = Shading::Headlight;
  bool outlines = true, strokes = true, directions = false, singularities = false;
  bool texels = true;  // the swatch inside the splats, where the view magnifies it
  vec3 background{0.071f, 0.075f, 0.082f};
  bool operator==(const ViewSettings&) const = default;
};

// Needs the window's OpenGL context for its whole life.
class SceneView {
 public:
  // `ready`, if any, is called from another thread when there is something new to follow().
  explicit SceneView(Workers& workers, std::function<void()> ready = {});
  ~SceneView();

  // Has what has changed since the last call made ready on another thread, and takes what has been
  // made. As soon as a scan's file is read its points are shown, of one size.
  void follow(std::shared_ptr<const Snapshot> snapshot, const ViewSettings& settings);
  // The points are not the document's, or not yet: they are to be looked at only.
  bool opening() const;
  bool empty() const { return !scene_; }

  // Points that a tool is about to select, shown as selected. Empty: none.
  void setPending(const std::vector<Index>& points);
  // They have been submitted: shown until the selection is.
  void submitPending();

  // Draws the picture of this size as far as the budget allows. False: nothing is left to do until
  // there is something new to follow(). `passing`: another picture will follow soon, this one need
  // not be made complete.
  bool draw(Viewport size, DetailPacer::Milliseconds budget, bool passing = false);

  OrbitCamera& camera() { return camera_; }
  // In the direction of the camera, all of the scan or what is selected.
  void frameAll();
  void frameSelection();
  // The picture is that of the snapshot, at full detail.
  bool complete() const;
  // Of the snapshot whose colours the points have.
  std::uint64_t paintedVersion(Part part) const {
    return paintedVersion_[static_cast<std::size_t>(part)];
  }
  // Of the last picture.
  Camera pictureCamera() const { return camera_.camera(bounds()); }
  const Raster& picture() const { return live_.picture(); }
  // Of the size that was drawn, its lowest row first; 0: none yet.
  GLuint texture() const;
  // Copies the processor's picture into the framebuffer that is bound, without any drawing: in
  // software many times faster. (left, bottom): pixels. Leaves the scissor test disabled.
  void copyPicture(int left, int bottom) const;
  bool drawnByOpenGl() const { return openGl_.has_value(); }
  // Of each point, for outlines; null when there is only one.
  const std::shared_ptr<const std::vector<Index>>& regions() const { return regions_; }
  const std::optional<HeatRange>& legend() const { return legend_; }
  // Why the view that was asked for cannot be shown; empty: it is.
  const std::string& missing() const { return missing_; }

  const Picker& picker() const { return picker_; }
  // What of the picture can be picked; `through`: also what is hidden.
  PickView pickView(const Camera& camera, bool through) const;
  // Of the typical splat, local units.
  float splatRadius() const;
  Bounds bounds() const;
  const Snapshot& snapshot() const { return *snapshot_; }

 private:
  struct Texels;
  struct FoundTexels;
  void ask();
  void takePainted();
  void takeGeometry(const PaintedScene& painted);
  void followTexels();
  void takeTexels();
  void showTexels(bool show);
  static std::shared_ptr<Texels> findTexels(const Document& document,
                                            const std::vector<Index>& order);
  void updateOpenGl();
  void chooseRenderer();
  void upload();

  Workers& workers_;
  std::shared_ptr<const Snapshot> snapshot_;
  ViewSettings settings_;
  std::function<void()> ready_;
  ScenePainter painter_;
  std::uint64_t asked_ = 0, painted_ = 0;  // wishes
  std::array<std::uint64_t, kParts> paintedVersion_{};
  std::shared_ptr<const SceneGeometry> scene_;
  std::future<void> findingTexels_;
  std::shared_ptr<FoundTexels> foundTexels_;
  std::shared_ptr<Texels> texels_;  // of the results that are shown, or of older ones
  bool texelsShown_ = false;
  LiveView live_;  // with OpenGL: for picking
  std::optional<OpenGlView> openGl_;
  Picker picker_;
  OrbitCamera camera_;
  Viewport size_;
  std::optional<GlTexture> texture_;
  std::optional<GlFramebuffer> textureBuffer_;  // to copy from
  std::vector<std::uint32_t> flipped_;          // the picture as OpenGL has its rows
  int textureWidth_ = 0, textureHeight_ = 0;
  std::uint64_t uploaded_ = 0;                       // version of the picture
  std::shared_ptr<const std::vector<float>> radii_;  // as drawn: 0 in hidden regions
  std::shared_ptr<const std::vector<Index>> regions_;
  std::vector<Index> pending_;
  std::optional<std::uint64_t> pendingUntil_;  // the selection has this version
  std::optional<HeatRange> legend_;
  std::string missing_;
  bool complete_ = true;
};

}  // namespace dapple
