// The program's windows without a window: fed with events by hand, drawn by OSMesa.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/gui/gui_context.h"
#include "app/gui/gui_renderer.h"
#include "app/render/gl_objects.h"
#include "app/render/offscreen.h"
#include "swatch/image.h"

namespace dapple {

// Time passes by frames of 1/60 s and never by the clock; the text cursor does not blink.
class GuiHarness {
 public:
  // `build` makes the widgets of one frame; it may be set later.
  GuiHarness(int width, int height, float uiScale = 1, std::function<void()> build = {});

  GuiContext& gui() { return gui_; }
  void setBuild(std::function<void()> build) { build_ = std::move(build); }
  void resize(int width, int height);

  // One frame, without drawing it. frames(): several. settle(): until all input is taken and its
  // effects have come.
  void frame(float seconds = 1.0f / 60);
  void frames(int count);
  void settle();
  // Frames until done() or `limit` of them; tells whether done. With a pause, for work in threads.
  bool frameUntil(const std::function<bool()>& done, int limit = 2000, int pauseMs = 2);

  // Each of these ends with the frames that take it.
  void moveMouse(ImVec2 to);
  void press(int button = 0);
  void release(int button = 0);
  void click(ImVec2 at, int button = 0, unsigned modifiers = 0);
  void doubleClick(ImVec2 at);
  // Through `steps` places on the line, one frame each.
  void drag(int button, ImVec2 from, ImVec2 to, int steps = 8, unsigned modifiers = 0);
  void wheel(float notches, unsigned modifiers = 0);
  // As a keyboard does: a key that types a character without Ctrl or Alt also types it.
  void key(Key key, unsigned modifiers = 0);
  void keyDown(Key key, unsigned modifiers = 0);
  void keyUp(Key key, unsigned modifiers = 0);
  void type(std::string_view text);
  void drop(std::vector<std::filesystem::path> paths);

  // Items by the names that markItem() gave them in the last frame.
  bool has(std::string_view id);
  // The middle of what can be seen of it. Throws when there is no such item in sight, naming those
  // that are.
  ImVec2 at(std::string_view id);
  void click(std::string_view id, int button = 0, unsigned modifiers = 0) {
    click(at(id), button, modifiers);
  }
  // Click on the field, select all, type.
  void fill(std::string_view id, std::string_view text);

  // Draws the last frame as a window does, and waits for OpenGL to be done.
  void paint();
  // The last frame drawn, 3 channels. Throws with OpenGL's messages if there are any.
  Image picture();

 private:
  void setModifiers(unsigned modifiers, bool down);
  void drawInto(const GlFramebuffer& framebuffer);

  OffscreenContext& gl_;
  GuiContext gui_;
  GuiRenderer renderer_;
  std::function<void()> build_;
  int width_, height_;
  const ImDrawData* drawn_ = nullptr;
  std::optional<GlTexture> canvas_;  // of paint()
  std::optional<GlFramebuffer> canvasBuffer_;
};

// One context for the process, made at the first call.
OffscreenContext& sharedOffscreenContext();

}  // namespace dapple
