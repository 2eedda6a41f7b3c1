// The desktop program without its window: all that is on the screen, made anew every frame from
// the engine's snapshot and what the user interface remembers.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>

#include "app/editor/scene_view.h"
#include "app/editor/swatch_library.h"
#include "app/editor/tools.h"
#include "document/engine.h"

namespace dapple {

struct EditorOptions {
  std::filesystem::path assets;  // swatches/ and scans/
  unsigned threads = 0;          // of the engine; 0: one a processor
  std::function<void()> wake;    // the engine has something new: called from its threads
};

// Needs the current OpenGL and ImGui contexts for its whole life.
class Editor {
 public:
  explicit Editor(EditorOptions options);
  ~Editor();

  // As files that are dropped on the window or named on the command line: scans, swatches (for the
  // chosen region), projects. Refused ones are reported.
  void open(const std::filesystem::path& path);

  // The widgets of one frame of `width` x `height` pixels. True: the next frame is due at once.
  bool frame(int width, int height, float uiScale);
  bool wantsToClose() const { return close_; }

  Engine& engine() { return engine_; }
  const SceneView& view() const { return view_; }

 private:
  struct Layout;

  void startScreen(const Layout& layout);
  void menuBar();
  void toolbar(const Layout& layout);
  void sidePanel(const Layout& layout);
  void regionList();
  void swatchPanel();
  void methodPanel();
  void historyPanel();
  void statusBar(const Layout& layout);
  void viewPanel(const Layout& layout);
  void navigate(const Layout& layout, bool hovered);
  void toolInput(const Layout& layout, bool hovered);
  void drawOverlays(const Layout& layout);
  void shortcuts();
  void openSample();
  void synthesize(std::optional<RegionId> region);
  void say(const std::string& text, bool error);
  void notices(const Layout& layout);
  const Region& chosen() const;
  void choose(RegionId region);

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
  RegionId chosen_ = kUnassigned;
  std::size_t errors_ = 0, notesSeen_ = 0;
  struct Notice {
    std::string text;
    bool error;
    float left;  // seconds
  };
  std::deque<Notice> notices_;
  bool close_ = false;
  bool moving_ = false;  // the camera is being moved
  bool settled_ = false;
};

}  // namespace dapple
