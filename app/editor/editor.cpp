#include "app/editor/editor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/editor/editor_layout.h"
#include "app/editor/editor_memory.h"
#include "app/editor/view_legend.h"
#include "app/gui/gui_context.h"
#include "app/gui/gui_renderer.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "io/file_names.h"
#include "io/image_io.h"
#include "swatch/material_files.h"

namespace dapple {
namespace {

// Of a frame's 33 ms, for the picture: OpenGL in software takes some ten for the rest, and more
// while a synthesis has the processors.
constexpr DetailPacer::Milliseconds kBudget(12);
constexpr float kBrushStep = 1.15f;  // times, a notch of the wheel
constexpr float kPick = 4;           // logical pixels
constexpr float kStrokeReach = 8;    // logical pixels
constexpr char kProject[] = ".dapple";

}  // namespace

Editor::Editor(EditorOptions options)
    : options_(std::move(options)),
      engine_({.threads = options_.threads,
               .readImage = [](const std::filesystem::path& path) { return readImage(path); },
               .changed = options_.wake}),
      snapshot_(engine_.snapshot()),
      view_(workers_, options_.wake),
      library_([](const std::filesystem::path& path) { return readImage(path); }),
      navigation_(&navigationPreset("Default")),
      overlays_(options_.wake),
      memory_(std::make_unique<Memory>(*this)) {
  library_.addFolder(options_.assets / "swatches");
  addActions();
  memory_->recall();
}

Editor::~Editor() {
  memory_->leave();
}

const Region& Editor::chosen() const {
  const Region* region = findRegion(snapshot_->document, chosen_);
  return region ? *region : snapshot_->document.regions->front();
}

void Editor::choose(RegionId region) {
  if (region != chosen_) editing_.reset();
  chosen_ = region;
}

void Editor::chooseNewRegion(const Document& before) {
  if (before.regions == snapshot_->document.regions || before.scan != snapshot_->document.scan)
    return;
  for (const Region& region : *snapshot_->document.regions)
    if (!findRegion(before, region.id)) return choose(region.id);
}

void Editor::setLive(bool live) {
  live_ = live;
  engine_.setLive(live);
}

RegionSettings Editor::settingsShown() const {
  return editing_ ? *editing_ : RegionSettings::of(chosen());
}

void Editor::changeSettings(const RegionSettings& settings) {
  const RegionSettings now = settingsShown();
  editing_ = settings;
  SetRegion set{.region = chosen().id, .gesture = gesture_};
  if (!(settings.options == now.options)) set.options = settings.options;
  if (settings.rotation != now.rotation) set.rotation = settings.rotation;
  if (settings.borderWidth != now.borderWidth) set.borderWidth = settings.borderWidth;
  if (settings.borderKind != now.borderKind) set.borderKind = settings.borderKind;
  engine_.submit(set);
}

void Editor::chooseTool(Tool tool) {
  if (tool == tools_.tool) return;
  hand_.abort(view_);
  tools_.tool = tool;
}

bool Editor::hasSelection() const {
  const PointMask* selection = snapshot_->document.selection.get();
  return selection && selection->count() > 0;
}

void Editor::open(const std::filesystem::path& path) {
  if (isImageFile(path)) return openImage(path);
  if (std::filesystem::is_directory(path)) return openFolder(path);
  memory_->guarded([this, path] { openDocument(path); });
}

void Editor::openImage(const std::filesystem::path& path) {
  library_.add(path);
  engine_.submit(SetSwatch{chosen_, {path.string(), {}}});
}

void Editor::openFolder(const std::filesystem::path& path) {
  const std::vector<std::filesystem::path> colours = colourImagesIn(path);
  if (colours.size() == 1) return openImage(colours.front());
  if (swatchesIn(path).empty())
    return notices_.warn(fmt::format("{} holds no image.", path.string()));
  library_.addFolder(path);
}

void Editor::openDocument(const std::filesystem::path& path) {
  choose(kUnassigned);  // the only region that the document is sure to have
  if (path.extension() == kProject)
    engine_.submit(OpenProject{path.string(), {}});
  else
    engine_.submit(OpenScan{path.string(), {}});
}

void Editor::openSampleNow() {
  const auto swatch = options_.assets / "swatches" / "scales.png";
  engine_.submit(OpenScan{(options_.assets / "scans" / "creature.ply").string(), {}});
  engine_.submit(SetSwatch{kUnassigned, {swatch.string(), {}}});
  engine_.submit(Synthesize{});
}

std::optional<RegionId> Editor::regionUnder(const Layout& layout) const {
  if (view_.empty() || view_.picture().width == 0) return std::nullopt;
  const vec2 cursor = layout.inView(ImGui::GetIO().MousePos);
  const auto under = view_.picker().pointAt(view_.pickView(view_.pictureCamera(), false), cursor,
                                            kPick * layout.uiScale);
  const Column<RegionId>& labels = snapshot_->document.labels;
  if (!under || under->point >= labels->size()) return std::nullopt;
  return (*labels)[under->point];
}

void Editor::pickStroke(vec2 place, float reach) {
  const OverlayView over(view_.pictureCamera(), view_.picture(), view_.splatRadius());
  stroke_ = strokeAt(over, snapshot_->document, place, reach);
  if (stroke_) choose(stroke_->region);
}

void Editor::cancel() {
  if (hand_.active())
    hand_.abort(view_);
  else if (stroke_ && !working())
    stroke_.reset();
  else if (working())
    engine_.cancel();
}

void Editor::zoomWheel(const Layout& layout) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.KeyAlt) {
    tools_.brushRadius =
        std::clamp(tools_.brushRadius * std::pow(kBrushStep, io.MouseWheel), 3.f, 500.f);
    return;
  }
  const vec2 cursor = layout.inView(io.MousePos);
  std::optional<vec3> surface;
  if (!view_.empty() && view_.picture().width > 0) {
    const Camera camera = view_.pictureCamera();
    const PickView pick = view_.pickView(camera, false);
    if (const auto under = view_.picker().pointAt(pick, cursor, kPick * layout.uiScale))
      surface = under->position;
  }
  if (navigation_->wheelZoomsToCursor)
    view_.camera().zoom(io.MouseWheel, cursor, layout.viewport(), surface);
  else
    view_.camera().zoom(io.MouseWheel, layout.viewCentre(), layout.viewport());
}

void Editor::navigate(const Layout& layout, bool hovered) {
  const ImGuiIO& io = ImGui::GetIO();
  if (motion_ && !ImGui::IsMouseDown(0) && !ImGui::IsMouseDown(1) && !ImGui::IsMouseDown(2))
    motion_.reset();
  if (hovered)
    for (int button = 0; button < 3; ++button)
      if (ImGui::IsMouseClicked(button))
        if (const auto motion = motionOf(*navigation_, button, modifiersHeld())) motion_ = motion;
  const vec2 drag(io.MouseDelta.x, io.MouseDelta.y);
  OrbitCamera& camera = view_.camera();
  if (motion_ && (drag.x != 0 || drag.y != 0)) {
    if (*motion_ == CameraMotion::orbit)
      camera.orbit(drag, layout.viewport());
    else if (*motion_ == CameraMotion::pan)
      camera.pan(drag, layout.viewport());
    else
      camera.zoom(-drag.y / (12 * layout.uiScale), layout.inView(io.MousePos), layout.viewport());
  }
  if (hovered && io.MouseWheel != 0) zoomWheel(layout);
}

void Editor::toolInput(const Layout& layout, bool hovered) {
  if (view_.opening()) return hand_.abort(view_);  // the points are not the document's yet
  const ImGuiIO& io = ImGui::GetIO();
  hand_.update({.cursor = layout.inView(io.MousePos),
                .hovered = hovered && !motion_,
                .pressed = ImGui::IsMouseClicked(0),
                .released = ImGui::IsMouseReleased(0),
                .down = ImGui::IsMouseDown(0),
                .doubleClicked = ImGui::IsMouseDoubleClicked(0),
                .shift = io.KeyShift,
                .ctrl = io.KeyCtrl,
                .uiScale = layout.uiScale},
               tools_, view_, engine_);
  if (const auto click = hand_.takeClick()) pickStroke(*click, kStrokeReach * layout.uiScale);
}

void Editor::showPicture(const Layout& layout) {
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const ImVec2 min = layout.viewMin(), size = layout.viewSize();
  if (view_.drawnByOpenGl()) {
    list->AddImage(guiTexture(view_.texture()), min, {min.x + size.x, min.y + size.y}, {0, 1},
                   {1, 0});
    return;
  }
  pictureLeft_ = static_cast<int>(min.x);
  pictureBottom_ = static_cast<int>(layout.height - min.y) - view_.picture().height;
  list->AddCallback(
      [](const ImDrawList*, const ImDrawCmd* command) {
        const Editor& editor = *static_cast<const Editor*>(command->UserCallbackData);
        editor.view_.copyPicture(editor.pictureLeft_, editor.pictureBottom_);
      },
      this);
}

void Editor::viewPanel(const Layout& layout) {
  const ImVec2 min = layout.viewMin(), size = layout.viewSize();
  ImGui::SetNextWindowPos(min);
  ImGui::SetNextWindowSize(size);
  const scope::Style padding(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  const scope::Style border(ImGuiStyleVar_WindowBorderSize, 0);
  const scope::Window window(
      "view", nullptr,
      kFixedWindow | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoScrollWithMouse);
  ImGui::InvisibleButton("view", size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  markItem("view");
  const bool hovered = ImGui::IsItemHovered();
  navigate(layout, hovered);
  toolInput(layout, hovered);
  // To complete every preview would take the processors from the synthesis.
  const bool passing = snapshot_->previewColour && !status_.paused;
  settled_ = !view_.draw(layout.viewport(), kBudget, passing);
  if (view_.texture() != 0 && !view_.empty()) showPicture(layout);
  overlays_.draw(
      view_, settings_,
      {.stroke = stroke_,
       .hand = hand_.overlay(tools_, view_),
       .field = tools_.tool == Tool::Stroke && tools_.field,
       .cursor = hovered ? std::optional(layout.inView(ImGui::GetIO().MousePos)) : std::nullopt},
      min);
  settled_ = settled_ && !overlays_.due();
  drawViewLegend(view_, settings_.show,
                 {min.x + theme::px(theme::kGap), min.y + size.y - theme::px(theme::kGap)});
}

// What the engine and the user have done since the last frame.
void Editor::takeNews(const Layout& layout) {
  const Document before = snapshot_->document;
  status_ = engine_.status();  // first: at rest, the snapshot is the last
  snapshot_ = engine_.snapshot();
  library_.update();
  chooseNewRegion(before);
  if (!findRegion(snapshot_->document, chosen_)) choose(kUnassigned);
  if (stroke_ && !findStroke(snapshot_->document, *stroke_)) stroke_.reset();
  if (ImGui::IsMouseClicked(0)) gesture_ = static_cast<unsigned>(ImGui::GetFrameCount());
  if (editing_ &&
      (*editing_ == RegionSettings::of(chosen()) || (!status_.busy && !ImGui::IsAnyItemActive())))
    editing_.reset();
  if (const auto& dropped = GuiContext::current().dropped(); !dropped.empty())
    memory_->openAll(dropped, regionUnder(layout));
  view_.follow(snapshot_, settings_);
}

bool Editor::frame(int width, int height) {
  const Layout layout{.width = static_cast<float>(width),
                      .height = static_cast<float>(height),
                      .menu = ImGui::GetFrameHeight(),
                      .status = theme::px(theme::kStatusHeight),
                      .left = theme::px(theme::kToolbarWidth),
                      .right = theme::px(theme::kPanelWidth),
                      .uiScale = GuiContext::current().uiScale()};
  takeNews(layout);
  actions_.dispatch(browser_.isOpen() || search_.isOpen() || sheet_.isOpen() || export_.isOpen() ||
                    segment_.isOpen() || memory_->isAsking());

  if (const scope::MainMenuBar bar; bar) actionMenus(actions_);
  viewPanel(layout);
  toolbar(layout);
  toolOptions(layout);
  sidePanel(layout);
  statusBar(layout);
  if (!hasScan() && !status_.busy) startScreen(layout);
  takeMessages();
  notices_.drawToasts(layout.width - layout.right, layout.height - layout.status);
  search_.draw(actions_);
  sheet_.draw(actions_, memory_->gestures());
  if (const auto command = segment_.draw()) engine_.submit(*command);
  if (export_.draw(snapshot_->document)) ask(Asking::Export);
  if (const auto path = browser_.draw()) answered(*path);
  memory_->remember(layout.width, layout.height);
  return !settled_ || library_.loading() || notices_.passing() || browser_.busy();
}

}  // namespace dapple
