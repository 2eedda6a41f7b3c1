// The parts round the 3D view.
#include <fmt/format.h>

#include "app/editor/editor_layout.h"
#include "app/editor/option_widgets.h"
#include "app/gui/gui_context.h"
#include "app/gui/gui_renderer.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"

namespace dapple {
namespace {

using theme::px;

constexpr float kSwatchSide = 58;      // logical pixels
constexpr float kHistoryHeight = 170;  // logical pixels
constexpr float kJobHeight = 52;       // logical pixels, while something is synthesized

void gap(float logical = theme::kGap) {
  ImGui::Dummy(px(0, logical));
}

void placeWindow(ImVec2 min, ImVec2 size) {
  ImGui::SetNextWindowPos(min);
  ImGui::SetNextWindowSize(size);
}

}  // namespace

void Editor::startScreen(const Layout& layout) {
  const ImVec2 size = px(440, 330), min = layout.viewMin(), area = layout.viewSize();
  placeWindow({min.x + 0.5f * (area.x - size.x), min.y + 0.5f * (area.y - size.y)}, size);
  const scope::Style padding(ImGuiStyleVar_WindowPadding, px(28, 28));
  const scope::Style rounding(ImGuiStyleVar_WindowRounding, px(theme::kRadiusLarge));
  const scope::Colour raised(ImGuiCol_WindowBg, theme::kRaised);
  const scope::Window window("start", nullptr,
                             kFixedWindow & ~ImGuiWindowFlags_NoBringToFrontOnFocus);
  {
    const scope::Font font(GuiContext::current().fonts().title);
    ImGui::TextUnformatted("Dapple");
  }
  mutedTextWrapped(
      "Textures scans by example: a scan, a small image, and every point gets its colour. Drop a "
      "scan or an image anywhere in this window.");
  gap(theme::kGapLarge);
  if (textButton("Open the sample", ButtonKind::primary, Icon::play, -1, "start.open-sample"))
    openSample();
  gap(theme::kGapSmall);
  if (textButton("Open scan...", ButtonKind::normal, Icon::folder, -1, "start.open-scan"))
    ask(Asking::Scan);
  gap(theme::kGapSmall);
  if (textButton("Open project...", ButtonKind::normal, Icon::file, -1, "start.open-project"))
    ask(Asking::Project);
}

void Editor::toolbar(const Layout& layout) {
  placeWindow({0, layout.menu}, {layout.left, layout.viewSize().y});
  const float side = (layout.left - px(theme::kIconButtonSize)) / 2;
  const scope::Style padding(ImGuiStyleVar_WindowPadding, ImVec2(side, px(theme::kGap)));
  const scope::Window window("tools", nullptr, kFixedWindow);
  for (const char* id :
       {"tool.brush", "tool.rectangle", "tool.lasso", "tool.polygon", "tool.wand", "tool.stroke"})
    actionButton(actions_, id);
  divider();
  for (const char* id : {"edit.undo", "edit.redo", "view.frame"}) actionButton(actions_, id);
}

// What the tool in hand can be told, over the upper left corner of the view.
void Editor::toolOptions(const Layout& layout) {
  if (!hasScan()) return;
  ImGui::SetNextWindowPos({layout.left + px(theme::kGap), layout.menu + px(theme::kGap)});
  ImGui::SetNextWindowBgAlpha(0.85f);
  const scope::Window window(
      "tool options", nullptr,
      (kFixedWindow & ~ImGuiWindowFlags_NoBringToFrontOnFocus) | ImGuiWindowFlags_AlwaysAutoResize);
  const scope::ItemWidth width(px(120));
  if (tools_.tool == Tool::Brush)
    ImGui::SliderFloat("Radius", &tools_.brushRadius, 3, 500, "%.0f px",
                       ImGuiSliderFlags_Logarithmic);
  if (tools_.tool == Tool::Wand) {
    constexpr const char* kBy[] = {"Normal", "Colour", "Distance"};
    int by = static_cast<int>(tools_.wand.by);
    if (segments("by", kBy, 3, by)) {
      tools_.wand.by = static_cast<WandBy>(by);
      tools_.wand.threshold = by == 0 ? 20.f : by == 1 ? 0.15f : 20.f;
    }
    const float most = tools_.wand.by == WandBy::Normal   ? 180.f
                       : tools_.wand.by == WandBy::Colour ? 1.f
                                                          : 500.f;
    ImGui::SliderFloat("Threshold", &tools_.wand.threshold, 0, most, "%.3g");
    toggle("Connected", tools_.wand.connected, "wand.connected");
  }
  if (tools_.tool != Tool::Wand && tools_.tool != Tool::Stroke)
    toggle("Through", tools_.through, "tool.through-toggle");
  if (tools_.tool == Tool::Stroke) mutedText("Draw where the swatch's top is to point.");
}

void Editor::regionRow(const Region& region) {
  const scope::Id id(region.id);
  const float side = px(14), height = px(theme::kRowHeight);
  const float icons = 2 * px(24) + px(theme::kGapSmall);
  const ImVec2 start = ImGui::GetCursorPos();
  if (ImGui::Selectable("##row", region.id == chosen_, ImGuiSelectableFlags_AllowItemOverlap,
                        {ImGui::GetContentRegionAvail().x - icons, height}))
    choose(region.id);
  markItem(fmt::format("region.row.{}", region.id));
  ImGui::SetCursorPos({start.x + px(theme::kGapSmall), start.y + 0.5f * (height - side)});
  colourChip({region.colour.r, region.colour.g, region.colour.b, 1}, side);
  ImGui::SetCursorPos(
      {start.x + side + px(12), start.y + 0.5f * (height - ImGui::GetTextLineHeight())});
  clippedText(region.name, ImGui::GetContentRegionAvail().x - icons);
  ImGui::SetCursorPos({start.x + ImGui::GetContentRegionAvail().x - icons + px(theme::kGapSmall),
                       start.y + 0.5f * (height - px(24))});
  SetRegion set{region.id};
  if (iconButton({.icon = region.visible ? Icon::eye : Icon::eyeOff,
                  .id = "visible",
                  .tooltip = region.visible ? "Hide" : "Show",
                  .size = 24})) {
    set.visible = !region.visible;
    engine_.submit(set);
  }
  ImGui::SameLine(0, 0);
  if (iconButton({.icon = region.locked ? Icon::lock : Icon::unlock,
                  .id = "locked",
                  .tooltip = region.locked ? "Unlock" : "Lock: its points stay as they are",
                  .selected = region.locked,
                  .size = 24})) {
    set.locked = !region.locked;
    engine_.submit(set);
  }
  ImGui::SetCursorPos({start.x, start.y + height + px(theme::kGapTiny)});
}

void Editor::regionList() {
  if (!sectionHeader("Regions", true, "panel.regions")) return;
  for (const Region& region : *snapshot_->document.regions) regionRow(region);
  for (const char* id : {"region.add", "region.assign", "region.segment", "region.remove"}) {
    actionButton(actions_, id);
    ImGui::SameLine(0, px(theme::kGapSmall));
  }
  ImGui::NewLine();
}

void Editor::swatchPanel() {
  if (!sectionHeader("Swatch", true, "panel.swatch")) return;
  const float side = px(kSwatchSide), space = px(theme::kGapSmall);
  const float width = ImGui::GetContentRegionAvail().x;
  const int columns = std::max(1, static_cast<int>((width + space) / (side + space)));
  const std::string current = chosen().reference.path;
  int k = 0;
  for (const SwatchLibrary::Entry& entry : library_.entries()) {
    if (k++ % columns != 0) ImGui::SameLine(0, space);
    const scope::Id id(entry.path.c_str());
    if (ImGui::InvisibleButton("swatch", {side, side}))
      engine_.submit(SetSwatch{chosen_, {entry.path.string(), {}}});
    markItem(fmt::format("swatch.{}", entry.path.stem().string()));
    tooltip(entry.path.filename().string());
    const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddImageRounded(guiTexture(entry.thumbnail.id()), min, max, {0, 0}, {1, 1},
                          IM_COL32_WHITE, px(theme::kRadius));
    const bool taken = entry.path == current;
    if (taken || ImGui::IsItemHovered())
      list->AddRect(min, max, theme::packed(taken ? theme::kAccent : theme::kLineStrong),
                    px(theme::kRadius), 0, px(taken ? 2.5f : 1.5f));
  }
  actionTextButton(actions_, "region.swatch", false, -1);
}

void Editor::methodPanel() {
  if (!sectionHeader("Synthesis", true, "panel.synthesis")) return;
  TextureOptions options = editing_ ? *editing_ : chosen().options;
  const OptionEdit edit = optionWidgets(options);
  // One step of the history for a whole drag.
  if (edit != OptionEdit::None) editing_ = options;
  if (edit == OptionEdit::Done) {
    SetRegion set{chosen().id};
    set.options = options;
    engine_.submit(set);
  }
  if (editing_ && *editing_ == chosen().options) editing_.reset();
}

void Editor::jobPanel() {
  if (!working()) {
    actionTextButton(actions_, "synthesize.all", true, -1);
    return;
  }
  const Progress& progress = status_.progress;
  const ProgressButton pressed =
      progressWidget({.stage = status_.job,
                      .fraction = static_cast<float>(progress.fraction),
                      .pointsPerSecond = progress.pointsPerSecond,
                      .secondsLeft = progress.secondsLeft > 0 ? progress.secondsLeft : -1,
                      .paused = status_.paused});
  if (pressed == ProgressButton::pause) engine_.pause();
  if (pressed == ProgressButton::resume) engine_.resume();
  if (pressed == ProgressButton::stop) engine_.stop();
  if (pressed == ProgressButton::cancel) engine_.cancel();
}

void Editor::historyPanel() {
  if (!sectionHeader("History", true, "panel.history")) return;
  const scope::Child list("history", {0, px(kHistoryHeight)});
  const auto& labels = *snapshot_->history;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const scope::Id id(static_cast<int>(k));
    const bool undone = k > snapshot_->cursor;
    const scope::Colour colour(ImGuiCol_Text, undone ? theme::kTextFaint : theme::kText);
    if (ImGui::Selectable(labels[k].c_str(), k == snapshot_->cursor)) engine_.submit(GoTo{k});
    markItem(fmt::format("history.{}", k));
  }
}

void Editor::sidePanel(const Layout& layout) {
  placeWindow({layout.width - layout.right, layout.menu}, {layout.right, layout.viewSize().y});
  const scope::Window window("side", nullptr, kFixedWindow);
  // What starts and stops the work is always in sight.
  const float footer = px(working() ? kJobHeight : theme::kButtonHeight + theme::kGap);
  if (const scope::Child panels("panels", {0, -footer}); panels) {
    regionList();
    swatchPanel();
    methodPanel();
    historyPanel();
  }
  jobPanel();
}

void Editor::statusBar(const Layout& layout) {
  placeWindow({0, layout.height - layout.status}, {layout.width, layout.status});
  const scope::Style padding(ImGuiStyleVar_WindowPadding,
                             ImVec2(px(theme::kGap), 0.5f * (layout.status - px(13)) - px(1)));
  const scope::Style small(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
  const scope::Window window("status", nullptr, kFixedWindow);
  const scope::Font font(GuiContext::current().fonts().small);
  const Document& document = snapshot_->document;
  std::string text = "No scan";
  if (document.scan) {
    text = fmt::format("{} points", shownCount(document.size()));
    if (document.scan->prepared.normalsMade) text += "   no normals: estimated";
    if (hasSelection())
      text += fmt::format("   {} selected", shownCount(document.selection->count()));
  }
  if (!view_.missing().empty()) text += "   " + view_.missing();
  if (working()) {
    text += fmt::format("   {}: {:.0f} %", status_.job, 100 * status_.progress.fraction);
    if (const auto rate = static_cast<std::size_t>(status_.progress.pointsPerSecond); rate > 0)
      text += fmt::format(", {} points/s", shownCount(rate));
  }
  ImGui::TextUnformatted(text.c_str());
  const char* drawn = view_.drawnByOpenGl() ? "drawn by OpenGL" : "drawn by the processor";
  ImGui::SameLine();
  alignRight(ImGui::CalcTextSize(drawn).x);
  ImGui::TextUnformatted(drawn);
}

void Editor::takeMessages() {
  if (status_.errors != errors_) notices_.error(status_.error);
  if (status_.notes != notes_) notices_.info(status_.note);
  errors_ = status_.errors, notes_ = status_.notes;
}

}  // namespace dapple
