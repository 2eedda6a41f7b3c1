// The one ImGui context of the program: fonts, theme, keyboard map, input of each frame.
#pragma once

#include <imgui.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "app/gui/input_queue.h"
#include "app/gui/item_marks.h"

namespace dapple {

struct GuiFonts {
  ImFont* text = nullptr;   // 15 px at scale 1; the default
  ImFont* bold = nullptr;   // 15 px: headings
  ImFont* small = nullptr;  // 13 px: hints, captions
  ImFont* mono = nullptr;   // 14 px: log, paths, keys
  ImFont* title = nullptr;  // 26 px bold: the start screen
};

constexpr float kMinUiScale = 0.75f, kMaxUiScale = 4.0f;

// Made before and destroyed after everything that draws with ImGui, one at a time. Keeps no file.
class GuiContext {
 public:
  explicit GuiContext(float uiScale = 1);
  ~GuiContext();
  GuiContext(const GuiContext&) = delete;
  GuiContext& operator=(const GuiContext&) = delete;

  // The one that lives. Throws Bug when there is none.
  static GuiContext& current();

  // Logical pixels to pixels; clamped to [kMinUiScale, kMaxUiScale]. Setting it takes effect at the
  // next newFrame().
  float uiScale() const { return uiScale_; }
  void setUiScale(float scale);
  const GuiFonts& fonts() const { return fonts_; }
  // The font file in use, empty for the one built into ImGui.
  const std::filesystem::path& fontFile() const { return fontFile_; }

  InputQueue& input() { return input_; }
  ItemMarks& marks() { return marks_; }
  // Files dropped on the window in this frame; where: ImGui::GetMousePos().
  const std::vector<std::filesystem::path>& dropped() const { return dropped_; }

  // Starts a frame of `width` x `height` pixels, `seconds` after the last one. Then come the
  // widgets, then render().
  void newFrame(int width, int height, float seconds);
  const ImDrawData& render();
  // The state is not settled yet: input waits, or the last frame had an event (ImGui shows some
  // effects a frame or two later).
  bool wantsFrame() const { return input_.pending() || settling_ > 0; }

 private:
  void buildFonts();

  std::unique_ptr<ImFontAtlas> atlas_;
  ImGuiContext* context_;
  float uiScale_, wantedScale_;
  GuiFonts fonts_;
  std::filesystem::path fontFile_;
  InputQueue input_;
  ItemMarks marks_;
  std::vector<std::filesystem::path> dropped_;
  int settling_ = 3;
};

}  // namespace dapple
