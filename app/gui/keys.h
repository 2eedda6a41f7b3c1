// Keys of the keyboard by what is printed on them, independent of any window system.
#pragma once

#include <cstdint>

namespace dapple {

// The numbers are GLFW's key codes and, for printed symbols, ASCII. They are also the indices into
// ImGuiIO::KeysDown. A letter is the key that types this letter on the user's layout.
enum class Key : std::int16_t {
  none = 0,
  space = 32,
  apostrophe = 39,
  comma = 44,
  minus = 45,
  period = 46,
  slash = 47,
  digit0 = 48,  // to digit9 = 57
  semicolon = 59,
  equal = 61,
  a = 65,  // to z = 90
  b,
  c,
  d,
  e,
  f,
  g,
  h,
  i,
  j,
  k,
  l,
  m,
  n,
  o,
  p,
  q,
  r,
  s,
  t,
  u,
  v,
  w,
  x,
  y,
  z,
  leftBracket = 91,
  backslash = 92,
  rightBracket = 93,
  grave = 96,
  escape = 256,
  enter,
  tab,
  backspace,
  insert,
  del,
  right,
  left,
  down,
  up,
  pageUp,
  pageDown,
  home,
  end,
  f1 = 290,  // to f12 = 301
  f2,
  f3,
  f4,
  f5,
  f6,
  f7,
  f8,
  f9,
  f10,
  f11,
  f12,
  numpad0 = 320,  // to numpad9 = 329
  numpad1,
  numpad2,
  numpad3,
  numpad4,
  numpad5,
  numpad6,
  numpad7,
  numpad8,
  numpad9,
  numpadDecimal,
  numpadDivide,
  numpadMultiply,
  numpadSubtract,
  numpadAdd,
  numpadEnter,
  leftShift = 340,
  leftCtrl,
  leftAlt,
  leftSuper,
  rightShift,
  rightCtrl,
  rightAlt,
  rightSuper,
};
constexpr int kKeyCount = 348;

// Bits, to be combined with |.
enum Modifiers : unsigned { kNoModifiers = 0, kCtrl = 1, kShift = 2, kAlt = 4, kSuper = 8 };

constexpr Key letterKey(char upperCase) {
  return static_cast<Key>(upperCase);
}

}  // namespace dapple
