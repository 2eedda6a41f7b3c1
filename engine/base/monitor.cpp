#include "base/monitor.h"

#include <algorithm>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::chrono::milliseconds kInterval{100};
// From one preview to the next: 5 a second, with a margin for what is not asked in time.
constexpr std::chrono::milliseconds kLongestInterval{130};
constexpr int kPreviewShare = 50;  // 1 / 50 of the time
// 1 / 4 of it, however long that makes the interval: on a busy machine, or of a large scan,
// previews would leave no time for what they show.
constexpr int kMostPreviewShare = 4;

}  // namespace

const char* stageName(Stage stage) {
  switch (stage) {
    case Stage::Load:
      return "load";
    case Stage::Neighbours:
      return "neighbours";
    case Stage::Normals:
      return "normals";
    case Stage::Segments:
      return "segments";
    case Stage::Synthesis:
      return "synthesis";
    case Stage::Score:
      return "score";
    case Stage::Render:
      return "render";
    case Stage::Save:
      return "save";
  }
  return "unknown";
}

void PauseGate::resume() {
  {
    const std::lock_guard lock(mutex_);
    paused_ = false;
  }
  wake_.notify_all();
}

void PauseGate::wait(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, stop, [&] { return !paused(); });
}

Monitor::Monitor(Workers& workers, std::stop_token stop, MonitorCallbacks callbacks,
                 PauseGate* gate)
    : workers_(workers), stop_(std::move(stop)), callbacks_(std::move(callbacks)), gate_(gate) {
  stageStart_ = Clock::now();
}

void Monitor::checkpoint() const {
  if (gate_ && gate_->paused()) gate_->wait(stop_);
  if (cancelled()) throw Cancelled();
}

void Monitor::begin(Stage stage, std::size_t points, std::size_t passes) {
  checkpoint();
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  total_ = points * passes;
  passes_ = passes;
  done_ = 0;
  stageStart_ = Clock::now();
  report();
}

void Monitor::advance(std::size_t points) {
  checkpoint();
  const std::size_t before = done_.fetch_add(points, std::memory_order_relaxed);
  if (!callbacks_.progress) return;
  // The end of a stage is always told, else at most every interval.
  const bool ends = before < total_ && before + points >= total_;
  const std::int64_t now = Clock::now().time_since_epoch().count();
  if (!ends && now < nextReport_.load(std::memory_order_relaxed)) return;
  std::unique_lock lock(mutex_, std::defer_lock);
  if (ends)
    lock.lock();
  else if (!lock.try_lock())
    return;
  report();
}

void Monitor::report() {
  if (!callbacks_.progress) return;
  const auto now = Clock::now();
  nextReport_ = (now + kInterval).time_since_epoch().count();
  const double seconds = std::chrono::duration<double>(now - stageStart_).count();
  const double done = static_cast<double>(done_.load(std::memory_order_relaxed));
  Progress progress{.stage = stage_};
  if (total_ > 0) {
    progress.fraction = std::min(1.0, done / static_cast<double>(total_));
    if (seconds > 0.02 && done > 0) {
      progress.pointsPerSecond = done / static_cast<double>(passes_) / seconds;
      progress.secondsLeft = seconds * (1 - progress.fraction) / progress.fraction;
    }
  }
  callbacks_.progress(progress);
}

bool Monitor::wantsPreview() {
  if (!callbacks_.preview) return false;
  previewAsked_ = Clock::now();
  return previewAsked_ >= nextPreview_;
}

void Monitor::publish(const Preview& preview) {
  if (!callbacks_.preview) return;
  callbacks_.preview(preview);
  const Clock::duration took = Clock::now() - previewAsked_;
  const auto wished =
      std::clamp<Clock::duration>(kPreviewShare * took, kInterval, kLongestInterval);
  nextPreview_ = previewAsked_ + std::max<Clock::duration>(wished, kMostPreviewShare * took);
}

void parallelFor(Monitor& monitor, std::size_t count, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)>& body, bool counted) {
  const std::size_t chunks = (count + grain - 1) / grain;
  monitor.workers().run(chunks, [&](std::size_t chunk) {
    monitor.checkpoint();
    const std::size_t begin = chunk * grain, end = std::min(count, begin + grain);
    body(begin, end);
    if (counted) monitor.advance(end - begin);
  });
}

}  // namespace dapple
