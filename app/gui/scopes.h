// Begin/End and Push/Pop of ImGui that cannot be left open. Debian's ImGui aborts when they are.
#pragma once

#include <imgui.h>

namespace dapple::scope {

struct Uncopied {
  Uncopied() = default;
  Uncopied(const Uncopied&) = delete;
  Uncopied& operator=(const Uncopied&) = delete;
};

// Of those that may be closed: `if (scope::Popup popup("name"))`.
struct Opened : Uncopied {
  bool open = false;
  explicit operator bool() const { return open; }
};

struct Window : Opened {  // its content may be drawn also when not open
  explicit Window(const char* name, bool* shown = nullptr, ImGuiWindowFlags flags = 0) {
    open = ImGui::Begin(name, shown, flags);
  }
  ~Window() { ImGui::End(); }
};
struct Child : Opened {
  explicit Child(const char* id, ImVec2 size = {0, 0}, bool border = false,
                 ImGuiWindowFlags flags = 0) {
    open = ImGui::BeginChild(id, size, border, flags);
  }
  ~Child() { ImGui::EndChild(); }
};
struct Popup : Opened {
  explicit Popup(const char* id, ImGuiWindowFlags flags = 0) {
    open = ImGui::BeginPopup(id, flags);
  }
  ~Popup() {
    if (open) ImGui::EndPopup();
  }
};
struct ContextPopup : Opened {
  explicit ContextPopup(const char* id) { open = ImGui::BeginPopupContextItem(id); }
  ~ContextPopup() {
    if (open) ImGui::EndPopup();
  }
};
struct Modal : Opened {
  explicit Modal(const char* id, bool* shown = nullptr, ImGuiWindowFlags flags = 0) {
    open = ImGui::BeginPopupModal(id, shown, flags);
  }
  ~Modal() {
    if (open) ImGui::EndPopup();
  }
};
struct MainMenuBar : Opened {
  MainMenuBar() { open = ImGui::BeginMainMenuBar(); }
  ~MainMenuBar() {
    if (open) ImGui::EndMainMenuBar();
  }
};
struct Menu : Opened {
  explicit Menu(const char* label, bool enabled = true) { open = ImGui::BeginMenu(label, enabled); }
  ~Menu() {
    if (open) ImGui::EndMenu();
  }
};
struct Combo : Opened {
  Combo(const char* label, const char* shown, ImGuiComboFlags flags = 0) {
    open = ImGui::BeginCombo(label, shown, flags);
  }
  ~Combo() {
    if (open) ImGui::EndCombo();
  }
};
struct Table : Opened {
  Table(const char* id, int columns, ImGuiTableFlags flags = 0, ImVec2 size = {0, 0}) {
    open = ImGui::BeginTable(id, columns, flags, size);
  }
  ~Table() {
    if (open) ImGui::EndTable();
  }
};
struct DragSource : Opened {
  explicit DragSource(ImGuiDragDropFlags flags = 0) { open = ImGui::BeginDragDropSource(flags); }
  ~DragSource() {
    if (open) ImGui::EndDragDropSource();
  }
};
struct DragTarget : Opened {
  DragTarget() { open = ImGui::BeginDragDropTarget(); }
  ~DragTarget() {
    if (open) ImGui::EndDragDropTarget();
  }
};

struct Tooltip : Uncopied {
  Tooltip() { ImGui::BeginTooltip(); }
  ~Tooltip() { ImGui::EndTooltip(); }
};
struct Group : Uncopied {
  Group() { ImGui::BeginGroup(); }
  ~Group() { ImGui::EndGroup(); }
};
struct Disabled : Uncopied {
  explicit Disabled(bool disabled = true) { ImGui::BeginDisabled(disabled); }
  ~Disabled() { ImGui::EndDisabled(); }
};
struct Id : Uncopied {
  explicit Id(const char* id) { ImGui::PushID(id); }
  explicit Id(int id) { ImGui::PushID(id); }
  ~Id() { ImGui::PopID(); }
};
struct Font : Uncopied {
  explicit Font(ImFont* font) { ImGui::PushFont(font); }
  ~Font() { ImGui::PopFont(); }
};
struct Colour : Uncopied {
  Colour(ImGuiCol which, const ImVec4& colour) { ImGui::PushStyleColor(which, colour); }
  ~Colour() { ImGui::PopStyleColor(); }
};
struct Style : Uncopied {
  Style(ImGuiStyleVar which, float value) { ImGui::PushStyleVar(which, value); }
  Style(ImGuiStyleVar which, ImVec2 value) { ImGui::PushStyleVar(which, value); }
  ~Style() { ImGui::PopStyleVar(); }
};
struct ItemWidth : Uncopied {
  explicit ItemWidth(float width) { ImGui::PushItemWidth(width); }
  ~ItemWidth() { ImGui::PopItemWidth(); }
};
struct WrappedText : Uncopied {
  explicit WrappedText(float x = 0) { ImGui::PushTextWrapPos(x); }
  ~WrappedText() { ImGui::PopTextWrapPos(); }
};
struct ClipRect : Uncopied {
  ClipRect(ImVec2 min, ImVec2 max) { ImGui::PushClipRect(min, max, true); }
  ~ClipRect() { ImGui::PopClipRect(); }
};
struct Indent : Uncopied {
  explicit Indent(float width = 0) : width_(width) { ImGui::Indent(width_); }
  ~Indent() { ImGui::Unindent(width_); }

 private:
  float width_;
};

}  // namespace dapple::scope
