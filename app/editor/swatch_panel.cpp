#include "app/editor/swatch_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/gui/gui_renderer.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"

namespace dapple {
namespace {

using theme::px;

constexpr float kSide = 58;                       // logical pixels, of a thumbnail of the library
constexpr float kPicture = 132;                   // logical pixels, of its longer side
constexpr float kGripRadius = 7;                  // logical pixels
constexpr float kMapLabel = 84, kSmallIcon = 22;  // logical pixels
constexpr int kSmallestCrop = 8;                  // pixels of the image
constexpr double kWidestBorder = 30;

bool near(ImVec2 a, ImVec2 b, float distance) {
  return std::hypot(a.x - b.x, a.y - b.y) <= distance;
}

// The pixels between two corners, inside the image and not too small.
PixelRect rectangle(ImVec2 a, ImVec2 b, ImVec2 size) {
  const auto span = [](float p, float q, float limit) {
    const float low = std::clamp(std::floor(std::min(p, q)), 0.f, limit - kSmallestCrop);
    const float high = std::clamp(std::ceil(std::max(p, q)), low + kSmallestCrop, limit);
    return std::pair(static_cast<int>(low), static_cast<int>(high - low));
  };
  const auto [x, width] = span(a.x, b.x, size.x);
  const auto [y, height] = span(a.y, b.y, size.y);
  return {x, y, width, height};
}

ImVec2 cornerOf(const PixelRect& r, int corner) {
  return {static_cast<float>(r.x + (corner % 2 ? r.width : 0)),
          static_cast<float>(r.y + (corner / 2 ? r.height : 0))};
}

// What is not taken is dimmed; the frame has grips at its corners.
void drawCrop(ImVec2 min, ImVec2 max, ImVec2 low, ImVec2 high) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImU32 shade = theme::packed(theme::kShade), line = theme::packed(theme::kAccent);
  list.AddRectFilled(min, {max.x, low.y}, shade);
  list.AddRectFilled({min.x, high.y}, max, shade);
  list.AddRectFilled({min.x, low.y}, {low.x, high.y}, shade);
  list.AddRectFilled({high.x, low.y}, {max.x, high.y}, shade);
  list.AddRect(low, high, line, 0, 0, px(1.5f));
  const float half = px(3);
  for (const ImVec2 at : {low, high, ImVec2(low.x, high.y), ImVec2(high.x, low.y)})
    list.AddRectFilled({at.x - half, at.y - half}, {at.x + half, at.y + half}, line);
}

bool settingSlider(const Slider& shown, double& value) {
  auto v = static_cast<float>(value);
  if (!slider(shown, v)) return false;
  value = v;
  return true;
}

bool sliders(RegionSettings& settings) {
  bool changed = settingSlider({.label = "Scale",
                                .low = 0.1f,
                                .high = 10,
                                .usual = 1,
                                .logarithmic = true,
                                .mark = "swatch.scale"},
                               settings.options.scale);
  changed |= settingSlider({.label = "Turn",
                            .low = -180,
                            .high = 180,
                            .usual = 0,
                            .format = "%.0f deg",
                            .mark = "swatch.rotation"},
                           settings.rotation);
  if (settings.borderKind == BorderKind::Hard) return changed;
  changed |= settingSlider({.label = "Band",
                            .low = 0,
                            .high = kWidestBorder,
                            .usual = 16,
                            .format = "%.1f",
                            .mark = "swatch.border"},
                           settings.borderWidth);
  tooltip("Width of the border's band,\nmean point spacings");
  return changed;
}

bool borderKinds(RegionSettings& settings) {
  constexpr std::array kKinds{"Hard", "Blend", "Cut"};  // by BorderKind
  mutedText("Border");
  auto kind = static_cast<int>(settings.borderKind);
  const bool changed = segments("border", kKinds.data(), static_cast<int>(kKinds.size()), kind);
  tooltip(
      "Hard: as the points were assigned\nBlend: both patterns pass into one another\n"
      "Cut: along the features of both patterns, where it is seen least\n"
      "Of two regions blend counts before hard, and hard before cut");
  settings.borderKind = static_cast<BorderKind>(kind);
  return changed;
}

}  // namespace

void SwatchPanel::dragCrop(const PixelRect& crop, ImVec2 mouse, float pixel, ImVec2 size) {
  if (ImGui::IsItemActivated()) {
    drag_ = {.grip = Grip::New, .from = mouse, .before = crop, .now = crop};
    for (int corner = 0; corner < 4; ++corner)
      if (near(mouse, cornerOf(crop, corner), px(kGripRadius) / pixel))
        drag_.grip = Grip::Corner, drag_.from = cornerOf(crop, 3 - corner);
    const ImVec2 low = cornerOf(crop, 0), high = cornerOf(crop, 3);
    const bool whole = low.x == 0 && low.y == 0 && high.x == size.x && high.y == size.y;
    if (drag_.grip == Grip::New && !whole && mouse.x > low.x && mouse.x < high.x &&
        mouse.y > low.y && mouse.y < high.y)
      drag_.grip = Grip::Move;
  }
  if (!ImGui::IsItemActive() || !ImGui::IsMouseDragging(0, 2)) return;
  if (drag_.grip == Grip::Move) {
    const auto shifted = [](int at, float by, int length, float limit) {
      return std::clamp(at + static_cast<int>(std::lround(by)), 0,
                        static_cast<int>(limit) - length);
    };
    drag_.now.x = shifted(drag_.before.x, mouse.x - drag_.from.x, crop.width, size.x);
    drag_.now.y = shifted(drag_.before.y, mouse.y - drag_.from.y, crop.height, size.y);
  } else {
    drag_.now = rectangle(drag_.from, mouse, size);
  }
}

void SwatchPanel::picture(const Region& region, const SwatchLibrary::Entry& entry, Engine& engine) {
  const auto w = static_cast<float>(entry.imageWidth), h = static_cast<float>(entry.imageHeight);
  const float pixel = px(kPicture) / std::max(w, h);
  const ImVec2 size(pixel * w, pixel * h);
  ImGui::InvisibleButton("picture", size);
  markItem("swatch.crop");
  if (drag_.grip == Grip::None)
    tooltip("Drag over the part to take. A double click takes the whole image.");
  const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
  const ImVec2 at = ImGui::GetIO().MousePos;
  const ImVec2 mouse((at.x - min.x) / pixel, (at.y - min.y) / pixel);
  const PixelRect whole{0, 0, entry.imageWidth, entry.imageHeight};
  const PixelRect crop = region.reference.crop.value_or(whole);
  const bool croppable = w >= kSmallestCrop && h >= kSmallestCrop;
  if (croppable) dragCrop(crop, mouse, pixel, {w, h});
  const auto take = [&](std::optional<PixelRect> part) {
    SwatchReference reference = region.reference;
    reference.crop = part;
    if (!(reference == region.reference))
      engine.submit(SetSwatch{.region = region.id, .reference = reference});
  };
  if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0)) {
    take(std::nullopt);
    drag_ = {};
  } else if (drag_.grip != Grip::None && ImGui::IsItemDeactivated()) {
    if (!(drag_.now == crop)) take(drag_.now);
    drag_.grip = Grip::None;
  }
  ImGui::GetWindowDrawList()->AddImage(guiTexture(entry.thumbnail.id()), min, max);
  const PixelRect shown = drag_.grip != Grip::None ? drag_.now : crop;
  const auto onScreen = [&](ImVec2 p) { return ImVec2(min.x + pixel * p.x, min.y + pixel * p.y); };
  if (!(shown == whole))
    drawCrop(min, max, onScreen(cornerOf(shown, 0)), onScreen(cornerOf(shown, 3)));
  mutedText(shown == whole ? fmt::format("{} x {} pixels", entry.imageWidth, entry.imageHeight)
                           : fmt::format("{} x {} of {} x {} pixels", shown.width, shown.height,
                                         entry.imageWidth, entry.imageHeight));
}

void SwatchPanel::grid(const Region& region, const SwatchLibrary& library, Engine& engine) {
  const float side = px(kSide), space = px(theme::kGapSmall);
  const float width = ImGui::GetContentRegionAvail().x;
  const int columns = std::max(1, static_cast<int>((width + space) / (side + space)));
  int k = 0;
  for (const SwatchLibrary::Entry& entry : library.entries()) {
    if (k++ % columns != 0) ImGui::SameLine(0, space);
    const scope::Id id(entry.path.c_str());
    if (ImGui::InvisibleButton("swatch", {side, side}))
      engine.submit(SetSwatch{.region = region.id, .reference = {.path = entry.path.string()}});
    markItem(fmt::format("swatch.{}", entry.path.stem().string()));
    tooltip(entry.path.filename().string());
    const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddImageRounded(guiTexture(entry.thumbnail.id()), min, max, {0, 0}, {1, 1},
                          IM_COL32_WHITE, px(theme::kRadius));
    const bool taken = entry.path == region.reference.path;
    if (taken || ImGui::IsItemHovered())
      list->AddRect(min, max, theme::packed(taken ? theme::kAccent : theme::kLineStrong),
                    px(theme::kRadius), 0, px(taken ? 2.5f : 1.5f));
  }
}

// The further maps of the swatch: which file each is, a way to choose it and to take it off.
void SwatchPanel::channels(const Region& region, Engine& engine) {
  if (!ImGui::TreeNodeEx("Material maps", ImGuiTreeNodeFlags_NoTreePushOnOpen)) {
    markItem("swatch.maps");
    return;
  }
  markItem("swatch.maps");
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto channel = static_cast<Channel>(c);
    const std::string name(channelName(channel)), path = region.reference.channels[channel];
    const scope::Id id(name.c_str());
    const ImVec2 at = ImGui::GetCursorPos();
    ImGui::SetCursorPosY(at.y + 0.5f * (px(theme::kButtonHeight) - ImGui::GetTextLineHeight()));
    mutedText(name);
    ImGui::SetCursorPos({at.x + px(kMapLabel), at.y});
    const float remove = path.empty() ? 0 : px(kSmallIcon + theme::kGapSmall);
    const std::string file =
        path.empty() ? "Choose..." : std::filesystem::path(path).filename().string();
    if (textButton(file.c_str(), ButtonKind::quiet, Icon::none,
                   ImGui::GetContentRegionAvail().x - remove, "map." + name))
      asked_ = channel;
    if (path.empty()) continue;
    tooltip(path);
    ImGui::SameLine(0, px(theme::kGapSmall));
    if (iconButton(
            {.icon = Icon::close, .id = "remove", .tooltip = "Take off", .size = kSmallIcon})) {
      SetSwatch set{.region = region.id, .reference = region.reference, .findChannels = false};
      set.reference.channels[channel].clear();
      engine.submit(set);
    }
    markItem("map." + name + ".remove");
  }
}

bool SwatchPanel::draw(const Region& region, RegionSettings& settings, SwatchLibrary& library,
                       Engine& engine) {
  bool changed = false;
  const SwatchLibrary::Entry* entry =
      region.reference.path.empty() ? nullptr : library.wanted(region.reference.path);
  if (entry) {
    {
      const scope::Group left;
      picture(region, *entry, engine);
    }
    ImGui::SameLine(px(kPicture + 2 * theme::kGap));
    {
      const scope::Group right;
      const scope::ItemWidth width(ImGui::GetContentRegionAvail().x);
      changed = sliders(settings);
    }
  } else {
    drag_ = {};
    mutedTextWrapped("No swatch: choose one below, or drop an image on the region.");
  }
  if (entry) changed |= borderKinds(settings);
  if (entry) channels(region, engine);
  ImGui::Dummy(px(0, theme::kGapSmall));
  grid(region, library, engine);
  return changed;
}

}  // namespace dapple
