// The swatch of one region: which image, which part of it, how large and how turned.
#pragma once

#include <imgui.h>

#include <optional>
#include <utility>

#include "app/editor/swatch_library.h"
#include "document/engine.h"

namespace dapple {

// What of a region is set by sliders. While one is dragged the window shows its own copy: the
// engine's comes a moment later.
struct RegionSettings {
  TextureOptions options;
  double rotation = 0, borderWidth = 0;
  BorderKind borderKind = BorderKind::Cut;
  bool operator==(const RegionSettings&) const = default;

  static RegionSettings of(const Region& region) {
    return {region.options, region.rotation, region.borderWidth, region.borderKind};
  }
};

class SwatchPanel {
 public:
  // The picture with its crop, the sliders, the library. A swatch that is chosen or cropped goes to
  // the engine. True: `settings` has changed. Marks: "swatch.crop" (the picture), "swatch.scale",
  // "swatch.rotation", "swatch.border" (the width), "border.Hard", "border.Blend", "border.Cut",
  // "swatch.maps", "map.CHANNEL", "map.CHANNEL.remove", "swatch.NAME".
  bool draw(const Region& region, RegionSettings& settings, SwatchLibrary& library, Engine& engine);
  // The channel for which the user wants to choose a file, since the last call.
  std::optional<Channel> takeAsked() { return std::exchange(asked_, std::nullopt); }

 private:
  enum class Grip { None, New, Move, Corner };
  struct Drag {
    Grip grip = Grip::None;
    ImVec2 from;       // pixels of the image: the fixed corner, or where the mouse went down
    PixelRect before;  // the crop then
    PixelRect now;
  };

  void picture(const Region& region, const SwatchLibrary::Entry& entry, Engine& engine);
  void dragCrop(const PixelRect& crop, ImVec2 mouse, float pixel, ImVec2 size);
  void grid(const Region& region, const SwatchLibrary& library, Engine& engine);

  void channels(const Region& region, Engine& engine);

  Drag drag_;
  std::optional<Channel> asked_;
};

}  // namespace dapple
