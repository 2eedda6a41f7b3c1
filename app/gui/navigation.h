// Which button turns the camera: habits of other programs.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/gui/keys.h"

namespace dapple {

enum class CameraMotion { orbit, pan, zoom };

struct NavigationBinding {
  int button;  // 0 left, 1 right, 2 middle
  unsigned modifiers;
  CameraMotion motion;
};

struct NavigationPreset {
  std::string_view name;  // also in settings
  std::string_view help;
  std::span<const NavigationBinding> bindings;
  bool wheelZoomsToCursor;
  // Keys that differ in this habit, as of applyKeymap(): "view.frame" to ".".
  std::string_view keymap;
};

// Default, Blender, Maya, CloudCompare.
std::span<const NavigationPreset> navigationPresets();
// By name, case aside; the default for a name that is none.
const NavigationPreset& navigationPreset(std::string_view name);

// What a drag begun with this button and exactly these modifiers does. Nothing: it is the tool's.
std::optional<CameraMotion> motionOf(const NavigationPreset& preset, int button,
                                     unsigned modifiers);
// "Alt+LMB", "RMB" for the F1 sheet, one for each binding of the motion.
std::vector<std::string> gesturesOf(const NavigationPreset& preset, CameraMotion motion);
// Modifiers held in this frame, of ImGuiIO.
unsigned modifiersHeld();

}  // namespace dapple
