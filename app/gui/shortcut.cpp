#include "app/gui/shortcut.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>
#include <vector>

namespace dapple {
namespace {

struct NamedKey {
  Key key;
  std::string_view name;
};
// Names printed first, other spellings after them.
constexpr std::array<NamedKey, 43> kNames{{
    {Key::space, "Space"},
    {Key::escape, "Esc"},
    {Key::enter, "Enter"},
    {Key::tab, "Tab"},
    {Key::backspace, "Backspace"},
    {Key::insert, "Insert"},
    {Key::del, "Delete"},
    {Key::right, "Right"},
    {Key::left, "Left"},
    {Key::down, "Down"},
    {Key::up, "Up"},
    {Key::pageUp, "Page Up"},
    {Key::pageDown, "Page Down"},
    {Key::home, "Home"},
    {Key::end, "End"},
    {Key::numpad0, "Numpad 0"},
    {Key::numpad1, "Numpad 1"},
    {Key::numpad2, "Numpad 2"},
    {Key::numpad3, "Numpad 3"},
    {Key::numpad4, "Numpad 4"},
    {Key::numpad5, "Numpad 5"},
    {Key::numpad6, "Numpad 6"},
    {Key::numpad7, "Numpad 7"},
    {Key::numpad8, "Numpad 8"},
    {Key::numpad9, "Numpad 9"},
    {Key::numpadDecimal, "Numpad ."},
    {Key::numpadDivide, "Numpad /"},
    {Key::numpadMultiply, "Numpad *"},
    {Key::numpadSubtract, "Numpad -"},
    {Key::numpadAdd, "Numpad +"},
    {Key::numpadEnter, "Numpad Enter"},
    {Key::escape, "Escape"},
    {Key::enter, "Return"},
    {Key::del, "Del"},
    {Key::insert, "Ins"},
    {Key::pageUp, "PgUp"},
    {Key::pageDown, "PgDn"},
    {Key::pageUp, "PageUp"},
    {Key::pageDown, "PageDown"},
    {Key::right, "Arrow Right"},
    {Key::left, "Arrow Left"},
    {Key::up, "Arrow Up"},
    {Key::down, "Arrow Down"},
}};
constexpr std::array<std::pair<std::string_view, unsigned>, 7> kModifierNames{{{"Ctrl", kCtrl},
                                                                               {"Alt", kAlt},
                                                                               {"Shift", kShift},
                                                                               {"Super", kSuper},
                                                                               {"Control", kCtrl},
                                                                               {"Option", kAlt},
                                                                               {"Cmd", kSuper}}};
// Symbols with a key of their own on most layouts, usable behind Ctrl or Alt.
constexpr std::string_view kKeySymbols = "',-./;=[\\]`";

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

bool same(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  });
}

Key functionKey(std::string_view name) {
  if (name.size() < 2 || name.size() > 3 || std::toupper(name[0]) != 'F') return Key::none;
  int number = 0;
  for (char digit : name.substr(1)) {
    if (digit < '0' || digit > '9') return Key::none;
    number = number * 10 + (digit - '0');
  }
  if (number < 1 || number > 12 || name[1] == '0') return Key::none;
  return static_cast<Key>(static_cast<int>(Key::f1) + number - 1);
}

std::optional<Shortcut> keyNamed(std::string_view name, unsigned modifiers) {
  if (name.size() == 1) {
    const auto symbol = static_cast<unsigned char>(name[0]);
    if (std::isalnum(symbol)) return Shortcut{static_cast<Key>(std::toupper(symbol)), modifiers, 0};
    if (!std::ispunct(symbol)) return {};
    // Shift is part of how a symbol is typed.
    if ((modifiers & ~kShift) == 0) return Shortcut{Key::none, kNoModifiers, name[0]};
    if (kKeySymbols.find(name[0]) == std::string_view::npos) return {};
    return Shortcut{static_cast<Key>(symbol), modifiers, 0};
  }
  if (const Key key = functionKey(name); key != Key::none) return Shortcut{key, modifiers, 0};
  for (const NamedKey& named : kNames)
    if (same(named.name, name)) return Shortcut{named.key, modifiers, 0};
  return {};
}

std::string keyName(Key key) {
  for (const NamedKey& named : kNames)
    if (named.key == key) return std::string(named.name);
  if (key >= Key::f1 && key <= Key::f12)
    return "F" + std::to_string(static_cast<int>(key) - static_cast<int>(Key::f1) + 1);
  return std::string(1, static_cast<char>(key));
}

unsigned modifiersDown(const ImGuiIO& io) {
  return (io.KeyCtrl ? kCtrl : 0u) | (io.KeyShift ? kShift : 0u) | (io.KeyAlt ? kAlt : 0u) |
         (io.KeySuper ? kSuper : 0u);
}

bool anyKeyFresh(const ImGuiIO& io) {
  for (int key = 0; key < kKeyCount; ++key)
    if (io.KeysDown[key] && io.KeysDownDuration[key] == 0) return true;
  return false;
}

}  // namespace

std::optional<Shortcut> parseShortcut(std::string_view text) {
  text = trimmed(text);
  unsigned modifiers = kNoModifiers;
  for (bool found = true; found;) {
    found = false;
    const std::size_t plus = text.find('+', 1);
    if (text.empty() || plus == std::string_view::npos) break;
    for (const auto& [name, bit] : kModifierNames) {
      if (!same(trimmed(text.substr(0, plus)), name)) continue;
      modifiers |= bit;
      text = trimmed(text.substr(plus + 1));
      found = true;
      break;
    }
  }
  return keyNamed(text, modifiers);
}

std::string toString(const Shortcut& shortcut) {
  if (shortcut.symbol != 0) return std::string(1, shortcut.symbol);
  if (shortcut.key == Key::none) return {};
  std::string text;
  for (std::size_t i = 0; i < 4; ++i)  // the names to print
    if ((shortcut.modifiers & kModifierNames[i].second) != 0)
      text += std::string(kModifierNames[i].first) + "+";
  return text + keyName(shortcut.key);
}

bool pressed(const Shortcut& shortcut, const ImGuiIO& io, bool repeats) {
  if (shortcut.symbol != 0) {
    const auto& typed = io.InputQueueCharacters;
    const bool there =
        std::find(typed.begin(), typed.end(), static_cast<ImWchar>(shortcut.symbol)) != typed.end();
    return there && (repeats || anyKeyFresh(io));
  }
  return shortcut.key != Key::none && modifiersDown(io) == shortcut.modifiers &&
         ImGui::IsKeyPressed(static_cast<int>(shortcut.key), repeats);
}

}  // namespace dapple
