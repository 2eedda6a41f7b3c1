// The window on the desktop: the only part that knows GLFW.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "app/gui/gui_context.h"

namespace dapple {

// There is no display, or no OpenGL 3.3 on it. The message says what to do instead.
class NoWindow : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct WindowOptions {
  std::string title = "Dapple";
  int width = 1440, height = 900;        // logical pixels
  float uiScale = 0;                     // 0: the desktop's
  std::string applicationId = "dapple";  // the desktop's class of the window
};

// When the next frame is due at the latest; input and wake() bring it earlier.
struct NextFrame {
  double seconds;
  static NextFrame now() { return {0}; }
  static NextFrame after(double seconds) { return {seconds}; }
  static NextFrame onEvent() { return {1e9}; }
};

// One at a time, in the main thread. Makes its OpenGL context current and loads the functions.
class Window {
 public:
  // Throws NoWindow.
  explicit Window(const WindowOptions& options = {});
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GuiContext& gui() { return *gui_; }
  // What the desktop asks for (Xft.dpi); the scale in use is gui().uiScale().
  float desktopScale() const;
  // As the desktop's portals name it ("x11:3a00007"); empty where they cannot.
  std::string portalName() const;
  void setTitle(const std::string& title);
  int width() const;  // pixels
  int height() const;
  bool isFullscreen() const;
  void setFullscreen(bool fullscreen);

  // Asked when the user closes the window; true lets it go. Without one it goes.
  void onClose(std::function<bool()> mayClose) { mayClose_ = std::move(mayClose); }
  void close();  // run() returns after this frame

  // Frames until close(). `build` makes the widgets of a frame, between newFrame() and render(),
  // and may draw into framebuffers of its own; `paintUnder`, if any, paints the window's
  // framebuffer before the widgets. Sleeps when nothing happens.
  void run(const std::function<NextFrame()>& build, const std::function<void()>& paintUnder = {});

  // Brings the next frame at once; from any thread, while the window lives.
  static void wake();

 private:
  struct Handle;

  std::unique_ptr<Handle> handle_;
  std::unique_ptr<GuiContext> gui_;
  std::function<bool()> mayClose_;
};

}  // namespace dapple
