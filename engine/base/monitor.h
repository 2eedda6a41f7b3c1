// The thread between a long function and whoever waits for it: stop, progress, preview.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <span>
#include <stop_token>

#include "base/parallel.h"
#include "base/types.h"

namespace dapple {

enum class PointState : std::uint8_t { Free, Patch, Gap, Matched };

enum class Stage { Load, Neighbours, Normals, Segments, Synthesis, Score, Render, Save };
const char* stageName(Stage stage);

struct Progress {
  Stage stage = Stage::Load;
  double fraction = 0;         // of this stage, 0..1
  double pointsPerSecond = 0;  // of this stage so far; 0 while unknown
  double secondsLeft = 0;      // of this stage; 0 while unknown
};

// Columns as they are in the middle of a synthesis; valid during the call only.
struct Preview {
  std::span<const vec3> colours;       // n
  std::span<const PointState> states;  // n
};

struct MonitorCallbacks {
  std::function<void(const Progress&)> progress;
  std::function<void(const Preview&)> preview;
};

// Holds up whoever works under a Monitor. Any thread may pause and resume.
class PauseGate {
 public:
  void pause() { paused_ = true; }
  void resume();
  bool paused() const { return paused_.load(std::memory_order_relaxed); }
  // Returns once resumed, or as soon as `stop` is requested.
  void wait(const std::stop_token& stop);

 private:
  std::atomic<bool> paused_{false};
  std::mutex mutex_;
  std::condition_variable_any wake_;
};

// Every long function takes one Monitor& last and calls checkpoint() at least every 10 ms of work.
// checkpoint(), advance() and cancelled() may be called from any thread; the callbacks come at most
// 10 times a second, one at a time; previews less often when taking them costs more than 2 % of the
// time, down to 5 a second, and to fewer where they would take more than a quarter of it.
class Monitor {
 public:
  // A `gate` outlives this; while it is paused, checkpoint() waits.
  explicit Monitor(Workers& workers, std::stop_token stop = {}, MonitorCallbacks callbacks = {},
                   PauseGate* gate = nullptr);

  Workers& workers() { return workers_; }
  bool cancelled() const { return stop_.stop_requested(); }
  void checkpoint() const;  // throws Cancelled

  // Starts a stage of `points` points (0: no rate is shown), each of which is counted `passes`
  // times.
  void begin(Stage stage, std::size_t points, std::size_t passes = 1);
  // `points` more are done. Throws Cancelled.
  void advance(std::size_t points);

  // True from time to time, and only when somebody looks: then gather and publish().
  bool wantsPreview();
  void publish(const Preview& preview);

 private:
  using Clock = std::chrono::steady_clock;
  void report();

  Workers& workers_;
  std::stop_token stop_;
  MonitorCallbacks callbacks_;
  PauseGate* gate_ = nullptr;
  std::mutex mutex_;
  Stage stage_ = Stage::Load;
  std::size_t total_ = 0, passes_ = 1;
  Clock::time_point stageStart_, previewAsked_, nextPreview_;
  std::atomic<std::size_t> done_{0};
  std::atomic<std::int64_t> nextReport_{0};
};

// How many of `points` to advance by for step i of `steps`, so that they add up to all.
inline std::size_t pointsOfStep(std::size_t points, std::size_t i, std::size_t steps) {
  return points * (i + 1) / steps - points * i / steps;
}

// Calls body(begin, end) over [0, count) in chunks of `grain`, in parallel, with a checkpoint and,
// if `counted`, an advance() per chunk. The chunks do not depend on the number of threads.
void parallelFor(Monitor& monitor, std::size_t count, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)>& body, bool counted = false);

}  // namespace dapple
