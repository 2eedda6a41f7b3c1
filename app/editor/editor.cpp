#include "app/editor/editor.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>

#include "app/editor/option_widgets.h"
#include "app/gui/gui_context.h"
#include "app/gui/gui_renderer.h"
#include "app/gui/item_marks.h"
#include "app/gui/theme.h"
#include "base/errors.h"
#include "io/image_io.h"

namespace dapple {
namespace {

using theme::px;

constexpr DetailPacer::Milliseconds kBudget(25);  // of a frame's 33 ms, for the picture
constexpr float kNoticeSeconds = 8;
constexpr double kZoomStep = 1;
constexpr ImGuiWindowFlags kFixed =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
    ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNavFocus;

struct ToolRow {
  Tool tool;
  const char* label;
  const char* id;
  const char* tip;
  int key;
};
constexpr ToolRow kTools[] = {
    {Tool::Brush, "Br", "tool.brush", "Brush: select on the surface (B)", 'B'},
    {Tool::Rectangle, "Re", "tool.rectangle", "Rectangle (R)", 'R'},
    {Tool::Lasso, "La", "tool.lasso", "Lasso (L)", 'L'},
    {Tool::Polygon, "Po", "tool.polygon", "Polygon: click corners, double click ends (P)", 'P'},
    {Tool::Wand, "Wa", "tool.wand", "Wand: what is like the point clicked on (W)", 'W'},
    {Tool::Stroke, "St", "tool.stroke", "Orientation: stroke where the pattern runs (O)", 'O'},
};

bool isImage(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* known :
       {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".bmp", ".webp", ".tga", ".hdr", ".gif"})
    if (extension == known) return true;
  return false;
}

std::string grouped(std::size_t n) {
  std::string digits = std::to_string(n);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

bool button(const char* label, const char* id, float width = 0) {
  const bool pressed = ImGui::Button(label, {width, px(theme::kButtonHeight)});
  markItem(id);
  return pressed;
}

void heading(const char* text) {
  ImGui::PushFont(GuiContext::current().fonts().bold);
  ImGui::TextUnformatted(text);
  ImGui::PopFont();
}

}  // namespace

// Where everything is in this frame, pixels.
struct Editor::Layout {
  float width, height, menu, status, left, right, uiScale;
  ImVec2 viewMin() const { return {left, menu}; }
  ImVec2 viewSize() const {
    return {std::max(1.f, width - left - right), std::max(1.f, height - menu - status)};
  }
};

Editor::Editor(EditorOptions options)
    : options_(std::move(options)),
      engine_({.threads = options_.threads,
               .readImage = [](const std::filesystem::path& path) { return readImage(path); },
               .changed = options_.wake}),
      snapshot_(engine_.snapshot()),
      view_(workers_),
      library_([](const std::filesystem::path& path) { return readImage(path); }) {
  library_.addFolder(options_.assets / "swatches");
}

Editor::~Editor() = default;

const Region& Editor::chosen() const {
  const Region* region = findRegion(snapshot_->document, chosen_);
  return region ? *region : snapshot_->document.regions->front();
}

void Editor::choose(RegionId region) {
  chosen_ = region;
  tools_.region = region;
}

void Editor::say(const std::string& text, bool error) {
  notices_.push_back({text, error, kNoticeSeconds});
}

void Editor::open(const std::filesystem::path& path) {
  if (path.extension() == ".dapple") {
    engine_.submit(OpenProject{path.string(), {}});
  } else if (isImage(path)) {
    library_.add(path);
    engine_.submit(SetSwatch{chosen_, {path.string(), {}}});
  } else {
    engine_.submit(OpenScan{path.string(), {}});
  }
}

void Editor::openSample() {
  engine_.submit(OpenScan{(options_.assets / "scans" / "creature.ply").string(), {}});
  engine_.submit(
      SetSwatch{kUnassigned, {(options_.assets / "swatches" / "scales.png").string(), {}}});
  engine_.submit(Synthesize{});
}

void Editor::synthesize(std::optional<RegionId> region) {
  engine_.submit(Synthesize{region});
}

void Editor::startScreen(const Layout& layout) {
  const ImVec2 size = px(420, 300);
  const ImVec2 min = layout.viewMin(), area = layout.viewSize();
  ImGui::SetNextWindowPos({min.x + 0.5f * (area.x - size.x), min.y + 0.5f * (area.y - size.y)});
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("start", nullptr, kFixed);
  ImGui::PushFont(GuiContext::current().fonts().title);
  ImGui::TextUnformatted("Dapple");
  ImGui::PopFont();
  ImGui::PushStyleColor(ImGuiCol_Text, theme::kTextMuted);
  ImGui::TextWrapped(
      "Textures scans by example. Drop a scan here (PLY, OBJ, XYZ), or begin with the sample.");
  ImGui::PopStyleColor();
  ImGui::Dummy(px(0, theme::kGapLarge));
  if (button("Open the sample", "start.open-sample", -1)) openSample();
  ImGui::End();
}

void Editor::menuBar() {
  if (!ImGui::BeginMainMenuBar()) return;
  if (ImGui::BeginMenu("File")) {
    if (ImGui::MenuItem("Open the sample")) openSample();
    if (ImGui::MenuItem("Quit", "Ctrl+Q")) close_ = true;
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Edit")) {
    if (ImGui::MenuItem("Undo", "Ctrl+Z", false, snapshot_->cursor > 0)) engine_.submit(Undo{});
    if (ImGui::MenuItem("Redo", "Ctrl+Shift+Z", false,
                        snapshot_->cursor + 1 < snapshot_->history->size()))
      engine_.submit(Redo{});
    ImGui::Separator();
    if (ImGui::MenuItem("Select all", "Ctrl+A")) engine_.submit(SelectAll{});
    if (ImGui::MenuItem("Select none", "Ctrl+Shift+A")) engine_.submit(Select{});
    if (ImGui::MenuItem("Invert", "Ctrl+I")) engine_.submit(InvertSelection{});
    if (ImGui::MenuItem("Grow", "+")) engine_.submit(GrowSelection{});
    if (ImGui::MenuItem("Shrink", "-")) engine_.submit(ShrinkSelection{});
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("View")) {
    for (const NamedView& view : allViews())
      if (ImGui::MenuItem(std::string(view.name).c_str(), nullptr, settings_.show == view.view))
        settings_.show = view.view;
    ImGui::Separator();
    for (const char* name : {"front", "back", "left", "right", "top", "bottom", "iso"})
      if (ImGui::MenuItem(name)) view_.camera().setView(name);
    if (ImGui::MenuItem("Perspective", "Numpad 5", !view_.camera().orthographic))
      view_.camera().toggleProjection();
    ImGui::EndMenu();
  }
  ImGui::EndMainMenuBar();
}

void Editor::toolbar(const Layout& layout) {
  ImGui::SetNextWindowPos({0, layout.menu});
  ImGui::SetNextWindowSize({layout.left, layout.viewSize().y});
  ImGui::Begin("tools", nullptr, kFixed);
  for (const ToolRow& row : kTools) {
    const bool selected = tools_.tool == row.tool;
    if (selected) ImGui::PushStyleColor(ImGuiCol_Button, theme::kAccentSoft);
    if (button(row.label, row.id, -1) && !selected) {
      hand_.abort(view_);
      tools_.tool = row.tool;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", row.tip);
    if (selected) ImGui::PopStyleColor();
  }
  ImGui::End();
}

void Editor::regionList() {
  heading("Regions");
  const Document& document = snapshot_->document;
  for (const Region& region : *document.regions) {
    ImGui::PushID(region.id);
    ImGui::ColorButton("colour", {region.colour.r, region.colour.g, region.colour.b, 1},
                       ImGuiColorEditFlags_NoTooltip, px(16, 16));
    ImGui::SameLine();
    if (ImGui::Selectable(region.name.c_str(), region.id == chosen_, 0,
                          {ImGui::GetContentRegionAvail().x - px(60), 0}))
      choose(region.id);
    markItem(fmt::format("region.{}", region.id));
    ImGui::SameLine();
    bool visible = region.visible;
    if (ImGui::Checkbox("##visible", &visible)) {
      SetRegion set{region.id};
      set.visible = visible;
      engine_.submit(set);
    }
    ImGui::SameLine();
    bool locked = region.locked;
    if (ImGui::Checkbox("##locked", &locked)) {
      SetRegion set{region.id};
      set.locked = locked;
      engine_.submit(set);
    }
    ImGui::PopID();
  }
  const bool selected = document.selection && document.selection->count() > 0;
  ImGui::BeginDisabled(!selected);
  if (button("New from selection", "region.add", -1)) engine_.submit(AddRegion{});
  if (button("Add selection to it", "region.assign", -1)) engine_.submit(AssignSelection{chosen_});
  ImGui::EndDisabled();
}

void Editor::swatchPanel() {
  heading("Swatch");
  const Region& region = chosen();
  const float side = px(56), gap = px(theme::kGapSmall);
  const int columns =
      std::max(1, static_cast<int>(ImGui::GetContentRegionAvail().x / (side + gap)));
  int k = 0;
  for (const SwatchLibrary::Entry& entry : library_.entries()) {
    const bool current = region.reference.path == entry.path.string();
    if (k++ % columns != 0) ImGui::SameLine(0, gap);
    ImGui::PushID(entry.path.c_str());
    ImGui::PushStyleColor(ImGuiCol_Button, current ? theme::kAccent : theme::kControl);
    if (ImGui::ImageButton(guiTexture(entry.thumbnail.id()), {side - px(6), side - px(6)}, {0, 0},
                           {1, 1}, static_cast<int>(px(3))))
      engine_.submit(SetSwatch{chosen_, {entry.path.string(), {}}});
    ImGui::PopStyleColor();
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", entry.path.filename().c_str());
    markItem(fmt::format("swatch.{}", entry.path.stem().string()));
    ImGui::PopID();
  }
}

void Editor::methodPanel() {
  heading("Synthesis");
  TextureOptions options = chosen().options;
  if (optionWidgets(options)) {
    SetRegion set{chosen().id};
    set.options = options;
    engine_.submit(set);
  }
  const bool ready = snapshot_->document.scan && chosen().swatch;
  ImGui::BeginDisabled(!ready);
  ImGui::PushStyleColor(ImGuiCol_Button, theme::kAccent);
  ImGui::PushStyleColor(ImGuiCol_ButtonHovered, theme::kAccentHovered);
  ImGui::PushStyleColor(ImGuiCol_Text, theme::kOnAccent);
  if (button("Synthesize", "synthesize.all", -1)) synthesize({});
  ImGui::PopStyleColor(3);
  ImGui::EndDisabled();
  if (status_.busy && !status_.job.empty()) {
    ImGui::ProgressBar(static_cast<float>(status_.progress.fraction), {-1, 0}, status_.job.c_str());
    const float width = (ImGui::GetContentRegionAvail().x - 2 * px(theme::kGap)) / 3;
    if (button(status_.paused ? "Resume" : "Pause", "job.pause", width))
      status_.paused ? engine_.resume() : engine_.pause();
    ImGui::SameLine();
    if (button("Stop", "job.stop", width)) engine_.stop();
    ImGui::SameLine();
    if (button("Cancel", "job.cancel", width)) engine_.cancel();
  }
}

void Editor::historyPanel() {
  heading("History");
  ImGui::BeginChild("history", {0, px(160)}, true);
  for (std::size_t k = 0; k < snapshot_->history->size(); ++k) {
    ImGui::PushID(static_cast<int>(k));
    if (k > snapshot_->cursor) ImGui::PushStyleColor(ImGuiCol_Text, theme::kTextFaint);
    if (ImGui::Selectable((*snapshot_->history)[k].c_str(), k == snapshot_->cursor))
      engine_.submit(GoTo{k});
    if (k > snapshot_->cursor) ImGui::PopStyleColor();
    ImGui::PopID();
  }
  ImGui::EndChild();
}

void Editor::sidePanel(const Layout& layout) {
  ImGui::SetNextWindowPos({layout.width - layout.right, layout.menu});
  ImGui::SetNextWindowSize({layout.right, layout.viewSize().y});
  ImGui::Begin("side", nullptr, kFixed & ~ImGuiWindowFlags_NoScrollbar);
  regionList();
  ImGui::Dummy(px(0, theme::kGap));
  swatchPanel();
  ImGui::Dummy(px(0, theme::kGap));
  methodPanel();
  ImGui::Dummy(px(0, theme::kGap));
  historyPanel();
  ImGui::End();
}

void Editor::statusBar(const Layout& layout) {
  ImGui::SetNextWindowPos({0, layout.height - layout.status});
  ImGui::SetNextWindowSize({layout.width, layout.status});
  ImGui::Begin("status", nullptr, kFixed);
  const Document& document = snapshot_->document;
  std::string text = document.scan ? fmt::format("{} points", grouped(document.size())) : "No scan";
  if (document.scan && document.scan->prepared.normalsMade) text += "  ·  normals estimated";
  if (document.selection && document.selection->count() > 0)
    text += fmt::format("  ·  {} selected", grouped(document.selection->count()));
  if (status_.busy && !status_.job.empty()) {
    text += fmt::format("  ·  {} {:.0f} %", status_.job, 100 * status_.progress.fraction);
    if (status_.progress.pointsPerSecond > 0)
      text += fmt::format(", {} points/s",
                          grouped(static_cast<std::size_t>(status_.progress.pointsPerSecond)));
  }
  ImGui::TextUnformatted(text.c_str());
  ImGui::SameLine(layout.width - px(170));
  ImGui::TextDisabled("%s", "drawn by the processor");
  ImGui::End();
}

void Editor::navigate(const Layout& layout, bool hovered) {
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 min = layout.viewMin(), size = layout.viewSize();
  const Viewport viewport{static_cast<int>(size.x), static_cast<int>(size.y)};
  const vec2 cursor(io.MousePos.x - min.x, io.MousePos.y - min.y);
  const vec2 drag(io.MouseDelta.x, io.MouseDelta.y);
  const bool turns = ImGui::IsMouseDown(1) || (io.KeyAlt && ImGui::IsMouseDown(0));
  const bool pans = ImGui::IsMouseDown(2) || (io.KeyShift && ImGui::IsMouseDown(1));
  const bool begins = hovered && (ImGui::IsMouseClicked(1) || ImGui::IsMouseClicked(2) ||
                                  (io.KeyAlt && ImGui::IsMouseClicked(0)));
  if (begins) moving_ = true;
  if (!turns && !pans) moving_ = false;
  OrbitCamera& camera = view_.camera();
  if (moving_ && glm::length(drag) > 0)
    pans ? camera.pan(drag, viewport) : camera.orbit(drag, viewport);
  if (hovered && io.MouseWheel != 0) {
    if (io.KeyAlt) {
      tools_.brushRadius =
          std::clamp(tools_.brushRadius * std::pow(1.15f, io.MouseWheel), 3.f, 500.f);
      return;
    }
    std::optional<vec3> surface;
    if (!view_.empty() && view_.picture().width > 0) {
      const Camera seen = view_.pictureCamera();
      if (const auto under = view_.picker().pointAt(view_.pickView(seen, false), cursor, 4))
        surface = under->position;
    }
    camera.zoom(kZoomStep * io.MouseWheel, cursor, viewport, surface);
  }
}

void Editor::toolInput(const Layout& layout, bool hovered) {
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 min = layout.viewMin();
  const bool free = hovered && !io.KeyAlt && !moving_;
  hand_.update({.cursor = {io.MousePos.x - min.x, io.MousePos.y - min.y},
                .hovered = free,
                .pressed = ImGui::IsMouseClicked(0),
                .released = ImGui::IsMouseReleased(0),
                .down = ImGui::IsMouseDown(0),
                .doubleClicked = ImGui::IsMouseDoubleClicked(0),
                .shift = io.KeyShift,
                .ctrl = io.KeyCtrl,
                .uiScale = layout.uiScale},
               tools_, view_, engine_);
}

void Editor::drawOverlays(const Layout& layout) {
  if (view_.empty() || view_.picture().width == 0) return;
  const Camera camera = view_.pictureCamera();
  const OverlayView over(camera, view_.picture(), view_.splatRadius(), layout.uiScale);
  OverlayLines lines;
  if (settings_.strokes) {
    std::vector<SurfaceStroke> strokes;
    for (const Region& region : *snapshot_->document.regions)
      if (region.strokes)
        for (const Stroke& stroke : *region.strokes) strokes.push_back({stroke.positions});
    lines = strokeLines(over, strokes);
  }
  const OverlayLines hand = hand_.overlay(tools_, view_);
  lines.insert(lines.end(), hand.begin(), hand.end());
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 min = layout.viewMin();
  std::vector<ImVec2> points;
  for (const OverlayLine& line : withCasing(lines, layout.uiScale)) {
    points.clear();
    for (const vec2& p : line.points) points.push_back({min.x + p.x, min.y + p.y});
    const glm::vec4& c = line.colour;
    list->AddPolyline(points.data(), static_cast<int>(points.size()),
                      ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, c.a}),
                      line.closed ? ImDrawFlags_Closed : ImDrawFlags_None, line.width);
  }
}

void Editor::viewPanel(const Layout& layout) {
  const ImVec2 min = layout.viewMin(), size = layout.viewSize();
  ImGui::SetNextWindowPos(min);
  ImGui::SetNextWindowSize(size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::Begin("view", nullptr, kFixed | ImGuiWindowFlags_NoScrollWithMouse);
  ImGui::PopStyleVar();
  ImGui::InvisibleButton("view", size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  markItem("view");
  const bool hovered = ImGui::IsItemHovered();
  navigate(layout, hovered);
  toolInput(layout, hovered);
  settled_ = !view_.draw({static_cast<int>(size.x), static_cast<int>(size.y)}, kBudget);
  if (view_.texture() != 0 && !view_.empty())
    ImGui::GetWindowDrawList()->AddImage(guiTexture(view_.texture()), min,
                                         {min.x + size.x, min.y + size.y});
  drawOverlays(layout);
  ImGui::End();
}

void Editor::shortcuts() {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput) return;
  const auto pressed = [&](int key) { return ImGui::IsKeyPressed(key, false); };
  if (io.KeyCtrl) {
    if (pressed('Z')) io.KeyShift ? engine_.submit(Redo{}) : engine_.submit(Undo{});
    if (pressed('Y')) engine_.submit(Redo{});
    if (pressed('A')) io.KeyShift ? engine_.submit(Select{}) : engine_.submit(SelectAll{});
    if (pressed('I')) engine_.submit(InvertSelection{});
    if (pressed('Q')) close_ = true;
    return;
  }
  for (const ToolRow& row : kTools)
    if (pressed(row.key)) {
      hand_.abort(view_);
      tools_.tool = row.tool;
    }
  if (pressed('[')) tools_.brushRadius = std::max(3.f, tools_.brushRadius / 1.15f);
  if (pressed(']')) tools_.brushRadius = std::min(500.f, tools_.brushRadius * 1.15f);
  if (pressed('F')) io.KeyShift ? view_.frameAll() : view_.frameSelection();
  if (pressed('C')) settings_.show = View::Colour;
  if (pressed('N')) settings_.show = View::Normals;
  if (pressed('D')) settings_.show = View::State;
  if (pressed('S')) settings_.show = View::Regions;
  if (pressed(static_cast<int>(Key::escape))) {
    if (hand_.active())
      hand_.abort(view_);
    else if (!status_.job.empty())
      engine_.cancel();
  }
  if (pressed(static_cast<int>(Key::backspace))) hand_.takeBack();
}

void Editor::notices(const Layout& layout) {
  if (status_.errors != errors_) say(status_.error, true);
  if (status_.notes != notesSeen_) say(status_.note, false);
  errors_ = status_.errors, notesSeen_ = status_.notes;
  float y = layout.height - layout.status - px(theme::kGapLarge);
  for (Notice& notice : notices_) {
    notice.left -= ImGui::GetIO().DeltaTime;
    const ImVec2 text = ImGui::CalcTextSize(notice.text.c_str(), nullptr, false, px(420));
    const ImVec2 padding = px(12, 10);
    const ImVec2 size{text.x + 2 * padding.x, text.y + 2 * padding.y};
    const ImVec2 min{layout.left + px(theme::kGapLarge), y - size.y};
    ImDrawList* list = ImGui::GetForegroundDrawList();
    list->AddRectFilled(min, {min.x + size.x, min.y + size.y}, theme::packed(theme::kRaised),
                        px(theme::kRadius));
    list->AddRectFilled(min, {min.x + px(3), min.y + size.y},
                        theme::packed(notice.error ? theme::kError : theme::kInfo),
                        px(theme::kRadius));
    list->AddText(nullptr, 0, {min.x + padding.x, min.y + padding.y}, theme::packed(theme::kText),
                  notice.text.c_str(), nullptr, px(420));
    y -= size.y + px(theme::kGap);
  }
  std::erase_if(notices_, [](const Notice& notice) { return notice.left <= 0; });
}

bool Editor::frame(int width, int height, float uiScale) {
  snapshot_ = engine_.snapshot();
  status_ = engine_.status();
  if (!findRegion(snapshot_->document, chosen_)) choose(kUnassigned);
  for (const std::filesystem::path& path : GuiContext::current().dropped()) open(path);
  view_.follow(snapshot_, settings_);
  shortcuts();

  menuBar();
  const Layout layout{.width = static_cast<float>(width),
                      .height = static_cast<float>(height),
                      .menu = ImGui::GetFrameHeight(),
                      .status = px(theme::kStatusHeight),
                      .left = px(theme::kToolbarWidth),
                      .right = px(theme::kPanelWidth),
                      .uiScale = uiScale};
  viewPanel(layout);
  toolbar(layout);
  sidePanel(layout);
  statusBar(layout);
  if (!snapshot_->document.scan && !status_.busy) startScreen(layout);
  notices(layout);
  return !settled_ || library_.loading() || !notices_.empty();
}

}  // namespace dapple
