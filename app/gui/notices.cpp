#include "app/gui/notices.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include "app/gui/gui_context.h"
#include "app/gui/item_marks.h"
#include "app/gui/keys.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"

namespace dapple {
namespace {

using namespace theme;

constexpr std::size_t kLogSize = 500;
constexpr int kToasts = 4;  // on the screen at once; the log has the others
constexpr float kToastWidth = 380, kShortest = 4, kLongest = 12, kSecondsPerCharacter = 0.06f;
constexpr float kFade = 0.25f;  // seconds

ImVec4 colourOf(NoticeKind kind) {
  switch (kind) {
    case NoticeKind::good:
      return kGood;
    case NoticeKind::warning:
      return kWarning;
    case NoticeKind::error:
      return kError;
    default:
      return kInfo;
  }
}

Icon iconOf(NoticeKind kind) {
  switch (kind) {
    case NoticeKind::good:
      return Icon::check;
    case NoticeKind::warning:
      return Icon::warning;
    case NoticeKind::error:
      return Icon::error;
    default:
      return Icon::info;
  }
}

std::string clockTime() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  return fmt::format("{:02}:{:02}:{:02}", local.tm_hour, local.tm_min, local.tm_sec);
}

std::string withCount(const Notice& notice) {
  return notice.count == 1 ? notice.text : fmt::format("{} ({} times)", notice.text, notice.count);
}

bool keyHit(Key key) {
  return ImGui::IsKeyPressed(static_cast<int>(key), false);
}

void drawBar(const ProgressView& view, float width) {
  const float height = px(6);
  const ImVec2 min = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(min, {min.x + width, min.y + height}, ImGui::GetColorU32(kField), height / 2);
  float from = 0, to = std::clamp(view.fraction, 0.0f, 1.0f) * width;
  if (view.fraction < 0) {  // a piece that runs through
    const auto t = static_cast<float>(std::fmod(ImGui::GetTime() * 0.6, 1.3));
    from = std::max(0.0f, (t - 0.3f) * width);
    to = std::min(width, t * width);
  }
  const ImVec4 colour = view.paused ? kTextMuted : kAccent;
  // Narrower than its rounding it would bulge.
  if (to > from)
    list.AddRectFilled({min.x + from, min.y},
                       {min.x + std::max(to, std::min(width, from + height)), min.y + height},
                       ImGui::GetColorU32(colour), height / 2);
  ImGui::Dummy({width, height});
}

std::string figuresOf(const ProgressView& view) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : "  ·  ") + part; };
  if (view.paused) add("paused");
  if (view.fraction >= 0) add(fmt::format("{:.0f} %", 100 * std::min(view.fraction, 1.0f)));
  if (view.pointsPerSecond > 0 && !view.paused) add(shownRate(view.pointsPerSecond));
  if (view.secondsLeft >= 0 && !view.paused) add(shownDuration(view.secondsLeft) + " left");
  return text;
}

ProgressButton progressButtons(const ProgressView& view) {
  ProgressButton pressed = ProgressButton::none;
  const float size = 26;
  if (view.canPause) {
    if (iconButton({.icon = view.paused ? Icon::play : Icon::pause,
                    .id = "progress.pause",
                    .tooltip = view.paused ? "Go on" : "Pause",
                    .size = size}))
      pressed = view.paused ? ProgressButton::resume : ProgressButton::pause;
    ImGui::SameLine();
  }
  if (view.canStop) {
    if (iconButton({.icon = Icon::stop,
                    .id = "progress.stop",
                    .tooltip = "Stop\nKeeps what is done.",
                    .size = size}))
      pressed = ProgressButton::stop;
    ImGui::SameLine();
  }
  if (iconButton({.icon = Icon::close,
                  .id = "progress.cancel",
                  .tooltip = "Cancel\nAs it was before.",
                  .keys = "Esc",
                  .danger = true,
                  .size = size}))
    pressed = ProgressButton::cancel;
  return pressed;
}

}  // namespace

std::string shownDuration(double seconds) {
  if (!(seconds >= 0)) return {};
  const auto whole = static_cast<long long>(std::llround(std::min(seconds, 1e9)));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600)
    return whole % 60 == 0 ? fmt::format("{} min", whole / 60)
                           : fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string shownCount(std::size_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, "\u202f");  // thin space
  return digits;
}

std::string shownRate(double perSecond) {
  if (perSecond < 1000) return fmt::format("{:.0f} points/s", perSecond);
  if (perSecond < 999950) return fmt::format("{:.1f} k points/s", perSecond / 1000);
  return fmt::format("{:.1f} M points/s", perSecond / 1e6);
}

void Notices::add(NoticeKind kind, std::string text) {
  const double now = ImGui::GetTime();
  const float seconds =
      kind == NoticeKind::error
          ? INFINITY
          : std::clamp(static_cast<float>(text.size()) * kSecondsPerCharacter, kShortest, kLongest);
  if (!log_.empty() && log_.back().text == text && log_.back().kind == kind) {
    Notice& same = log_.back();
    ++same.count;
    same.at = now;
    same.left = seconds;
    same.time = clockTime();
    return;
  }
  log_.push_back({kind, std::move(text), now, seconds, 1, clockTime()});
  if (log_.size() > kLogSize) log_.pop_front();
}

bool Notices::passing() const {
  return std::any_of(log_.begin(), log_.end(), [](const Notice& notice) {
    return notice.left > 0 && std::isfinite(notice.left);
  });
}

void Notices::drawToast(std::size_t index, int place, float right, float& bottom) {
  Notice& notice = log_[index];
  const std::string mark = fmt::format("notice.{}", place);
  const float width = px(kToastWidth), pad = px(12), side = px(18), gap = px(10);
  const std::string text = withCount(notice);
  const float textWidth = width - 2 * pad - 2 * (side + gap);
  const float textHeight = ImGui::CalcTextSize(text.c_str(), nullptr, false, textWidth).y;
  const float height = std::max(textHeight, side) + 2 * pad;
  const scope::Style fade(ImGuiStyleVar_Alpha, std::clamp(notice.left / kFade, 0.05f, 1.0f));
  const scope::Style padding(ImGuiStyleVar_WindowPadding, ImVec2{pad, pad});
  const scope::Colour back(ImGuiCol_WindowBg, kRaised);
  ImGui::SetNextWindowPos({right - width, bottom - height});
  ImGui::SetNextWindowSize({width, height});
  bottom -= height + px(kGap);
  const scope::Window window(fmt::format("##notice{}", place).c_str(), nullptr,
                             ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                 ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing |
                                 ImGuiWindowFlags_NoSavedSettings);
  const ImVec2 min = ImGui::GetWindowPos();
  markRectangle(mark, min, {min.x + width, min.y + height});
  // Who reads it keeps it.
  if (!ImGui::IsWindowHovered(ImGuiHoveredFlags_ChildWindows))
    notice.left -= ImGui::GetIO().DeltaTime;
  else
    notice.left = std::max(notice.left, 1.0f);
  iconItem(iconOf(notice.kind), colourOf(notice.kind), side);
  ImGui::SameLine(0, gap);
  {
    const scope::WrappedText wrapped(ImGui::GetCursorPosX() + textWidth);
    ImGui::TextUnformatted(text.c_str());
  }
  ImGui::SetCursorPos({width - pad - side, pad - px(2)});
  if (iconButton({.icon = Icon::close, .id = (mark + ".close").c_str(), .size = 22}))
    notice.left = 0;
}

void Notices::drawToasts(float right, float bottom) {
  int place = 0;
  for (std::size_t i = log_.size(); i-- > 0;) {
    if (log_[i].left <= 0) continue;
    if (place == kToasts) {  // pushed out by newer ones; the log has it
      log_[i].left = 0;
      continue;
    }
    drawToast(i, place++, right, bottom);
  }
}

void Notices::drawLog() {
  std::string all;
  if (textButton("Copy", ButtonKind::normal, Icon::copy, 0, "log.copy")) {
    for (const Notice& notice : log_) all += notice.time + "  " + withCount(notice) + "\n";
    ImGui::SetClipboardText(all.c_str());
  }
  ImGui::SameLine();
  if (textButton("Clear", ButtonKind::quiet, Icon::trash, 0, "log.clear")) log_.clear();
  const scope::Colour field(ImGuiCol_ChildBg, kField);
  const scope::Style padding(ImGuiStyleVar_WindowPadding, px(kGap, kGap));
  const scope::Child list("##log", {0, 0}, true, ImGuiWindowFlags_AlwaysUseWindowPadding);
  const scope::Style spacing(ImGuiStyleVar_ItemSpacing, px(kGap, kGapSmall));
  if (log_.empty()) mutedText("Nothing has happened yet.");
  for (const Notice& notice : log_) {
    const float side = px(14);
    iconItem(iconOf(notice.kind), colourOf(notice.kind), side);
    ImGui::SameLine();
    mutedText(notice.time);
    ImGui::SameLine();
    const scope::WrappedText wrapped;
    const std::string text = withCount(notice);
    ImGui::TextUnformatted(text.c_str());
  }
  // Follows what comes unless one scrolled up.
  if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY()) ImGui::SetScrollHereY(1);
}

void Questions::draw() {
  constexpr const char* kName = "##question";
  if (waiting_.empty()) return;
  const bool fresh = !ImGui::IsPopupOpen(kName);
  if (fresh) ImGui::OpenPopup(kName);
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y * 0.4f}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::min(px(440), display.x - 2 * px(kGap)), 0});
  std::optional<Answer> answer;
  {
    const scope::Style padding(ImGuiStyleVar_WindowPadding, px(20, 18));
    const scope::Modal modal(
        kName, nullptr,
        ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove);
    if (!modal) return;
    const Question& question = waiting_.front();
    heading(question.title.c_str());
    {
      const scope::WrappedText wrapped;
      const scope::Colour muted(ImGuiCol_Text, kTextMuted);
      ImGui::TextUnformatted(question.text.c_str());
    }
    ImGui::Dummy({0, px(kGapSmall)});
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const auto widthOf = [](const std::string& label) {
      return label.empty() ? 0
                           : std::max(px(88), ImGui::CalcTextSize(label.c_str()).x + 2 * px(16));
    };
    const float yes = widthOf(question.yes), no = widthOf(question.no),
                cancel = widthOf(question.cancel);
    alignRight(yes + (no > 0 ? no + gap : 0) + (cancel > 0 ? cancel + gap : 0));
    if (cancel > 0) {
      if (textButton(question.cancel.c_str(), ButtonKind::quiet, Icon::none, cancel,
                     "question.cancel"))
        answer = Answer::cancel;
      ImGui::SameLine();
    }
    if (no > 0) {
      if (textButton(question.no.c_str(), ButtonKind::normal, Icon::none, no, "question.no"))
        answer = Answer::no;
      ImGui::SameLine();
    }
    if (textButton(question.yes.c_str(), question.danger ? ButtonKind::danger : ButtonKind::primary,
                   Icon::none, yes, "question.yes"))
      answer = Answer::yes;
    if (!fresh && keyHit(Key::escape)) answer = cancel > 0 ? Answer::cancel : Answer::no;
    if (!fresh && !question.danger && (keyHit(Key::enter) || keyHit(Key::numpadEnter)))
      answer = Answer::yes;
    if (answer) ImGui::CloseCurrentPopup();
  }
  if (!answer) return;
  // Off the list first: what is called may ask again.
  const Question question = std::move(waiting_.front());
  waiting_.pop_front();
  if (question.answered) question.answered(*answer);
}

ProgressButton progressWidget(const ProgressView& view, float width) {
  const scope::Group group;
  if (width <= 0) width = ImGui::GetContentRegionAvail().x;
  const scope::Style spacing(ImGuiStyleVar_ItemSpacing, px(kGapSmall, kGapSmall));
  const float buttons =
      (1.0f + (view.canPause ? 1 : 0) + (view.canStop ? 1 : 0)) * (px(26) + px(kGapSmall));
  const ImVec2 start = ImGui::GetCursorPos();
  {
    const scope::Group words;
    clippedText(view.stage, width - buttons);
    mutedText(figuresOf(view));
  }
  const float below = ImGui::GetCursorPosY();
  ImGui::SetCursorPos({start.x + width - buttons + px(kGapSmall), start.y + px(4)});
  const ProgressButton pressed = progressButtons(view);
  ImGui::SetCursorPos({start.x, below});
  drawBar(view, width);
  return pressed;
}

}  // namespace dapple
