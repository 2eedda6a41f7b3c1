// What the program has to say: notices that pass, a log that stays, questions, progress of work.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>

namespace dapple {

enum class NoticeKind { info, good, warning, error };

struct Notice {
  NoticeKind kind;
  std::string text;
  double at;         // seconds of ImGui's clock
  float left;        // seconds that it is still shown
  int count = 1;     // the same text again and again
  std::string time;  // "14:05:09"
};

// Belongs to the GUI thread. Errors stay on the screen until they are dismissed; the log keeps the
// newest 500.
class Notices {
 public:
  void add(NoticeKind kind, std::string text);
  void info(std::string text) { add(NoticeKind::info, std::move(text)); }
  void good(std::string text) { add(NoticeKind::good, std::move(text)); }
  void warn(std::string text) { add(NoticeKind::warning, std::move(text)); }
  void error(std::string text) { add(NoticeKind::error, std::move(text)); }

  const std::deque<Notice>& log() const { return log_; }
  // Some notice will pass: draw again at least every second.
  bool passing() const;

  // Upwards from the bottom right of the rectangle (pixels). Marks: "notice.0" (the newest),
  // "notice.0.close".
  void drawToasts(float right, float bottom);
  // The log as a panel's content, with copy and clear. Marks: "log.copy", "log.clear".
  void drawLog();

 private:
  void drawToast(std::size_t index, int place, float right, float& bottom);

  std::deque<Notice> log_;  // newest last
};

enum class Answer { yes, no, cancel };

struct Question {
  std::string title;  // "Save changes?"
  std::string text;
  std::string yes = "Yes", no = {}, cancel = "Cancel";  // empty: no such button
  bool danger = false;  // the yes button is red, and Enter is not yes
  std::function<void(Answer)> answered;
};

// A modal question; asked one after another. Enter is yes, Escape cancel (or no without it).
// Marks: "question.yes", "question.no", "question.cancel".
class Questions {
 public:
  void ask(Question question) { waiting_.push_back(std::move(question)); }
  bool isOpen() const { return !waiting_.empty(); }
  // Once a frame, outside windows. Calls answered() when all is drawn.
  void draw();

 private:
  std::deque<Question> waiting_;
};

struct ProgressView {
  std::string stage;           // "Matching, level 3 of 5"
  float fraction = -1;         // 0..1; negative: not known, the bar runs
  double pointsPerSecond = 0;  // 0: not shown
  double secondsLeft = -1;     // negative: not known
  bool paused = false, canPause = true, canStop = true;
};
enum class ProgressButton { none, pause, resume, stop, cancel };
// A row `width` pixels wide (0: all there is): stage, figures, bar, buttons. Marks:
// "progress.pause", "progress.stop", "progress.cancel".
ProgressButton progressWidget(const ProgressView& view, float width = 0);

// "45 s", "3 min 20 s", "2 h 5 min"; "1 234 567"; "12.3 k points/s".
std::string shownDuration(double seconds);
std::string shownCount(std::size_t count);
std::string shownRate(double pointsPerSecond);

}  // namespace dapple
