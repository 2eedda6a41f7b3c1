// The desktop program without its window: all that is on the screen, made anew every frame from
// the engine's snapshot and what the user interface remembers.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/editor/editor_options.h"
#include "app/editor/export_dialog.h"
#include "app/editor/region_panel.h"
#include "app/editor/scene_view.h"
#include "app/editor/strokes_view.h"
#include "app/editor/swatch_panel.h"
#include "app/editor/tools.h"
#include "app/editor/view_overlays.h"
#include "app/gui/action_views.h"
#include "app/gui/file_browser.h"
#include "app/gui/navigation.h"
#include "app/gui/notices.h"
#include "document/engine.h"

namespace dapple {

// By its name.

// Needs the current OpenGL and ImGui contexts for its whole life.
class Editor {
 public:
  explicit Editor(EditorOptions options);
  ~Editor();

  // As a file that is dropped on the window or named on the command line: a scan, a swatch (for the
  // chosen region) or a project.
  void open(const std::filesystem::path& path);

  // The widgets of one frame of `width` x `height` pixels. True: the next frame is due at once.
  bool frame(int width, int height);
  bool wantsToClose() const { return close_; }
  // The user closes the window. False: there is unsaved work, and it is asked what becomes of it.
  bool mayClose();
  // Of the window: what is open, whether it is saved, how far the job is.
  std::string title() const;
  // Something outside is waited for: a frame is due some times a second.
  bool waiting() const;

  Engine& engine() { return engine_; }
  const Snapshot& snapshot() const { return *snapshot_; }
  const SceneView& view() const { return view_; }
  const ViewOverlays& overlays() const { return overlays_; }

 private:
  struct Layout;
  enum class Asking { Nothing, Scan, Swatch, Project, SaveProject, Export, Map, Swatches };

  // editor_actions.cpp
  void addActions();
  void addFileActions();
  void addEditActions();
  void addRegionActions();
  void addVisibilityActions();
  void addStrokeActions();
  void addSynthesisActions();
  void addViewActions();
  void addCameraActions();
  void addDisplayActions();
  void addToolActions();
  void ask(Asking what);
  void answered(const std::filesystem::path& path);

  // editor_panels.cpp
  void startScreen(const Layout& layout);
  void toolbar(const Layout& layout);
  void toolOptions(const Layout& layout);
  void sidePanel(const Layout& layout);
  void regionList();
  void swatchPanel();
  void methodPanel();
  void jobPanel();
  void historyPanel(), logPanel();
  void statusBar(const Layout& layout);
  void takeMessages();
  void takeNews(const Layout& layout);
  void viewPanel(const Layout& layout);
  void showPicture(const Layout& layout);
  void navigate(const Layout& layout, bool hovered);
  void zoomWheel(const Layout& layout);
  void toolInput(const Layout& layout, bool hovered);

  void openImage(const std::filesystem::path& path);
  void openFolder(const std::filesystem::path& path);    // of one material, or of swatches
  void openDocument(const std::filesystem::path& path);  // at once, as the next
  void openSampleNow(), openSample();
  void cancel();  // the gesture, else the job
  const Region& chosen() const;
  void choose(RegionId region);
  void chooseNewRegion(const Document& before);
  // The region on which the cursor is.
  std::optional<RegionId> regionUnder(const Layout& layout) const;
  void pickStroke(vec2 place, float reach);
  void wandOptions(), strokeOptions();
  // What the sliders show of the chosen region, and what they make of it.
  RegionSettings settingsShown() const;
  void changeSettings(const RegionSettings& settings);
  void setLive(bool live);
  void chooseTool(Tool tool);
  bool hasScan() const { return snapshot_->document.scan != nullptr; }
  bool hasSelection() const;
  bool working() const { return status_.busy && !status_.job.empty(); }

  EditorOptions options_;
  Workers workers_;
  Engine engine_;
  std::shared_ptr<const Snapshot> snapshot_;
  EngineStatus status_;
  SceneView view_;
  ViewSettings settings_;
  ToolSettings tools_;
  ToolHand hand_;
  SwatchLibrary library_;
  ActionTable actions_;
  CommandSearch search_;
  ShortcutSheet sheet_;
  FileBrowser browser_;
  ExportDialog export_;
  SegmentDialog segment_;
  Asking asking_ = Asking::Nothing;
  const NavigationPreset* navigation_;
  RegionId chosen_ = kUnassigned;
  RegionPanel regionPanel_;
  SwatchPanel swatchPanel_;
  Channel askedMap_ = Channel::Roughness;  // for which a file is being chosen
  std::optional<StrokeId> stroke_;         // chosen
  std::optional<RegionSettings> editing_;  // until the engine has them
  unsigned gesture_ = 0;                   // since the mouse button went down
  bool live_ = true;
  std::string project_;                 // where the document is saved; empty: nowhere
  std::size_t errors_ = 0, notes_ = 0;  // of the engine's, that the user has been told
  Notices notices_;
  ViewOverlays overlays_;
  std::optional<CameraMotion> motion_;  // of the drag that goes on
  bool close_ = false;
  bool settled_ = false;                     // the picture is complete
  int pictureLeft_ = 0, pictureBottom_ = 0;  // in the window, pixels
  struct Memory;                             // editor_memory.h
  std::unique_ptr<Memory> memory_;
};

}  // namespace dapple
