#include "app/gui/navigation.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace dapple {
namespace {

constexpr int kLeft = 0, kRight = 1, kMiddle = 2;

// The left button stays with the tool.
constexpr std::array<NavigationBinding, 6> kDefaultBindings{{
    {kRight, kNoModifiers, CameraMotion::orbit},
    {kLeft, kAlt, CameraMotion::orbit},
    {kMiddle, kNoModifiers, CameraMotion::pan},
    {kMiddle, kAlt, CameraMotion::pan},
    {kRight, kShift, CameraMotion::pan},
    {kRight, kAlt, CameraMotion::zoom},
}};
constexpr std::array<NavigationBinding, 3> kBlenderBindings{{
    {kMiddle, kNoModifiers, CameraMotion::orbit},
    {kMiddle, kShift, CameraMotion::pan},
    {kMiddle, kCtrl, CameraMotion::zoom},
}};
constexpr std::array<NavigationBinding, 3> kMayaBindings{{
    {kLeft, kAlt, CameraMotion::orbit},
    {kMiddle, kAlt, CameraMotion::pan},
    {kRight, kAlt, CameraMotion::zoom},
}};
// CloudCompare orbits with the left button, which here is the tool's: with Alt it orbits.
constexpr std::array<NavigationBinding, 4> kCloudCompareBindings{{
    {kLeft, kAlt, CameraMotion::orbit},
    {kMiddle, kNoModifiers, CameraMotion::orbit},
    {kRight, kNoModifiers, CameraMotion::pan},
    {kMiddle, kShift, CameraMotion::zoom},
}};
constexpr std::array<NavigationPreset, 4> kPresets{{
    {"Default", "Right button orbits, middle pans, wheel zooms to the cursor.", kDefaultBindings,
     true, "{}"},
    {"Blender", "Middle button orbits, with Shift pans, with Ctrl zooms.", kBlenderBindings, false,
     R"({"view.frame": ["Numpad ."]})"},
    {"Maya", "Alt with the left, middle and right button orbits, pans and zooms.", kMayaBindings,
     false, "{}"},
    {"CloudCompare", "Right button pans; middle, or Alt with left, orbits.", kCloudCompareBindings,
     false, "{}"},
}};
constexpr std::array<std::string_view, 3> kButtonNames{"LMB", "RMB", "MMB"};

bool sameName(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  });
}

}  // namespace

std::span<const NavigationPreset> navigationPresets() {
  return kPresets;
}

const NavigationPreset& navigationPreset(std::string_view name) {
  for (const NavigationPreset& preset : kPresets)
    if (sameName(preset.name, name)) return preset;
  return kPresets.front();
}

std::optional<CameraMotion> motionOf(const NavigationPreset& preset, int button,
                                     unsigned modifiers) {
  for (const NavigationBinding& binding : preset.bindings)
    if (binding.button == button && binding.modifiers == modifiers) return binding.motion;
  return {};
}

std::vector<std::string> gesturesOf(const NavigationPreset& preset, CameraMotion motion) {
  std::vector<std::string> gestures;
  for (const NavigationBinding& binding : preset.bindings) {
    if (binding.motion != motion) continue;
    std::string text;
    if ((binding.modifiers & kCtrl) != 0) text += "Ctrl+";
    if ((binding.modifiers & kAlt) != 0) text += "Alt+";
    if ((binding.modifiers & kShift) != 0) text += "Shift+";
    text += kButtonNames[static_cast<std::size_t>(binding.button)];
    gestures.push_back(std::move(text));
  }
  return gestures;
}

unsigned modifiersHeld() {
  const ImGuiIO& io = ImGui::GetIO();
  return (io.KeyCtrl ? kCtrl : 0u) | (io.KeyShift ? kShift : 0u) | (io.KeyAlt ? kAlt : 0u) |
         (io.KeySuper ? kSuper : 0u);
}

}  // namespace dapple
