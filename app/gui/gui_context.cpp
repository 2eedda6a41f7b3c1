#include "app/gui/gui_context.h"

#include <imgui_freetype.h>
#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "app/gui/theme.h"
#include "base/errors.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr float kTextSize = 15, kSmallSize = 13, kMonoSize = 14, kTitleSize = 26;
constexpr float kEmbeddedSize = 13;  // the built-in font is drawn for this one
constexpr int kSettlingFrames = 3;   // hover, then what hover opens, then its size

// Ranges end with 0. Names of files may hold any of these; headings and keys are our own words.
constexpr std::array<ImWchar, 17> kManyGlyphs{0x20,   0xff,   0x100,  0x24f,  0x370,  0x52f,
                                              0x1e00, 0x1eff, 0x2000, 0x206f, 0x20a0, 0x20bf,
                                              0x2190, 0x22ff, 0xfffd, 0xfffd, 0};
constexpr std::array<ImWchar, 9> kFewGlyphs{0x20,   0xff,   0x2010, 0x2044, 0x2190,
                                            0x2199, 0xfffd, 0xfffd, 0};

struct Typeface {
  fs::path text, bold, mono;
};

// The first directory of Debian and of others that holds the typeface; empty paths when none does.
Typeface findTypeface() {
  const fs::path root = "/usr/share/fonts";
  for (const char* folder : {"truetype/dejavu", "dejavu", "TTF", "dejavu-sans-fonts"}) {
    Typeface face{root / folder / "DejaVuSans.ttf", root / folder / "DejaVuSans-Bold.ttf",
                  root / folder / "DejaVuSansMono.ttf"};
    std::error_code error;
    if (!fs::is_regular_file(face.text, error)) continue;
    if (!fs::is_regular_file(face.bold, error)) face.bold = face.text;
    if (!fs::is_regular_file(face.mono, error)) face.mono = face.text;
    return face;
  }
  return {};
}

ImFont* addFont(ImFontAtlas& atlas, const fs::path& file, float pixels, const ImWchar* glyphs) {
  ImFontConfig config;
  config.SizePixels = std::round(pixels);
  if (!file.empty()) {
    if (ImFont* font = atlas.AddFontFromFileTTF(file.c_str(), config.SizePixels, &config, glyphs))
      return font;
  }
  return atlas.AddFontDefault(&config);
}

void mapKeys(ImGuiIO& io) {
  const std::pair<ImGuiKey_, Key> map[] = {
      {ImGuiKey_Tab, Key::tab},
      {ImGuiKey_LeftArrow, Key::left},
      {ImGuiKey_RightArrow, Key::right},
      {ImGuiKey_UpArrow, Key::up},
      {ImGuiKey_DownArrow, Key::down},
      {ImGuiKey_PageUp, Key::pageUp},
      {ImGuiKey_PageDown, Key::pageDown},
      {ImGuiKey_Home, Key::home},
      {ImGuiKey_End, Key::end},
      {ImGuiKey_Insert, Key::insert},
      {ImGuiKey_Delete, Key::del},
      {ImGuiKey_Backspace, Key::backspace},
      {ImGuiKey_Space, Key::space},
      {ImGuiKey_Enter, Key::enter},
      {ImGuiKey_Escape, Key::escape},
      {ImGuiKey_KeyPadEnter, Key::numpadEnter},
      {ImGuiKey_A, Key::a},
      {ImGuiKey_C, Key::c},
      {ImGuiKey_V, Key::v},
      {ImGuiKey_X, Key::x},
      {ImGuiKey_Y, Key::y},
      {ImGuiKey_Z, Key::z},
  };
  for (const auto& [imguiKey, key] : map) io.KeyMap[imguiKey] = static_cast<int>(key);
}

}  // namespace

void markItem(std::string_view id) {
  const ImGuiLastItemData& item = GImGui->LastItemData;
  ImRect seen = item.Rect;
  seen.ClipWith(ImGui::GetCurrentWindowRead()->ClipRect);
  const bool visible = seen.GetWidth() > 0 && seen.GetHeight() > 0;
  const bool enabled = (item.InFlags & ImGuiItemFlags_Disabled) == 0;
  GuiContext::current().marks().set(id, {seen.Min, seen.Max, visible, enabled});
}

void markRectangle(std::string_view id, const ImVec2& min, const ImVec2& max) {
  GuiContext::current().marks().set(id, {min, max, max.x > min.x && max.y > min.y, true});
}

GuiContext::GuiContext(float uiScale)
    : atlas_(std::make_unique<ImFontAtlas>()),
      context_(ImGui::CreateContext(atlas_.get())),
      uiScale_(std::clamp(uiScale, kMinUiScale, kMaxUiScale)),
      wantedScale_(uiScale_) {
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  io.UserData = this;
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset | ImGuiBackendFlags_HasMouseCursors;
  io.ConfigWindowsMoveFromTitleBarOnly = true;
  io.FontAllowUserScaling = false;
  mapKeys(io);
  buildFonts();
  theme::apply(ImGui::GetStyle(), uiScale_);
}

GuiContext::~GuiContext() {
  ImGui::DestroyContext(context_);
}

GuiContext& GuiContext::current() {
  void* const self = ImGui::GetCurrentContext() == nullptr ? nullptr : ImGui::GetIO().UserData;
  if (self == nullptr) throw Bug("there is no GuiContext");
  return *static_cast<GuiContext*>(self);
}

void GuiContext::setUiScale(float scale) {
  wantedScale_ = std::clamp(scale, kMinUiScale, kMaxUiScale);
  settling_ = kSettlingFrames;
}

void GuiContext::buildFonts() {
  const Typeface face = findTypeface();
  fontFile_ = face.text;
  ImFontAtlas& atlas = *atlas_;
  atlas.Clear();
  atlas.SetTexID(nullptr);  // tells the renderer
  atlas.FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
  atlas.FontBuilderFlags = ImGuiFreeTypeBuilderFlags_LightHinting;
  atlas.Flags |= ImFontAtlasFlags_NoPowerOfTwoHeight;
  const auto add = [&](const fs::path& file, float size, const ImWchar* glyphs) {
    const float pixels = fontFile_.empty() ? kEmbeddedSize * size / kTextSize : size;
    return addFont(atlas, file, pixels * uiScale_, glyphs);
  };
  fonts_.text = add(face.text, kTextSize, kManyGlyphs.data());
  fonts_.bold = add(face.bold, kTextSize, kFewGlyphs.data());
  fonts_.small = add(face.text, kSmallSize, kManyGlyphs.data());
  fonts_.mono = add(face.mono, kMonoSize, kFewGlyphs.data());
  fonts_.title = add(face.bold, kTitleSize, kFewGlyphs.data());
  atlas.Build();
  ImGui::GetIO().FontDefault = fonts_.text;
}

void GuiContext::newFrame(int width, int height, float seconds) {
  if (wantedScale_ != uiScale_) {
    uiScale_ = wantedScale_;
    buildFonts();
    theme::apply(ImGui::GetStyle(), uiScale_);
  }
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(std::max(width, 1)),
                    static_cast<float>(std::max(height, 1))};
  io.DeltaTime = std::max(seconds, 1e-5f);
  settling_ = input_.pending() ? kSettlingFrames : std::max(0, settling_ - 1);
  dropped_ = input_.apply(io);
  marks_.clear();
  ImGui::NewFrame();
}

const ImDrawData& GuiContext::render() {
  ImGui::Render();
  return *ImGui::GetDrawData();
}

}  // namespace dapple
