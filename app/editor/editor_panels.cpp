// The parts round the 3D view.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/editor/editor_layout.h"
#include "app/editor/editor_memory.h"
#include "app/editor/option_widgets.h"
#include "app/gui/gui_context.h"
#include "app/gui/gui_renderer.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"
#include "document/automatic_options.h"

namespace dapple {
namespace {

using theme::px;

constexpr float kLiveWidth = 72;       // logical pixels
constexpr float kHistoryHeight = 170;  // logical pixels
constexpr float kJobHeight = 52;       // logical pixels, while something is synthesized
// A stroke's: times the region's. Nearer to 1 than the least it is the region's own.
constexpr float kLeastScale = 0.25f, kMostScale = 4, kNoScale = 1.03f;

void gap(float logical = theme::kGap) {
  ImGui::Dummy(px(0, logical));
}

void placeWindow(ImVec2 min, ImVec2 size) {
  ImGui::SetNextWindowPos(min);
  ImGui::SetNextWindowSize(size);
}

// For the slider just drawn, unless it is being dragged: it would hide what is below.
void hint(std::string_view text) {
  if (!ImGui::IsMouseDown(0)) tooltip(text);
}

// What auto stands for in a region, as far as its swatch has been analysed.
ChoiceShown choiceFor(const Document& document, const Region& region) {
  if (region.options.method != Method::Auto || !region.swatch) return {};
  const auto analysis = knownAnalysis(document, region);
  if (!analysis) return {};
  const AutomaticOptions automatic = chosenOptions(document, region, *analysis);
  ChoiceShown shown{.text = choiceText(automatic.options, region.options)};
  for (const auto* lines : {&automatic.reasons, &automatic.warnings})
    for (const std::string& line : *lines)
      shown.reasons += (shown.reasons.empty() ? "" : "\n") + line;
  return shown;
}

}  // namespace

void Editor::startScreen(const Layout& layout) {
  const ImVec2 size(px(440), px(290) + memory_->startListsHeight()), min = layout.viewMin(),
                                                                     area = layout.viewSize();
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
  memory_->startLists();
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
  const scope::ItemWidth width(px(180));
  if (tools_.tool == Tool::Brush)
    slider({.label = "Radius",
            .low = 3,
            .high = 500,
            .usual = ToolSettings{}.brushRadius,
            .format = "%.0f px",
            .logarithmic = true,
            .mark = "brush.radius"},
           tools_.brushRadius);
  if (tools_.tool == Tool::Wand) wandOptions();
  if (tools_.tool != Tool::Wand && tools_.tool != Tool::Stroke)
    toggle("Through", tools_.through, "tool.through-toggle");
  if (tools_.tool == Tool::Stroke) {
    strokeOptions();
    toggle("Show directions", tools_.field, "stroke.field");
  }
  if (!overlays_.note().empty()) mutedText(overlays_.note());
}

void Editor::wandOptions() {
  constexpr float kMost[] = {180, 1, 500}, kUsual[] = {20, 0.15f, 20};
  constexpr const char* kBy[] = {"Normal", "Colour", "Distance", "Part"};
  constexpr const char* kFormats[] = {"%.0f deg", "%.2f", "%.0f"};
  constexpr int kPart = 3;
  int by = tools_.wholePart ? kPart : static_cast<int>(tools_.wand.by);
  if (segments("by", kBy, 4, by)) {
    tools_.wholePart = by == kPart;
    if (by != kPart) {
      tools_.wand.by = static_cast<WandBy>(by);
      tools_.wand.threshold = kUsual[by];
    }
  }
  if (by == kPart) {
    mutedText("Takes all that is connected.");
    return;
  }
  slider({.label = "Threshold",
          .low = 0,
          .high = kMost[by],
          .usual = kUsual[by],
          .format = kFormats[by],
          .mark = "wand.threshold"},
         tools_.wand.threshold);
  toggle("Connected", tools_.wand.connected, "wand.connected");
}

void Editor::strokeOptions() {
  const Stroke* stroke = stroke_ ? findStroke(snapshot_->document, *stroke_) : nullptr;
  if (!stroke) {
    mutedText("Draw where the swatch's top is to point. Click a stroke to choose it.");
    return;
  }
  Stroke changed = *stroke;
  bool differs = slider({.label = "Weight",
                         .low = 0.1f,
                         .high = 10,
                         .usual = 1,
                         .logarithmic = true,
                         .mark = "stroke.weight"},
                        changed.weight);
  hint("Against other strokes, where they meet");
  float scale = stroke->scale.value_or(1);
  if (slider({.label = "Scale",
              .low = kLeastScale,
              .high = kMostScale,
              .usual = 1,
              .logarithmic = true,
              .mark = "stroke.scale"},
             scale)) {
    const bool none = std::max(scale, 1 / scale) < kNoScale;
    changed.scale = none ? std::nullopt : std::optional(scale);
    differs = differs || changed.scale != stroke->scale;
  }
  hint("How many times larger the swatch is along the stroke");
  ImGui::SameLine(0, px(theme::kGap));
  actionButton(actions_, "stroke.reset-scale");
  if (differs) engine_.submit(SetStroke{stroke_->region, stroke_->index, changed, gesture_});
  actionTextButton(actions_, "stroke.reverse", false);
  ImGui::SameLine(0, px(theme::kGapSmall));
  actionTextButton(actions_, "stroke.remove", false);
}

void Editor::regionList() {
  if (!sectionHeader("Regions", true, "panel.regions")) return;
  choose(regionPanel_.draw(snapshot_->document, chosen().id, library_, engine_));
  for (const char* id :
       {"region.add", "region.assign", "region.segment", "region.isolate", "region.remove"}) {
    actionButton(actions_, id);
    ImGui::SameLine(0, px(theme::kGapSmall));
  }
  ImGui::NewLine();
}

void Editor::swatchPanel() {
  if (!sectionHeader("Swatch", true, "panel.swatch")) return;
  RegionSettings settings = settingsShown();
  if (swatchPanel_.draw(chosen(), settings, library_, engine_)) changeSettings(settings);
  if (const auto channel = swatchPanel_.takeAsked()) {
    askedMap_ = *channel;
    ask(Asking::Map);
  }
  actionTextButton(actions_, "region.swatch", false, -1);
}

void Editor::methodPanel() {
  if (!sectionHeader("Synthesis", true, "panel.synthesis")) return;
  RegionSettings settings = settingsShown();
  if (optionWidgets(settings.options, choiceFor(snapshot_->document, chosen())))
    changeSettings(settings);
}

void Editor::jobPanel() {
  if (!working()) {
    const float side = px(kLiveWidth);
    actionTextButton(actions_, "synthesize.all", true,
                     ImGui::GetContentRegionAvail().x - side - px(theme::kGap));
    ImGui::SameLine(0, px(theme::kGap));
    bool live = live_;
    if (toggle("Live", live, "synthesize.live-toggle")) setLive(live);
    tooltip("Synthesize again after each edit what the edit touches");
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
  const auto& labels = *snapshot_->history;
  mutedText(fmt::format("{} steps, {:.1f} MB", labels.size(),
                        static_cast<double>(status_.historyBytes) / 1e6));
  const scope::Child list("history", {0, px(kHistoryHeight)});
  int& seen = *ImGui::GetStateStorage()->GetIntRef(ImGui::GetID("cursor"), 0);
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const scope::Id id(static_cast<int>(k));
    const bool undone = k > snapshot_->cursor;
    const scope::Colour colour(ImGuiCol_Text, undone ? theme::kTextFaint : theme::kText);
    if (ImGui::Selectable(labels[k].c_str(), k == snapshot_->cursor)) engine_.submit(GoTo{k});
    markItem(fmt::format("history.{}", k));
    if (k == snapshot_->cursor && std::exchange(seen, static_cast<int>(k)) != static_cast<int>(k))
      ImGui::SetScrollHereY();
  }
}

void Editor::logPanel() {
  if (!sectionHeader("Messages", false, "panel.log")) return;
  const scope::Child list("log", {0, px(kHistoryHeight)});
  notices_.drawLog();
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
    logPanel();
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
