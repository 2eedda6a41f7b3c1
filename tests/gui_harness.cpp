#include "gui_harness.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include "app/gui/theme.h"

namespace dapple {
namespace {

constexpr float kNoDoubleClick = 0.5f;  // seconds between two clicks that are two
constexpr int kSettleLimit = 1000;

// What the key types on an American keyboard; 0 for nothing.
char typedBy(Key key, bool shift) {
  const int code = static_cast<int>(key);
  if (key >= Key::a && key <= Key::z) return static_cast<char>(shift ? code : code + 32);
  if (code < 32 || code > 96) return 0;
  if (!shift) return static_cast<char>(code);
  constexpr std::string_view kPlain = "',-./0123456789;=[\\]`";
  constexpr std::string_view kShifted = "\"<_>?)!@#$%^&*(:+{|}~";
  const std::size_t at = kPlain.find(static_cast<char>(code));
  return at == std::string_view::npos ? static_cast<char>(code) : kShifted[at];
}

constexpr std::pair<unsigned, Key> kModifierKeys[] = {
    {kCtrl, Key::leftCtrl}, {kShift, Key::leftShift}, {kAlt, Key::leftAlt}};

}  // namespace

OffscreenContext& sharedOffscreenContext() {
  static OffscreenContext context;
  return context;
}

GuiHarness::GuiHarness(int width, int height, float uiScale, std::function<void()> build)
    : gl_(sharedOffscreenContext()),
      gui_(uiScale),
      build_(std::move(build)),
      width_(width),
      height_(height) {
  ImGui::GetIO().ConfigInputTextCursorBlink = false;
}

void GuiHarness::resize(int width, int height) {
  width_ = width;
  height_ = height;
  canvas_.reset(), canvasBuffer_.reset();
  settle();
}

void GuiHarness::frame(float seconds) {
  gui_.newFrame(width_, height_, seconds);
  if (build_) build_();
  drawn_ = &gui_.render();
}

void GuiHarness::frames(int count) {
  for (int i = 0; i < count; ++i) frame();
}

void GuiHarness::settle() {
  frame();
  for (int i = 0; gui_.wantsFrame(); ++i) {
    if (i == kSettleLimit) throw std::runtime_error("the interface never comes to rest");
    frame();
  }
}

bool GuiHarness::frameUntil(const std::function<bool()>& done, int limit, int pauseMs) {
  for (int i = 0; i < limit && !done(); ++i) {
    frame();
    if (pauseMs > 0) std::this_thread::sleep_for(std::chrono::milliseconds(pauseMs));
  }
  return done();
}

void GuiHarness::setModifiers(unsigned modifiers, bool down) {
  for (const auto& [bit, key] : kModifierKeys)
    if ((modifiers & bit) != 0) gui_.input().push(KeyChanged{key, down});
}

void GuiHarness::moveMouse(ImVec2 to) {
  gui_.input().push(MouseMoved{to.x, to.y});
  frame();
}

void GuiHarness::press(int button) {
  gui_.input().push(MouseButtonChanged{button, true});
  frame();
}

void GuiHarness::release(int button) {
  gui_.input().push(MouseButtonChanged{button, false});
  settle();
}

void GuiHarness::click(ImVec2 at, int button, unsigned modifiers) {
  moveMouse(at);
  frame(kNoDoubleClick);
  setModifiers(modifiers, true);
  press(button);
  release(button);
  setModifiers(modifiers, false);
  settle();
}

void GuiHarness::doubleClick(ImVec2 at) {
  moveMouse(at);
  frame(kNoDoubleClick);
  press();
  gui_.input().push(MouseButtonChanged{0, false});
  frame();
  press();
  release();
}

void GuiHarness::drag(int button, ImVec2 from, ImVec2 to, int steps, unsigned modifiers) {
  moveMouse(from);
  frame(kNoDoubleClick);
  setModifiers(modifiers, true);
  press(button);
  for (int i = 1; i <= steps; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(steps);
    moveMouse({from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)});
  }
  release(button);
  setModifiers(modifiers, false);
  settle();
}

void GuiHarness::wheel(float notches, unsigned modifiers) {
  setModifiers(modifiers, true);
  gui_.input().push(WheelTurned{0, notches});
  settle();
  setModifiers(modifiers, false);
  settle();
}

void GuiHarness::keyDown(Key key, unsigned modifiers) {
  setModifiers(modifiers, true);
  gui_.input().push(KeyChanged{key, true});
  const char typed = typedBy(key, (modifiers & kShift) != 0);
  if (typed != 0 && (modifiers & (kCtrl | kAlt)) == 0)
    gui_.input().push(CharacterTyped{static_cast<unsigned char>(typed)});
  frame();
}

void GuiHarness::keyUp(Key key, unsigned modifiers) {
  gui_.input().push(KeyChanged{key, false});
  setModifiers(modifiers, false);
  settle();
}

void GuiHarness::key(Key key, unsigned modifiers) {
  keyDown(key, modifiers);
  keyUp(key, modifiers);
}

void GuiHarness::type(std::string_view text) {
  gui_.input().pushText(text);
  settle();
}

void GuiHarness::drop(std::vector<std::filesystem::path> paths) {
  gui_.input().push(FilesDropped{std::move(paths)});
  settle();
}

bool GuiHarness::has(std::string_view id) {
  const ItemMark* mark = gui_.marks().find(id);
  return mark != nullptr && mark->visible;
}

ImVec2 GuiHarness::at(std::string_view id) {
  const ItemMark* mark = gui_.marks().find(id);
  if (mark == nullptr || !mark->visible) {
    std::vector<std::string> names;
    for (const auto& [name, other] : gui_.marks().all())
      if (other.visible) names.push_back(name);
    std::sort(names.begin(), names.end());
    throw std::runtime_error(fmt::format("no item \"{}\" in sight{}; in sight are {}", id,
                                         mark == nullptr ? "" : " (it is scrolled or clipped away)",
                                         fmt::join(names, ", ")));
  }
  return {(mark->min.x + mark->max.x) / 2, (mark->min.y + mark->max.y) / 2};
}

void GuiHarness::fill(std::string_view id, std::string_view text) {
  click(id);
  key(Key::a, kCtrl);
  type(text);
}

void GuiHarness::drawInto(const GlFramebuffer& framebuffer) {
  if (drawn_ == nullptr) frame();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  const ImVec4 back = theme::kBackdrop;
  glClearColor(back.x, back.y, back.z, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  renderer_.draw(*drawn_);
}

void GuiHarness::paint() {
  if (!canvas_) {
    canvas_ = makeTexture(GL_RGBA8, width_, height_);
    canvasBuffer_ = makeFramebuffer(*canvas_, nullptr);
  }
  drawInto(*canvasBuffer_);
  glFinish();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

Image GuiHarness::picture() {
  GlTexture colour = makeTexture(GL_RGBA8, width_, height_);
  GlFramebuffer framebuffer = makeFramebuffer(colour, nullptr);
  drawInto(framebuffer);

  Image image{width_, height_, 3,
              std::vector<float>(static_cast<std::size_t>(width_) * height_ * 3)};
  std::vector<unsigned char> bytes(static_cast<std::size_t>(width_) * height_ * 4);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) =
            bytes[(static_cast<std::size_t>(height_ - 1 - y) * width_ + x) * 4 + c] / 255.0f;
  const std::vector<std::string> messages = takeGlMessages();
  if (!messages.empty())
    throw std::runtime_error(fmt::format("OpenGL says: {}", fmt::join(messages, "; ")));
  return image;
}

}  // namespace dapple
