#include "app/editor/export_dialog.h"

#include <algorithm>
#include <cmath>

#include "app/gui/gui_context.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"

namespace dapple {
namespace {

using theme::px;

constexpr float kWidth = 440, kButton = 120;  // logical pixels
constexpr float kMostParts = 24;

struct FormatRow {
  ScanFormat format;
  const char *label, *mark, *holds;
};
constexpr FormatRow kFormats[] = {
    {ScanFormat::Ply, "PLY", "export.format.ply",
     "All that was in the scan's file, colours, material channels, texture coordinates of a mesh, "
     "and where each colour comes from."},
    {ScanFormat::Obj, "OBJ", "export.format.obj",
     "Positions, normals, colours, faces and their texture coordinates, as text; the swatch in a "
     ".mtl file beside it."},
    {ScanFormat::Xyz, "XYZ", "export.format.xyz", "Positions, normals and colours, as text."},
};

bool hasChannels(const Document& document) {
  const auto& sources = document.results.sources;
  return std::any_of(sources.begin(), sources.end(),
                     [](const auto& source) { return source->maps != nullptr; }) ||
         std::any_of(document.regions->begin(), document.regions->end(),
                     [](const Region& region) { return region.maps != nullptr; });
}

// A modal in the middle of the window with a title.
struct Dialog {
  Dialog(const char* id, const char* title, bool& opening, bool& open) {
    if (opening) ImGui::OpenPopup(id);
    opening = false;
    const ImVec2 area = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({area.x / 2, area.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({px(kWidth), 0});
    modal_.emplace(id, nullptr,
                   ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                       ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize);
    open = modal_->open;
    if (!open) return;
    const scope::Font font(GuiContext::current().fonts().bold);
    ImGui::TextUnformatted(title);
    ImGui::Dummy(px(0, theme::kGapSmall));
  }
  explicit operator bool() const { return modal_->open; }

 private:
  scope::Style padding_{ImGuiStyleVar_WindowPadding, px(theme::kGapLarge, theme::kGapLarge)};
  std::optional<scope::Modal> modal_;
};

// Cancel and the button that goes on, at the right. True: go on.
bool dialogButtons(const char* accept, const std::string& mark) {
  ImGui::Dummy(px(0, theme::kGap));
  alignRight(px(2 * kButton + theme::kGap));
  const bool cancelled =
      textButton("Cancel", ButtonKind::normal, Icon::none, px(kButton), mark + ".cancel") ||
      ImGui::IsKeyPressed(static_cast<int>(Key::escape));
  ImGui::SameLine(0, px(theme::kGap));
  const bool accepted =
      textButton(accept, ButtonKind::primary, Icon::none, px(kButton), mark + ".accept") ||
      ImGui::IsKeyPressed(static_cast<int>(Key::enter));
  if (cancelled || accepted) ImGui::CloseCurrentPopup();
  return accepted && !cancelled;
}

}  // namespace

void ExportDialog::formatRows() {
  for (const FormatRow& row : kFormats) {
    if (ImGui::RadioButton(row.label, format_ == row.format)) format_ = row.format;
    markItem(row.mark);
    ImGui::SameLine(px(84));
    mutedTextWrapped(row.holds);
  }
}

void ExportDialog::losses(const Document& document) const {
  const auto lines =
      exportLosses(format_, document.scan->prepared.scan, options_, hasChannels(document));
  ImGui::Dummy(px(0, theme::kGapSmall));
  heading(lines.empty() ? "Nothing is lost." : "Not in the file");
  for (const std::string& line : lines) mutedTextWrapped(line);
}

void ExportDialog::contentRows(const Document& document) {
  const bool corners =
      format_ != ScanFormat::Xyz && !document.scan->prepared.scan.mesh.triangles.empty();
  if (format_ != ScanFormat::Ply && !corners) return;
  divider();
  if (corners) {
    toggle("Texture coordinates", options_.corners, "export.corners");
    tooltip("Where in the swatch the corners of the mesh's faces lie");
  }
  if (format_ != ScanFormat::Ply) return;
  toggle("Source map", options_.sourceMap, "export.source-map");
  tooltip("Swatch, texel, frame, patch, state, error and order of each point");
  if (!document.points().colours.empty())
    toggle("The scan's own colours, too", options_.keepColours, "export.keep-colours");
  if (hasChannels(document)) toggle("Material channels", options_.channels, "export.channels");
  toggle("As text", ascii_, "export.ascii");
}

bool ExportDialog::draw(const Document& document) {
  const Dialog dialog("export", "Export the textured scan", opening_, open_);
  if (!dialog || !document.scan) return false;
  formatRows();
  contentRows(document);
  losses(document);
  return dialogButtons("Export...", "export");
}

std::optional<SegmentAutomatically> SegmentDialog::draw() {
  const Dialog dialog("segment", "Segment automatically", opening_, open_);
  if (!dialog) return std::nullopt;
  mutedTextWrapped(
      "Parts that end at creases and where the colour changes take the place of all regions that "
      "are not locked.");
  const scope::ItemWidth width(ImGui::GetContentRegionAvail().x);
  slider({.label = "Parts",
          .low = 2,
          .high = kMostParts,
          .usual = 4,
          .format = "%.0f",
          .mark = "segment.parts"},
         parts_);
  parts_ = std::round(parts_);
  if (!dialogButtons("Segment", "segment")) return std::nullopt;
  return SegmentAutomatically{.parts = static_cast<int>(parts_)};
}

}  // namespace dapple
