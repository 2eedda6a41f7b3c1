#include "app/gui/widgets.h"

#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/gui/gui_context.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"

namespace dapple {
namespace {

using namespace theme;

constexpr float kTooltipDelay = 0.45f;  // seconds of hovering
constexpr float kTooltipWidth = 320;

void mark(std::string_view id) {
  if (!id.empty()) markItem(id);
}

const char* end(std::string_view text) {
  return text.data() + text.size();
}

void text(std::string_view words) {
  ImGui::TextUnformatted(words.data(), end(words));
}

float widthOf(std::string_view words) {
  return ImGui::CalcTextSize(words.data(), end(words)).x;
}

// The number of bytes of the first `count` bytes' whole characters.
std::size_t wholeCharacters(std::string_view words, std::size_t count) {
  while (count > 0 && count < words.size() && (words[count] & 0xc0) == 0x80) --count;
  return count;
}

// The longest head of `words` that, with `tail` behind it, fits.
std::size_t fittingHead(std::string_view words, std::string_view tail, float width) {
  std::size_t low = 0, high = words.size();
  while (low < high) {
    const std::size_t middle = (low + high + 1) / 2;
    const std::string head(words.substr(0, wholeCharacters(words, middle)));
    if (widthOf(head + std::string(tail)) <= width)
      low = middle;
    else
      high = middle - 1;
  }
  return wholeCharacters(words, low);
}

struct ButtonColours {
  ImVec4 plain, hovered, active, text;
};

ButtonColours coloursOf(ButtonKind kind) {
  switch (kind) {
    case ButtonKind::primary:
      return {kAccent, kAccentHovered, kAccentActive, kOnAccent};
    case ButtonKind::quiet:
      return {{0, 0, 0, 0}, kControl, kControlActive, kText};
    case ButtonKind::danger:
      return {withAlpha(kError, 0.16f), withAlpha(kError, 0.30f), withAlpha(kError, 0.40f), kError};
    default:
      return {kControl, kControlHovered, kControlActive, kText};
  }
}

ImU32 stateColour(const ButtonColours& colours) {
  return ImGui::GetColorU32(ImGui::IsItemActive()    ? colours.active
                            : ImGui::IsItemHovered() ? colours.hovered
                                                     : colours.plain);
}

}  // namespace

void tooltip(std::string_view words, std::string_view keys) {
  if (words.empty() && keys.empty()) return;
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  if (GImGui->HoveredIdTimer < kTooltipDelay && GImGui->HoveredIdDisabled == false) return;
  const scope::Style padding(ImGuiStyleVar_WindowPadding, px(10, 8));
  const scope::Style full(ImGuiStyleVar_Alpha, 1.0f);
  const scope::Tooltip tip;
  const scope::WrappedText wrapped(px(kTooltipWidth));
  const std::size_t line = words.find('\n');
  {
    const scope::Style frame(ImGuiStyleVar_FramePadding, px(0, 1));
    ImGui::AlignTextToFramePadding();
    text(words.substr(0, line));
    if (!keys.empty()) {
      ImGui::SameLine(0, px(kGapLarge));
      keyCaps(keys);
    }
  }
  if (line != std::string_view::npos) mutedText(words.substr(line + 1));
}

bool iconButton(const IconButton& button) {
  const scope::Disabled disabled(!button.enabled);
  const float side = px(button.size > 0 ? button.size : kIconButtonSize);
  const float icon = std::round(std::min(px(kIconSize), side * 0.7f));
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const bool clicked = ImGui::InvisibleButton(button.id, {side, side});
  markItem(button.id);
  const bool hovered = ImGui::IsItemHovered();
  ButtonColours colours = coloursOf(ButtonKind::quiet);
  ImVec4 ink = hovered ? kText : withAlpha(kText, 0.82f);
  if (button.selected) {
    colours = {kAccentSoft, withAlpha(kAccent, 0.30f), withAlpha(kAccent, 0.36f), kAccent};
    ink = kAccentHovered;
  } else if (button.danger && hovered) {
    colours = coloursOf(ButtonKind::danger);
    ink = kError;
  }
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(min, {min.x + side, min.y + side}, stateColour(colours), px(kRadius));
  const float inset = std::floor((side - icon) / 2);
  drawIcon(list, button.icon, {min.x + inset, min.y + inset}, icon, ImGui::GetColorU32(ink));
  tooltip(button.tooltip, button.keys);
  return clicked;
}

bool textButton(const char* label, ButtonKind kind, Icon icon, float width,
                std::string_view markId) {
  const ImVec2 words = ImGui::CalcTextSize(label, nullptr, true);
  const float iconSide = icon == Icon::none ? 0 : px(16);
  const float gap = icon == Icon::none || words.x == 0 ? 0 : px(kGap);
  const float content = iconSide + gap + words.x;
  const float height = px(kButtonHeight);
  if (width < 0) width = ImGui::GetContentRegionAvail().x;
  if (width == 0) width = content + 2 * px(14);
  width = std::max(width, 1.0f);

  const ImVec2 min = ImGui::GetCursorScreenPos();
  const bool clicked = ImGui::InvisibleButton(label, {width, height});
  mark(markId);
  const ButtonColours colours = coloursOf(kind);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 max{min.x + width, min.y + height};
  list.AddRectFilled(min, max, stateColour(colours), px(kRadius));
  const ImU32 ink = ImGui::GetColorU32(colours.text);
  float x = std::round(min.x + std::max((width - content) / 2, px(kGapSmall)));
  if (icon != Icon::none) {
    drawIcon(list, icon, {x, min.y + std::round((height - iconSide) / 2)}, iconSide, ink);
    x += iconSide + gap;
  }
  const scope::ClipRect clip(min, max);
  list.AddText({x, min.y + std::round((height - words.y) / 2)}, ink, label,
               ImGui::FindRenderedTextEnd(label));
  return clicked;
}

bool sectionHeader(const char* label, bool openAtFirst, std::string_view markId) {
  const ImGuiID id = ImGui::GetID(label);
  ImGuiStorage& storage = *ImGui::GetStateStorage();
  bool open = storage.GetBool(id, openAtFirst);
  const float height = px(kRowHeight), width = std::max(1.0f, ImGui::GetContentRegionAvail().x);
  const ImVec2 min = ImGui::GetCursorScreenPos();
  if (ImGui::InvisibleButton(label, {width, height})) storage.SetBool(id, open = !open);
  mark(markId);
  const bool hovered = ImGui::IsItemHovered();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float chevron = px(12);
  const ImU32 ink = ImGui::GetColorU32(hovered ? kText : kTextMuted);
  drawIcon(list, open ? Icon::chevronDown : Icon::chevronRight,
           {min.x, min.y + std::round((height - chevron) / 2)}, chevron, ink);
  const scope::Font bold(GuiContext::current().fonts().bold);
  const float textY = min.y + std::round((height - ImGui::GetFontSize()) / 2);
  list.AddText({min.x + chevron + px(kGap), textY},
               ImGui::GetColorU32(hovered ? kText : withAlpha(kText, 0.9f)), label,
               ImGui::FindRenderedTextEnd(label));
  return open;
}

void heading(const char* label) {
  const scope::Font bold(GuiContext::current().fonts().bold);
  text(label);
}

void mutedText(std::string_view words) {
  const scope::Font small(GuiContext::current().fonts().small);
  const scope::Colour colour(ImGuiCol_Text, kTextMuted);
  text(words);
}

void mutedTextWrapped(std::string_view words) {
  const scope::WrappedText wrapped;
  mutedText(words);
}

void clippedText(std::string_view words, float width) {
  if (widthOf(words) <= width) return text(words);
  text(std::string(words.substr(0, fittingHead(words, "…", width))) + "…");
  tooltip(words);
}

std::string shortenedMiddle(std::string_view words, float width) {
  if (widthOf(words) <= width) return std::string(words);
  // The end tells more than the beginning: it keeps two thirds.
  std::size_t from = words.size();
  while (from > 0) {
    const std::size_t before = from - 1;
    if (widthOf(words.substr(before)) > width * 0.66f) break;
    from = before;
  }
  while (from < words.size() && (words[from] & 0xc0) == 0x80) ++from;
  const std::string tail = "…" + std::string(words.substr(from));
  return std::string(words.substr(0, fittingHead(words.substr(0, from), tail, width))) + tail;
}

void keyCap(std::string_view key) {
  const scope::Font small(GuiContext::current().fonts().small);
  const float line = ImGui::GetFontSize(), padding = px(6);
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const ImVec2 size{std::max(widthOf(key) + 2 * padding, line + px(6)), line + px(6)};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 max{min.x + size.x, min.y + size.y};
  list.AddRectFilled(min, max, ImGui::GetColorU32(kControl), px(4));
  list.AddRect(min, max, ImGui::GetColorU32(kLineStrong), px(4), 0, px(1));
  list.AddText({std::round(min.x + (size.x - widthOf(key)) / 2), min.y + px(3)},
               ImGui::GetColorU32(kText), key.data(), end(key));
  ImGui::Dummy(size);
}

namespace {

// The parts of "Ctrl++" are "Ctrl" and "+".
template <typename Each>
void eachKey(std::string_view keys, const Each& each) {
  while (!keys.empty()) {
    const std::size_t plus = keys.size() == 1 ? std::string_view::npos : keys.find('+', 1);
    each(keys.substr(0, plus));
    keys = plus == std::string_view::npos ? std::string_view() : keys.substr(plus + 1);
  }
}

}  // namespace

void keyCaps(std::string_view keys) {
  const scope::Group group;
  bool first = true;
  eachKey(keys, [&](std::string_view key) {
    if (!first) ImGui::SameLine(0, px(3));
    first = false;
    keyCap(key);
  });
}

float keyCapsWidth(std::string_view keys) {
  const scope::Font small(GuiContext::current().fonts().small);
  float width = -px(3);
  eachKey(keys, [&](std::string_view key) {
    width += std::max(widthOf(key) + 2 * px(6), ImGui::GetFontSize() + px(6)) + px(3);
  });
  return std::max(width, 0.0f);
}

bool searchField(const char* id, const char* hint, std::string& words, float width, bool focus) {
  const scope::Id scoped(id);
  if (width < 0) width = ImGui::GetContentRegionAvail().x;
  const float side = px(16), inset = px(kGap);
  const ImVec2 min = ImGui::GetCursorScreenPos();
  bool changed = false;
  {
    const float height = ImGui::GetFrameHeight();
    const scope::Style padding(ImGuiStyleVar_FramePadding,
                               {side + 2 * inset, ImGui::GetStyle().FramePadding.y});
    ImGui::SetNextItemWidth(width);
    if (focus) ImGui::SetKeyboardFocusHere();
    changed = ImGui::InputTextWithHint("##text", hint, &words, kTextFlags);
    markItem(id);
    drawIcon(*ImGui::GetWindowDrawList(), Icon::search,
             {min.x + inset, min.y + std::round((height - side) / 2)}, side,
             ImGui::GetColorU32(kTextMuted));
  }
  if (words.empty()) return changed;
  const ImVec2 after = ImGui::GetCursorPos();
  const float cross = ImGui::GetFrameHeight();
  ImGui::SetItemAllowOverlap();
  ImGui::SetCursorScreenPos({min.x + width - cross, min.y});
  const bool emptied = ImGui::InvisibleButton("##empty", {cross, cross});
  drawIcon(*ImGui::GetWindowDrawList(), Icon::close,
           {min.x + width - cross + std::round((cross - px(12)) / 2),
            min.y + std::round((cross - px(12)) / 2)},
           px(12), ImGui::GetColorU32(ImGui::IsItemHovered() ? kText : kTextMuted));
  ImGui::SetCursorPos(after);
  if (emptied) words.clear();
  return changed || emptied;
}

bool slider(const Slider& slider, float& value) {
  const scope::Id scoped(slider.label);
  const scope::Group group;
  const scope::Style spacing(ImGuiStyleVar_ItemSpacing, px(kGapSmall, kGapTiny));
  const ImGuiIO& io = ImGui::GetIO();
  const float width = ImGui::CalcItemWidth(), height = px(16), field = px(64);
  const float before = value;
  {
    const scope::Style padding(ImGuiStyleVar_FramePadding, px(kGap, 3));
    const float x = ImGui::GetCursorPosX();
    ImGui::AlignTextToFramePadding();
    text(std::string_view(slider.label, ImGui::FindRenderedTextEnd(slider.label)));
    ImGui::SameLine();
    ImGui::SetCursorPosX(x + width - field);
    ImGui::SetNextItemWidth(field);
    if (ImGui::InputFloat("##value", &value, 0, 0, slider.format, kTextFlags))
      value = std::clamp(value, slider.low, slider.high);
  }
  const ImVec2 min = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("##track", {width, height});
  mark(slider.mark);
  const float knob = px(7), from = min.x + knob, span = std::max(width - 2 * knob, 1.0f);
  const auto scaled = [&](float v) { return slider.logarithmic ? std::log(v) : v; };
  const float low = scaled(slider.low), range = scaled(slider.high) - low;
  if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0)) {
    value = slider.usual;
  } else if (ImGui::IsItemActive() && io.MouseClickedLastCount[0] < 2) {
    const float v = low + range * std::clamp((io.MousePos.x - from) / span, 0.0f, 1.0f);
    value = std::clamp(slider.logarithmic ? std::exp(v) : v, slider.low, slider.high);
  }
  const float part = std::clamp((scaled(value) - low) / range, 0.0f, 1.0f);
  const float at = from + span * part, middle = min.y + height / 2, half = px(2);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled({min.x, middle - half}, {min.x + width, middle + half},
                     ImGui::GetColorU32(kControlHovered), half);
  list.AddRectFilled({min.x, middle - half}, {at, middle + half}, ImGui::GetColorU32(kAccent),
                     half);
  const bool hot = ImGui::IsItemActive() || ImGui::IsItemHovered();
  list.AddCircleFilled({at, middle}, hot ? knob : knob - px(1),
                       ImGui::GetColorU32(hot ? kAccentHovered : kText));
  return value != before;
}

bool listRow(const ListRow& row) {
  const float height = px(kRowHeight), width = std::max(1.0f, ImGui::GetContentRegionAvail().x);
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const bool clicked = ImGui::InvisibleButton(row.id, {width, height});
  ImGui::SetItemAllowOverlap();
  mark(row.mark);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (row.selected || ImGui::IsItemHovered())
    list.AddRectFilled(min, {min.x + width, min.y + height},
                       ImGui::GetColorU32(row.selected ? kAccentSoft : kControl), px(kRadius));
  float x = min.x + px(kGap) + px(row.indent);
  const float side = px(16);
  if (row.icon != Icon::none) {
    drawIcon(list, row.icon, {x, min.y + std::round((height - side) / 2)}, side,
             ImGui::GetColorU32(row.selected ? kAccentHovered : kTextMuted));
    x += side + px(kGap);
  }
  const float textY = min.y + std::round((height - ImGui::GetFontSize()) / 2);
  const float noteX = min.x + width - row.reserve - px(kGap) - widthOf(row.note);
  const std::string name = shortenedMiddle(
      std::string_view(row.id, ImGui::FindRenderedTextEnd(row.id)), noteX - px(kGap) - x);
  list.AddText({x, textY}, ImGui::GetColorU32(kText), name.c_str());
  list.AddText({noteX, textY}, ImGui::GetColorU32(kTextMuted), row.note.c_str());
  return clicked;
}

bool toggle(const char* label, bool& value, std::string_view markId) {
  const float height = px(20), width = px(34), gap = px(kGap);
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const ImVec2 words = ImGui::CalcTextSize(label, nullptr, true);
  const float full = ImGui::GetFrameHeight();  // in line with fields beside it
  const bool clicked =
      ImGui::InvisibleButton(label, {width + (words.x > 0 ? gap : 0) + words.x, full});
  mark(markId);
  if (clicked) value = !value;
  const bool hovered = ImGui::IsItemHovered();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float top = min.y + std::round((full - height) / 2), radius = height / 2;
  const ImVec4 track =
      value ? (hovered ? kAccentHovered : kAccent) : (hovered ? kControlActive : kControlHovered);
  list.AddRectFilled({min.x, top}, {min.x + width, top + height}, ImGui::GetColorU32(track),
                     radius);
  list.AddCircleFilled({value ? min.x + width - radius : min.x + radius, top + radius},
                       radius - px(3), ImGui::GetColorU32(value ? kOnAccent : kText));
  list.AddText({min.x + width + gap, min.y + std::round((full - words.y) / 2)},
               ImGui::GetColorU32(ImGuiCol_Text), label, ImGui::FindRenderedTextEnd(label));
  return clicked;
}

bool segments(const char* id, const char* const* labels, int count, int& chosen) {
  const scope::Id scoped(id);
  const float height = px(kButtonHeight), padding = px(12), inset = px(3);
  float width = 2 * inset;
  for (int i = 0; i < count; ++i) width += widthOf(labels[i]) + 2 * padding;
  const ImVec2 min = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(min, {min.x + width, min.y + height}, ImGui::GetColorU32(kField), px(kRadius));
  const scope::Group group;
  bool changed = false;
  float x = min.x + inset;
  for (int i = 0; i < count; ++i) {
    const float part = widthOf(labels[i]) + 2 * padding;
    ImGui::SetCursorScreenPos({x, min.y});
    if (ImGui::InvisibleButton(labels[i], {part, height}) && chosen != i) {
      chosen = i;
      changed = true;
    }
    markItem(std::string(id) + "." + labels[i]);
    const bool hovered = ImGui::IsItemHovered();
    if (chosen == i)
      list.AddRectFilled({x, min.y + inset}, {x + part, min.y + height - inset},
                         ImGui::GetColorU32(kControlActive), px(4));
    list.AddText({x + padding, min.y + std::round((height - ImGui::GetFontSize()) / 2)},
                 ImGui::GetColorU32(chosen == i || hovered ? kText : kTextMuted), labels[i]);
    x += part;
  }
  ImGui::SetCursorScreenPos(min);
  ImGui::Dummy({width, height});
  return changed;
}

void alignRight(float width) {
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() +
                       std::max(0.0f, ImGui::GetContentRegionAvail().x - width));
}

void divider() {
  ImGui::Dummy({0, px(2)});
  ImGui::Separator();
  ImGui::Dummy({0, px(2)});
}

void colourChip(const ImVec4& colour, float side) {
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const ImVec2 max{min.x + side, min.y + side};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(min, max, ImGui::GetColorU32(colour), px(3));
  list.AddRect(min, max, ImGui::GetColorU32(kLineStrong), px(3), 0, px(1));
  ImGui::Dummy({side, side});
}

}  // namespace dapple
