// Small parts that panels are made of. Each is named for tests by `mark` when it is not empty.
#pragma once

#include <imgui.h>

#include <string>
#include <string_view>

#include "app/gui/icons.h"

namespace dapple {

// Of every text field. ImGui 1.86 writes outside its buffer when it undoes the typing of a text
// that the program has changed meanwhile.
inline constexpr ImGuiInputTextFlags kTextFlags = ImGuiInputTextFlags_NoUndoRedo;

struct IconButton {
  Icon icon = Icon::none;
  const char* id = "";  // ImGui's, unique in its window; also the mark
  std::string tooltip;  // first line strong, the rest muted
  std::string keys;     // "Ctrl+Z", shown in the tooltip
  bool selected = false;
  bool enabled = true;
  bool danger = false;  // red when hovered
  float size = 0;       // logical pixels, 0: theme::kIconButtonSize
};
// A square button; pressed this frame?
bool iconButton(const IconButton& button);

enum class ButtonKind { normal, primary, quiet, danger };
// A text button, with an icon before the text if there is one; `width` pixels, 0 to fit, -1 to
// fill.
bool textButton(const char* label, ButtonKind kind = ButtonKind::normal, Icon icon = Icon::none,
                float width = 0, std::string_view mark = {});

// A collapsible heading of a panel over the whole width; open?
bool sectionHeader(const char* label, bool openAtFirst = true, std::string_view mark = {});
// A heading that does not fold.
void heading(const char* text);
void mutedText(std::string_view text);         // one line, small
void mutedTextWrapped(std::string_view text);  // small, at the width there is
// Text cut with an ellipsis at `width` pixels; the whole in the tooltip when cut.
void clippedText(std::string_view text, float width);
// The middle of a path cut: "/home/…/scans/cat.ply".
std::string shortenedMiddle(std::string_view text, float width);
// A key as it looks on a keyboard.
void keyCap(std::string_view key);
// "Ctrl+Shift+Z" as caps.
void keyCaps(std::string_view keys);
float keyCapsWidth(std::string_view keys);

// For the item just drawn, after a moment of hovering, also when it is disabled.
void tooltip(std::string_view text, std::string_view keys = {});

// A field with a magnifying glass and a cross that empties it; changed?
bool searchField(const char* id, const char* hint, std::string& text, float width = -1,
                 bool focus = false);

struct Slider {
  const char* label = "";
  float low = 0, high = 1;
  float usual = 0;  // what a double click takes
  const char* format = "%.2f";
  bool logarithmic = false;  // low and high above 0
  std::string_view mark = {};
};
// A value that is dragged, its label above, itself to the right of it, where it can be typed.
// Changed?
bool slider(const Slider& slider, float& value);

struct ListRow {
  const char* id = "";  // also what it says
  bool selected = false;
  Icon icon = Icon::none;
  std::string note;   // muted, at the right
  float indent = 0;   // logical pixels
  float reserve = 0;  // pixels left free at the right, for buttons that overlap
  std::string_view mark = {};
};
// A row of a list over the whole width, kRowHeight high; clicked?
bool listRow(const ListRow& row);

// A switch: checkbox with our look, label to the right.
bool toggle(const char* label, bool& value, std::string_view mark = {});

// Choices beside each other of which one is taken: segmented control. Returns true when it changed.
bool segments(const char* id, const char* const* labels, int count, int& chosen);

// Moves the cursor so that an item `width` pixels wide ends at the right border.
void alignRight(float width);

// A thin line across with space around it.
void divider();

// A coloured square with rounded corners, as an item `side` pixels wide.
void colourChip(const ImVec4& colour, float side);

}  // namespace dapple
