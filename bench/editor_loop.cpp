#include "bench/editor_loop.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>

namespace dapple {
namespace {

constexpr double kHandStep = 8;           // ms: a mouse of 125 Hz
constexpr double kRefresh = 1000 / 60.0;  // ms: glfwSwapInterval(1)
constexpr double kLook = 100;             // ms, as app/cli/edit_command.cpp
constexpr double kHeldKey = 1000 / 30.0;  // ms, as app/gui/window.cpp
constexpr double kNever = 1e12;

double threadMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double processMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

bool anythingHeld() {
  const ImGuiIO& io = ImGui::GetIO();
  return ImGui::IsAnyMouseDown() || std::any_of(std::begin(io.KeysDown), std::end(io.KeysDown),
                                                [](bool down) { return down; });
}

}  // namespace

EditorLoop::EditorLoop(const std::filesystem::path& assets, int width, int height)
    : gui_(width, height) {
  editor_ = std::make_unique<Editor>(EditorOptions{.assets = assets, .live = false, .wake = [this] {
                                                     {
                                                       const std::lock_guard lock(mutex_);
                                                       woken_ = true;
                                                     }
                                                     wake_.notify_one();
                                                   }});
  gui_.setBuild([this, width, height] { again_ = editor_->frame(width, height); });
}

double EditorLoop::now() const {
  return Milliseconds(Clock::now() - start_).count();
}

void EditorLoop::plan(double at, InputEvent event) {
  const auto after = std::upper_bound(hand_.begin(), hand_.end(), at,
                                      [](double t, const Planned& p) { return t < p.at; });
  hand_.insert(after, {at, std::move(event)});
}

void EditorLoop::plan(double at, Key key, unsigned modifiers) {
  const auto press = [&](bool down, double when) {
    if ((modifiers & kCtrl) != 0) plan(when, KeyChanged{Key::leftCtrl, down});
    if ((modifiers & kShift) != 0) plan(when, KeyChanged{Key::leftShift, down});
  };
  press(true, at);
  plan(at, KeyChanged{key, true});
  plan(at + 40, KeyChanged{key, false});
  press(false, at + 40);
}

double EditorLoop::planMove(double at, ImVec2 from, ImVec2 to, double duration) {
  const int steps = std::max(1, static_cast<int>(duration / kHandStep));
  for (int s = 1; s <= steps; ++s) {
    const float t = static_cast<float>(s) / static_cast<float>(steps);
    plan(at + s * kHandStep,
         MouseMoved{from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)});
  }
  return at + steps * kHandStep;
}

bool EditorLoop::inputDue() {
  return gui_.gui().input().pending() || (!hand_.empty() && hand_.front().at <= now());
}

void EditorLoop::sleepUntil(double at) {
  if (!hand_.empty()) at = std::min(at, hand_.front().at);
  const auto time = start_ + std::chrono::duration_cast<Clock::duration>(
                                 Milliseconds(std::min(at, kNever / 1e3)));
  std::unique_lock lock(mutex_);
  wake_.wait_until(lock, time, [&] { return woken_; });
}

void EditorLoop::turn(double until) {
  sleepUntil(std::min(until, due_));
  bool woken = false;
  {
    const std::lock_guard lock(mutex_);
    std::swap(woken, woken_);
  }
  if (woken || inputDue() || now() >= due_) frame();
}

void EditorLoop::noteNews(FrameRecord& record) {
  constexpr std::pair<Part, const char*> kShown[] = {
      {Part::Scan, "scan"},     {Part::Labels, "labels"},   {Part::Selection, "selection"},
      {Part::Colour, "result"}, {Part::Preview, "preview"}, {Part::Regions, "regions"}};
  for (const auto& [part, name] : kShown) {
    const std::uint64_t now = editor_->view().paintedVersion(part);
    std::uint64_t& before = shown_[static_cast<std::size_t>(part)];
    if (now != before) record.news += (record.news.empty() ? "" : ", ") + std::string(name);
    before = now;
  }
}

void EditorLoop::frame() {
  const double rest = lastFrame_ + kRefresh - now();  // the swap of buffers waits for the screen
  if (rest > 0) std::this_thread::sleep_for(Milliseconds(rest));
  FrameRecord record{.began = now(), .activity = activity_};
  const double cpu = threadMilliseconds(), process = processMilliseconds();
  double oldest = kNever;
  while (!hand_.empty() && hand_.front().at <= record.began) {
    oldest = std::min(oldest, hand_.front().at);
    gui_.gui().input().push(std::move(hand_.front().event));
    hand_.pop_front();
  }
  gui_.frame(static_cast<float>(std::clamp((record.began - lastFrame_) / 1e3, 1e-4, 0.1)));
  record.paint = processMilliseconds();
  gui_.paint();
  record.paint = processMilliseconds() - record.paint;
  lastFrame_ = record.began;
  record.wall = now() - record.began;
  record.cpu = threadMilliseconds() - cpu;
  record.process = processMilliseconds() - process;
  if (oldest < kNever) record.oldest = now() - oldest;
  noteNews(record);
  frames_.push_back(std::move(record));
  const bool busy = editor_->engine().status().busy || editor_->waiting();
  double wait = gui_.gui().wantsFrame() || again_ ? 0 : busy ? kLook : kNever;
  if (anythingHeld()) wait = std::min(wait, kHeldKey);
  if (ImGui::GetIO().WantTextInput) wait = std::min(wait, 400.0);
  due_ = now() + wait;
}

bool EditorLoop::turnUntil(const std::function<bool()>& done, double most) {
  const double end = now() + most;
  while (!done() && now() < end) turn(std::min(end, now() + 1000));
  return done();
}

void EditorLoop::rest() {
  turn(now());
  const bool rested = turnUntil([&] {
    return !planned() && !gui_.gui().wantsFrame() && !editor_->engine().status().busy &&
           editor_->engine().snapshot().get() == &editor_->snapshot() && editor_->view().complete();
  });
  if (!rested) throw std::runtime_error("the editor never comes to rest");
}

}  // namespace dapple
