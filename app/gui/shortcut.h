// A key with its modifiers, as people write it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "app/gui/keys.h"

struct ImGuiIO;

namespace dapple {

struct Shortcut {
  Key key = Key::none;
  unsigned modifiers = kNoModifiers;
  // A printed symbol that is no key by itself everywhere, such as '?' or '[': it is taken by what
  // was typed, with Shift or without; then `key` is none and modifiers hold neither Ctrl nor Alt.
  char symbol = 0;

  bool operator==(const Shortcut&) const = default;
};

// "Ctrl+Shift+Z", "F1", "[", "?", "Numpad 1", "Page Up", "Space"; case and spaces around + do not
// matter, Cmd and Super are the same. Nothing for what is no shortcut.
std::optional<Shortcut> parseShortcut(std::string_view text);
// As parseShortcut() reads it, modifiers in the order Ctrl, Alt, Shift, Super.
std::string toString(const Shortcut& shortcut);

// Pressed in this frame? With `repeats` also again and again while it is held. Modifiers must be
// exactly those of the shortcut.
bool pressed(const Shortcut& shortcut, const ImGuiIO& io, bool repeats);

}  // namespace dapple
