// The editor at work as a person sees it: the loop of app/gui/window.cpp over OSMesa, on the clock,
// with a hand that moves the mouse 125 times a second whatever the window does.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>

#include "app/editor/editor.h"
#include "tests/gui_harness.h"

namespace dapple {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

// What one turn of the loop took.
struct FrameRecord {
  double began = 0;      // ms since the loop was made
  double wall = 0;       // ms from taking the input to the finished picture
  double cpu = 0;        // ms of it that this thread worked; the picture's other threads aside
  double process = 0;    // ms of all threads of the process meanwhile
  double paint = 0;      // of process: OpenGL's part
  double oldest = 0;     // ms since the oldest input that the picture shows was made; 0: none
  std::string activity;  // of the hand
  std::string news;      // what of the snapshot is new in the picture
};

class EditorLoop {
 public:
  EditorLoop(const std::filesystem::path& assets, int width, int height);

  Editor& editor() { return *editor_; }
  GuiHarness& gui() { return gui_; }
  double now() const;  // ms since the loop was made

  // Input that is made at a time to come (ms); the loop takes it when it gets there.
  void plan(double at, InputEvent event);
  void plan(double at, Key key, unsigned modifiers);  // pressed, and released 40 ms later
  // Along a line, a place every 8 ms; ends at the returned time.
  double planMove(double at, ImVec2 from, ImVec2 to, double duration);
  bool planned() const { return !hand_.empty(); }
  void does(std::string activity) { activity_ = std::move(activity); }

  // Sleeps as the window would, at most until the time given, then makes one frame if one is due.
  void turn(double until);
  // Turns until done() or the time is over; true: done.
  bool turnUntil(const std::function<bool()>& done, double most = 120'000);
  // Until the engine rests and the picture is complete.
  void rest();

  const std::vector<FrameRecord>& frames() const { return frames_; }
  void forget() { frames_.clear(); }

 private:
  struct Planned {
    double at;
    InputEvent event;
  };
  void sleepUntil(double at);
  void frame();
  bool inputDue();
  void noteNews(FrameRecord& record);

  std::mutex mutex_;
  std::condition_variable wake_;
  bool woken_ = false;

  const Clock::time_point start_ = Clock::now();
  GuiHarness gui_;
  std::unique_ptr<Editor> editor_;
  std::deque<Planned> hand_;
  std::string activity_ = "nothing";
  std::vector<FrameRecord> frames_;
  std::array<std::uint64_t, kParts> shown_{};  // versions of the picture's snapshot
  bool again_ = true;
  double due_ = 0, lastFrame_ = 0;
};

}  // namespace dapple
