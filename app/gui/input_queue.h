// What the user does, in the order done, fed to ImGui without losing any of it. ImGui 1.86 sees
// only the state at the start of a frame: a key pressed and released between two frames would
// never have been. So one frame takes events up to the second that would hide the first.
#pragma once

#include <deque>
#include <filesystem>
#include <string_view>
#include <variant>
#include <vector>

#include "app/gui/keys.h"

struct ImGuiIO;

namespace dapple {

struct MouseMoved {
  float x, y;  // pixels from the window's top left, fractions kept
};
struct MouseLeft {};  // the cursor is outside the window
struct MouseButtonChanged {
  int button;  // 0 left, 1 right, 2 middle
  bool down;
};
struct WheelTurned {
  float x, y;  // notches, up positive
};
struct KeyChanged {
  Key key;
  bool down;
};
struct CharacterTyped {
  unsigned codepoint;
};
struct FocusChanged {
  bool focused;
};
struct FilesDropped {
  std::vector<std::filesystem::path> paths;
};
using InputEvent = std::variant<MouseMoved, MouseLeft, MouseButtonChanged, WheelTurned, KeyChanged,
                                CharacterTyped, FocusChanged, FilesDropped>;

class InputQueue {
 public:
  void push(InputEvent event) { events_.push_back(std::move(event)); }
  // Each character of UTF-8 text.
  void pushText(std::string_view text);
  // Events wait: another frame is due at once.
  bool pending() const { return !events_.empty(); }
  // Hands ImGui what one frame can take; returns the files dropped among it.
  std::vector<std::filesystem::path> apply(ImGuiIO& io);

 private:
  std::deque<InputEvent> events_;
};

}  // namespace dapple
