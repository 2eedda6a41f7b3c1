#include "app/gui/window.h"

#include <glad/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "app/gui/gui_renderer.h"
#include "app/gui/theme.h"
#include "app/render/gl_objects.h"

namespace dapple {
namespace {

constexpr double kLongestWait = 3600;  // seconds; glfwWaitEventsTimeout takes no infinity
constexpr double kHeldKey = 1.0 / 30;  // seconds between frames while a key or button is held
// A frame after a long sleep must not end what is timed by frames, such as notices and tooltips.
constexpr double kLongestFrame = 0.1;

constexpr const char* kInstead =
    "Use `dapple texture` and `dapple render`, which need no window, or start a desktop (or "
    "`xvfb-run dapple`).";

std::string glfwSays() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "no reason given" : text;
}

InputQueue& inputOf(GLFWwindow* window) {
  return static_cast<GuiContext*>(glfwGetWindowUserPointer(window))->input();
}

// The key by what it types on the layout: on AZERTY the key right of Tab is A.
Key keyOf(int code, int scancode) {
  const bool printed = code >= GLFW_KEY_APOSTROPHE && code <= GLFW_KEY_GRAVE_ACCENT;
  if (const char* name = printed ? glfwGetKeyName(code, scancode) : nullptr;
      name != nullptr && name[0] > ' ' && name[0] < 127 && name[1] == '\0') {
    const char c = name[0] >= 'a' && name[0] <= 'z' ? static_cast<char>(name[0] - 32) : name[0];
    // Only what Key has a name for; another symbol stays the key of its place.
    if ((c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
        std::string_view("',-./;=[\\]`").find(c) != std::string_view::npos)
      return static_cast<Key>(c);
  }
  return code > 0 && code < kKeyCount ? static_cast<Key>(code) : Key::none;
}

void onKey(GLFWwindow* window, int code, int scancode, int action, int) {
  if (action == GLFW_REPEAT) return;  // ImGui makes its own
  inputOf(window).push(KeyChanged{keyOf(code, scancode), action == GLFW_PRESS});
}
void onChar(GLFWwindow* window, unsigned codepoint) {
  inputOf(window).push(CharacterTyped{codepoint});
}
void onButton(GLFWwindow* window, int button, int action, int) {
  inputOf(window).push(MouseButtonChanged{button, action == GLFW_PRESS});
}
void onCursor(GLFWwindow* window, double x, double y) {
  // To pixels, where they differ from the window's units.
  int width = 1, height = 1, pixelsX = 1, pixelsY = 1;
  glfwGetWindowSize(window, &width, &height);
  glfwGetFramebufferSize(window, &pixelsX, &pixelsY);
  inputOf(window).push(MouseMoved{static_cast<float>(x * pixelsX / std::max(width, 1)),
                                  static_cast<float>(y * pixelsY / std::max(height, 1))});
}
void onEnter(GLFWwindow* window, int entered) {
  if (entered == GLFW_FALSE) inputOf(window).push(MouseLeft{});
}
void onWheel(GLFWwindow* window, double x, double y) {
  inputOf(window).push(WheelTurned{static_cast<float>(x), static_cast<float>(y)});
}
void onFocus(GLFWwindow* window, int focused) {
  inputOf(window).push(FocusChanged{focused == GLFW_TRUE});
}
void onDrop(GLFWwindow* window, int count, const char** names) {
  FilesDropped drop;
  for (int i = 0; i < count; ++i) drop.paths.emplace_back(names[i]);
  inputOf(window).push(std::move(drop));
}

bool anythingHeld() {
  const ImGuiIO& io = ImGui::GetIO();
  return std::any_of(std::begin(io.KeysDown), std::end(io.KeysDown),
                     [](bool down) { return down; }) ||
         ImGui::IsAnyMouseDown();
}

using Cursors = std::array<GLFWcursor*, ImGuiMouseCursor_COUNT>;

Cursors makeCursors() {
  Cursors cursors{};
  const auto arrow = glfwCreateStandardCursor(GLFW_ARROW_CURSOR);
  cursors.fill(arrow);
  cursors[ImGuiMouseCursor_TextInput] = glfwCreateStandardCursor(GLFW_IBEAM_CURSOR);
  cursors[ImGuiMouseCursor_ResizeNS] = glfwCreateStandardCursor(GLFW_VRESIZE_CURSOR);
  cursors[ImGuiMouseCursor_ResizeEW] = glfwCreateStandardCursor(GLFW_HRESIZE_CURSOR);
  cursors[ImGuiMouseCursor_Hand] = glfwCreateStandardCursor(GLFW_HAND_CURSOR);
  return cursors;
}

}  // namespace

struct Window::Handle {
  GLFWwindow* window = nullptr;
  Cursors cursors{};
  ImGuiMouseCursor cursor = ImGuiMouseCursor_COUNT;
  std::unique_ptr<GuiRenderer> renderer;
  std::array<int, 4> restored{};  // place and size before fullscreen
  double lastFrame = 0;

  Handle() {
    if (glfwInit() == GLFW_FALSE)
      throw NoWindow(
          fmt::format("There is no display to open a window on: {}. {}", glfwSays(), kInstead));
  }
  ~Handle() {
    renderer.reset();
    glfwTerminate();  // the window and the cursors go with it
  }

  void showCursor() {
    if (glfwGetInputMode(window, GLFW_CURSOR) == GLFW_CURSOR_DISABLED) return;
    const ImGuiMouseCursor wanted = ImGui::GetMouseCursor();
    if (wanted == cursor) return;
    cursor = wanted;
    const bool hidden = wanted == ImGuiMouseCursor_None;
    glfwSetInputMode(window, GLFW_CURSOR, hidden ? GLFW_CURSOR_HIDDEN : GLFW_CURSOR_NORMAL);
    if (!hidden) glfwSetCursor(window, cursors[static_cast<std::size_t>(wanted)]);
  }
};

namespace {

GLFWwindow* makeWindow(const WindowOptions& options) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  glfwWindowHintString(GLFW_X11_CLASS_NAME, options.applicationId.c_str());
  glfwWindowHintString(GLFW_X11_INSTANCE_NAME, options.applicationId.c_str());
  int width = options.width, height = options.height;
  // Not larger than the screen: without a window manager nobody would make it fit.
  if (GLFWmonitor* monitor = glfwGetPrimaryMonitor()) {
    int x = 0, y = 0, workWidth = 0, workHeight = 0;
    float scale = 1, scaleY = 1;
    glfwGetMonitorWorkarea(monitor, &x, &y, &workWidth, &workHeight);
    glfwGetMonitorContentScale(monitor, &scale, &scaleY);
    if (workWidth > 0)
      width = std::min(width, static_cast<int>(static_cast<float>(workWidth) / scale));
    if (workHeight > 0)
      height = std::min(height, static_cast<int>(static_cast<float>(workHeight) / scaleY));
  }
  GLFWwindow* window = glfwCreateWindow(width, height, options.title.c_str(), nullptr, nullptr);
  if (window == nullptr)
    throw NoWindow(
        fmt::format("No window with OpenGL 3.3 can be opened here: {}. {}", glfwSays(), kInstead));
  return window;
}

void connectInput(GLFWwindow* window) {
  glfwSetKeyCallback(window, onKey);
  glfwSetCharCallback(window, onChar);
  glfwSetMouseButtonCallback(window, onButton);
  glfwSetCursorPosCallback(window, onCursor);
  glfwSetCursorEnterCallback(window, onEnter);
  glfwSetScrollCallback(window, onWheel);
  glfwSetWindowFocusCallback(window, onFocus);
  glfwSetDropCallback(window, onDrop);
  ImGuiIO& io = ImGui::GetIO();
  io.ClipboardUserData = window;
  io.GetClipboardTextFn = [](void* user) {
    return glfwGetClipboardString(static_cast<GLFWwindow*>(user));
  };
  io.SetClipboardTextFn = [](void* user, const char* text) {
    glfwSetClipboardString(static_cast<GLFWwindow*>(user), text);
  };
}

}  // namespace

Window::Window(const WindowOptions& options) : handle_(std::make_unique<Handle>()) {
  handle_->window = makeWindow(options);
  glfwMakeContextCurrent(handle_->window);
  if (gladLoadGL(glfwGetProcAddress) == 0)
    throw NoWindow(fmt::format("OpenGL's functions cannot be loaded. {}", kInstead));
  glfwSwapInterval(1);
  glfwSetWindowSizeLimits(handle_->window, 480, 320, GLFW_DONT_CARE, GLFW_DONT_CARE);
  handle_->cursors = makeCursors();
  gui_ = std::make_unique<GuiContext>(options.uiScale > 0 ? options.uiScale : desktopScale());
  glfwSetWindowUserPointer(handle_->window, gui_.get());
  connectInput(handle_->window);
  handle_->renderer = std::make_unique<GuiRenderer>();
  handle_->lastFrame = glfwGetTime();
}

Window::~Window() {
  gui_.reset();
}

float Window::desktopScale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(handle_->window, &x, &y);
  return std::max(x, y);
}

std::string Window::portalName() const {
  // Only GLFW's build for X11 has it, and its header would need X11's.
  using X11Window = unsigned long (*)(GLFWwindow*);
  const auto x11 = reinterpret_cast<X11Window>(::dlsym(RTLD_DEFAULT, "glfwGetX11Window"));
  const unsigned long id = x11 ? x11(handle_->window) : 0;
  return id == 0 ? std::string() : fmt::format("x11:{:x}", id);
}

void Window::setTitle(const std::string& title) {
  glfwSetWindowTitle(handle_->window, title.c_str());
}

int Window::width() const {
  int pixels = 0, other = 0;
  glfwGetFramebufferSize(handle_->window, &pixels, &other);
  return pixels;
}

int Window::height() const {
  int pixels = 0, other = 0;
  glfwGetFramebufferSize(handle_->window, &other, &pixels);
  return pixels;
}

bool Window::isFullscreen() const {
  return glfwGetWindowMonitor(handle_->window) != nullptr;
}

void Window::setFullscreen(bool fullscreen) {
  if (fullscreen == isFullscreen()) return;
  GLFWwindow* const window = handle_->window;
  auto& [x, y, width, height] = handle_->restored;
  GLFWmonitor* const monitor = glfwGetPrimaryMonitor();
  if (fullscreen && monitor != nullptr) {
    glfwGetWindowPos(window, &x, &y);
    glfwGetWindowSize(window, &width, &height);
    const GLFWvidmode* const mode = glfwGetVideoMode(monitor);
    glfwSetWindowMonitor(window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
  } else if (!fullscreen) {
    glfwSetWindowMonitor(window, nullptr, x, y, width, height, GLFW_DONT_CARE);
  }
}

void Window::close() {
  glfwSetWindowShouldClose(handle_->window, GLFW_TRUE);
  mayClose_ = {};
}

void Window::wake() {
  glfwPostEmptyEvent();
}

void Window::run(const std::function<NextFrame()>& build, const std::function<void()>& paintUnder) {
  GLFWwindow* const window = handle_->window;
  double wait = 0;
  for (;;) {
    if (wait <= 0)
      glfwPollEvents();
    else
      glfwWaitEventsTimeout(std::min(wait, kLongestWait));
    if (glfwWindowShouldClose(window) == GLFW_TRUE) {
      if (!mayClose_ || mayClose_()) return;
      glfwSetWindowShouldClose(window, GLFW_FALSE);
    }

    const double now = glfwGetTime();
    const double passed = std::min(now - std::exchange(handle_->lastFrame, now), kLongestFrame);
    const int pixelsX = std::max(width(), 1), pixelsY = std::max(height(), 1);
    gui_->newFrame(pixelsX, pixelsY, static_cast<float>(passed));
    const NextFrame next = build();
    const ImDrawData& drawn = gui_->render();

    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, pixelsX, pixelsY);
    const ImVec4& back = theme::kBackdrop;
    glClearColor(back.x, back.y, back.z, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    if (paintUnder) paintUnder();
    handle_->renderer->draw(drawn);
    handle_->showCursor();
    glfwSwapBuffers(window);

    wait = gui_->wantsFrame() ? 0 : next.seconds;
    if (anythingHeld()) wait = std::min(wait, kHeldKey);
    // The text cursor blinks.
    if (ImGui::GetIO().WantTextInput) wait = std::min(wait, 0.4);
    if (glfwWindowShouldClose(window) == GLFW_TRUE) wait = 0;  // close() was called
  }
}

}  // namespace dapple
