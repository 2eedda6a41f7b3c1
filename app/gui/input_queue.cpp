#include "app/gui/input_queue.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <bitset>
#include <cfloat>

namespace dapple {
namespace {

bool isModifier(Key key) {
  return key >= Key::leftShift && key <= Key::rightSuper;
}

void setModifiers(ImGuiIO& io) {
  const auto down = [&](Key key) { return io.KeysDown[static_cast<int>(key)]; };
  io.KeyCtrl = down(Key::leftCtrl) || down(Key::rightCtrl);
  io.KeyShift = down(Key::leftShift) || down(Key::rightShift);
  // Right Alt types characters on many layouts, so it is no modifier of a shortcut.
  io.KeyAlt = down(Key::leftAlt);
  io.KeySuper = down(Key::leftSuper) || down(Key::rightSuper);
}

// Applies events of one frame; each take() answers whether the frame could take the event.
class Frame {
 public:
  Frame(ImGuiIO& io, std::vector<std::filesystem::path>& dropped) : io_(io), dropped_(dropped) {}

  bool take(const MouseMoved& moved) {
    if (edge_) return false;
    io_.MousePos = {moved.x, moved.y};
    return true;
  }
  bool take(const MouseLeft&) {
    // While a button is held the drag goes on outside.
    if (edge_) return false;
    if (!ImGui::IsAnyMouseDown()) io_.MousePos = {-FLT_MAX, -FLT_MAX};
    return true;
  }
  bool take(const MouseButtonChanged& change) {
    if (edge_ || change.button < 0 || change.button >= IM_ARRAYSIZE(io_.MouseDown)) return !edge_;
    io_.MouseDown[change.button] = change.down;
    return edge_ = true;
  }
  bool take(const WheelTurned& wheel) {
    if (edge_ && !wheel_) return false;
    io_.MouseWheelH += wheel.x;
    io_.MouseWheel += wheel.y;
    return wheel_ = edge_ = true;
  }
  bool take(const KeyChanged& change) {
    const int index = static_cast<int>(change.key);
    if (index <= 0 || index >= kKeyCount) return true;
    const bool changes = io_.KeysDown[index] != change.down;
    if (edge_) return !changes;  // a repeat of the held key; ImGui makes its own
    // Released and pressed again within one frame would be held all along.
    const auto i = static_cast<std::size_t>(index);
    if (change.down && released_[i]) return false;
    released_[i] = released_[i] || (changes && !change.down);
    io_.KeysDown[index] = change.down;
    setModifiers(io_);
    // Releases and modifiers hide nothing before them.
    if (change.down && changes && !isModifier(change.key)) edge_ = keyPressed_ = true;
    return true;
  }
  bool take(const CharacterTyped& typed) {
    if (edge_ && !keyPressed_) return false;
    io_.AddInputCharacter(typed.codepoint);
    return true;
  }
  bool take(const FocusChanged& change) {
    if (edge_) return false;
    if (!change.focused) {  // what is released outside is never told
      std::fill(std::begin(io_.KeysDown), std::end(io_.KeysDown), false);
      std::fill(std::begin(io_.MouseDown), std::end(io_.MouseDown), false);
      setModifiers(io_);
    }
    io_.AddFocusEvent(change.focused);
    return edge_ = true;
  }
  bool take(const FilesDropped& drop) {
    if (edge_) return false;
    dropped_.insert(dropped_.end(), drop.paths.begin(), drop.paths.end());
    return edge_ = true;
  }

 private:
  ImGuiIO& io_;
  std::vector<std::filesystem::path>& dropped_;
  std::bitset<kKeyCount> released_;
  bool edge_ = false, wheel_ = false, keyPressed_ = false;
};

}  // namespace

void InputQueue::pushText(std::string_view text) {
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at < end) {
    unsigned codepoint = 0;
    at += std::max(1, ImTextCharFromUtf8(&codepoint, at, end));
    push(CharacterTyped{codepoint});
  }
}

std::vector<std::filesystem::path> InputQueue::apply(ImGuiIO& io) {
  std::vector<std::filesystem::path> dropped;
  Frame frame(io, dropped);
  while (!events_.empty() &&
         std::visit([&](const auto& event) { return frame.take(event); }, events_.front()))
    events_.pop_front();
  return dropped;
}

}  // namespace dapple
