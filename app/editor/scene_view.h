// The 3D view of the window: what a snapshot of the document shows, from where the user looks.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>

#include "app/render/gl_objects.h"
#include "app/render/live_view.h"
#include "app/render/open_gl_view.h"
#include "app/render/orbit_camera.h"
#include "app/render/picking.h"
#include "app/render/views.h"
#include "document/channels.h"
#include "document/engine.h"

namespace dapple {

// What draws the points; Automatic: OpenGL on graphics hardware, else the processor.
enum class DrawnBy { Automatic, Processor, OpenGl };

struct ViewSettings {
  DrawnBy drawnBy = DrawnBy::Automatic;
  View show = View::Colour;
  Shading shading = Shading::Headlight;
  bool outlines = true, strokes = true, directions = false;
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

  // Makes the picture that of the snapshot: takes what has changed since the last call. What is to
  // be drawn of a scan that was just opened is made ready on another thread (loading()). As soon as
  // its file is read its points are shown, of one size, to be looked at only (opening()).
  void follow(std::shared_ptr<const Snapshot> snapshot, const ViewSettings& settings);
  bool loading() const { return preparing_.valid(); }
  bool opening() const;
  bool empty() const { return !scene_; }

  // Points that a tool is about to select, shown as selected. Empty: none.
  void setPending(const std::vector<Index>& points);

  // Draws the picture of this size as far as the budget allows. False: nothing is left to do until
  // there is something new to follow().
  bool draw(Viewport size, DetailPacer::Milliseconds budget);

  OrbitCamera& camera() { return camera_; }
  // In the direction of the camera, all of the scan or what is selected.
  void frameAll();
  void frameSelection();
  // The picture is that of the snapshot, at full detail.
  bool complete() const;
  // Of the last picture.
  Camera pictureCamera() const { return camera_.camera(bounds()); }
  const Raster& picture() const { return live_.picture(); }
  // Of the size that was drawn, its lowest row first; 0: none yet.
  GLuint texture() const;
  // Copies the processor's picture into the framebuffer that is bound, without any drawing: in
  // software many times faster. (left, bottom): pixels. Leaves the scissor test disabled.
  void copyPicture(int left, int bottom) const;
  bool drawnByOpenGl() const { return openGl_.has_value(); }
  // Of each point, for outlines; empty when there is only one.
  const std::vector<Index>& regions() const { return regions_; }
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
  struct Scene;
  struct Texels;
  struct Made;
  void prepare();
  void takeScene();
  void followTexels();
  void showTexels(bool show);
  static std::shared_ptr<Texels> findTexels(const Document& document);
  void showVisible();
  void recolour();
  void baseColours();
  void tint(std::size_t i);
  void chooseRenderer();
  void upload();

  Workers& workers_;
  std::shared_ptr<const Snapshot> snapshot_;
  ViewSettings settings_;
  std::function<void()> ready_;
  std::shared_ptr<Made> made_;
  std::future<void> preparing_;
  std::shared_ptr<const void> wanted_;  // the scan or the points that the scene is, or will be, of
  std::shared_ptr<Scene> scene_;
  std::future<std::shared_ptr<Texels>> findingTexels_;
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
  std::uint64_t uploaded_ = 0;  // version of the picture
  std::vector<float> radii_;    // as drawn: 0 in hidden regions
  std::vector<vec3> colours_;
  PlainPoints plain_;
  PointChannels channels_;  // of the snapshot's results, made when a view asks for them
  bool channelsKnown_ = false;
  std::vector<Index> pending_, regions_;
  std::optional<HeatRange> legend_;
  std::string missing_;
  bool stale_ = false;  // the colours are to be made again
  bool complete_ = true;
};

}  // namespace dapple
