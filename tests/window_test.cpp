#include "app/gui/window.h"

#include <doctest/doctest.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "app/gui/theme.h"
#include "app/gui/widgets.h"
#include "app/render/gl_objects.h"

using namespace dapple;

TEST_CASE("without a display the window says what to do instead") {
  const char* display = std::getenv("DISPLAY");
  const std::string kept = display == nullptr ? "" : display;
  unsetenv("DISPLAY");
  std::string message;
  try {
    const Window window;
  } catch (const NoWindow& error) {
    message = error.what();
  }
  if (!kept.empty()) setenv("DISPLAY", kept.c_str(), 1);
  CHECK(message.find("no display") != std::string::npos);
  CHECK(message.find("dapple render") != std::string::npos);
}

TEST_CASE("a window sleeps until an event or another thread wakes it, and may refuse to close") {
  if (std::getenv("DISPLAY") == nullptr) {
    MESSAGE("skipped: no display (run it by xvfb-run)");
    return;
  }
  Window window({.title = "Dapple test", .width = 480, .height = 320});
  CHECK(window.width() >= 480);
  int frames = 0, woken = 0;
  std::jthread waker;
  window.run([&] {
    textButton("Press", ButtonKind::primary);
    ++frames;
    if (frames == 10)  // at rest by now, unless it never sleeps
      waker = std::jthread([] {
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        Window::wake();
      });
    if (frames > 10 && ++woken == 1) window.close();
    return frames < 10 ? NextFrame::now() : NextFrame::after(20);
  });
  CHECK(woken >= 1);
  CHECK(frames < 40);
  for (const std::string& message : takeGlMessages()) FAIL_CHECK(message);
}
