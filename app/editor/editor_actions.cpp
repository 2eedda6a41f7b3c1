// What the user can do: one table for menus, keys, help and command search.
#include <fmt/format.h>

#include <algorithm>

#include "app/editor/editor_layout.h"
#include "app/editor/editor_memory.h"

namespace dapple {
namespace {

struct ToolRow {
  Tool tool;
  const char *id, *label, *keys, *help;
  Icon icon;
};
constexpr ToolRow kTools[] = {
    {Tool::Brush, "tool.brush", "Brush", "B", "Selects what it passes over on the surface.",
     Icon::brush},
    {Tool::Rectangle, "tool.rectangle", "Rectangle", "R", "Selects what lies inside.",
     Icon::rectangle},
    {Tool::Lasso, "tool.lasso", "Lasso", "L", "Selects what lies inside a line drawn freely.",
     Icon::lasso},
    {Tool::Polygon, "tool.polygon", "Polygon", "P",
     "Click the corners; a double click or the first corner ends it. Backspace takes one back.",
     Icon::polygon},
    {Tool::Wand, "tool.wand", "Wand", "W", "Selects what is like the point clicked on.",
     Icon::wand},
    {Tool::Stroke, "tool.stroke", "Orientation", "O",
     "Stroke over the surface where the swatch's top is to point.", Icon::orientation},
};

const std::vector<FileKind> kScans{{"Scans", {".ply", ".obj", ".xyz", ".txt"}}, {"All files", {}}};
const std::vector<FileKind> kSwatches{
    {"Images", {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".bmp", ".webp", ".tga"}},
    {"All files", {}}};
const std::vector<FileKind> kProjects{{"Projects", {".dapple"}}};
// By ScanFormat.
const std::vector<FileKind> kExports[] = {
    {{"PLY", {".ply"}}}, {{"OBJ", {".obj"}}}, {{"XYZ", {".xyz"}}}};

}  // namespace

void Editor::ask(Asking what) {
  asking_ = what;
  FileQuestion question;
  switch (what) {
    case Asking::Scan:
      question = {.title = "Open scan", .kinds = kScans};
      break;
    case Asking::Swatch:
      question = {
          .title = "Choose a swatch", .folder = options_.assets / "swatches", .kinds = kSwatches};
      break;
    case Asking::Swatches:
      question = {.purpose = BrowseFor::folder, .title = "Add a folder of swatches"};
      break;
    case Asking::Map:
      question = {.title = fmt::format("Choose the {} map", channelName(askedMap_)),
                  .folder = std::filesystem::path(chosen().reference.path).parent_path(),
                  .kinds = kSwatches};
      break;
    case Asking::Project:
      question = {.title = "Open project", .kinds = kProjects};
      break;
    case Asking::SaveProject:
      question = {.purpose = BrowseFor::save,
                  .title = "Save project",
                  .name = "untitled",
                  .kinds = kProjects};
      break;
    default:
      question = {.purpose = BrowseFor::save,
                  .title = "Export the textured scan",
                  .accept = "Export",
                  .name = "textured",
                  .kinds = kExports[static_cast<std::size_t>(export_.format())]};
  }
  memory_->show(std::move(question));
}

void Editor::answered(const std::filesystem::path& path) {
  memory_->noteAnswer(path);
  if (asking_ == Asking::SaveProject) {
    engine_.submit(SaveProject{path.string()});
  } else if (asking_ == Asking::Export) {
    ExportScan command = export_.command();
    command.path = path.string();
    engine_.submit(command);
  } else if (asking_ == Asking::Swatches) {
    openFolder(path);
  } else if (asking_ == Asking::Map) {
    SetSwatch set{.region = chosen().id, .reference = chosen().reference};
    set.reference.channels[askedMap_] = path.string();
    engine_.submit(set);
  } else {
    open(path);
  }
  asking_ = Asking::Nothing;
}

void Editor::addFileActions() {
  actions_.add({.id = "file.open",
                .label = "Open scan...",
                .menu = "File",
                .shortcuts = shortcuts("Ctrl+O"),
                .help = "A point cloud or a mesh: PLY, OBJ, XYZ.",
                .icon = Icon::folder,
                .run = [this] { ask(Asking::Scan); }});
  actions_.add({.id = "file.open-project",
                .label = "Open project...",
                .menu = "File",
                .shortcuts = shortcuts("Ctrl+Shift+O"),
                .run = [this] { ask(Asking::Project); }});
  actions_.add({.id = "file.sample",
                .label = "Open the sample",
                .menu = "File",
                .help = "A small scan with a swatch, textured at once.",
                .icon = Icon::play,
                .run = [this] { openSample(); }});
  memory_->addRecentActions();
  actions_.add({.id = "file.save",
                .label = "Save project",
                .menu = "File",
                .shortcuts = shortcuts("Ctrl+S"),
                .icon = Icon::save,
                .separatorBefore = true,
                .enabled = [this] { return hasScan(); },
                .run =
                    [this] {
                      if (project_.empty())
                        ask(Asking::SaveProject);
                      else
                        engine_.submit(SaveProject{project_});
                    }});
  actions_.add({.id = "file.save-as",
                .label = "Save project as...",
                .menu = "File",
                .shortcuts = shortcuts("Ctrl+Shift+S"),
                .enabled = [this] { return hasScan(); },
                .run = [this] { ask(Asking::SaveProject); }});
  actions_.add({.id = "file.export",
                .label = "Export scan...",
                .menu = "File",
                .shortcuts = shortcuts("Ctrl+E"),
                .help = "As PLY, OBJ or XYZ; what the format cannot hold is told before.",
                .icon = Icon::exportFile,
                .enabled = [this] { return snapshot_->document.results.colour != nullptr; },
                .run = [this] { export_.open(); }});
  actions_.add({.id = "file.quit",
                .label = "Quit",
                .menu = "File",
                .shortcuts = shortcuts("Ctrl+Q"),
                .separatorBefore = true,
                .run = [this] { memory_->guarded([this] { close_ = true; }); }});
}

void Editor::addEditActions() {
  struct Row {
    const char *id, *label, *keys;
    Icon icon;
    std::function<bool()> enabled;
    Command command;
  };
  const auto scan = [this] { return hasScan(); };
  const auto selection = [this] { return hasSelection(); };
  const auto undoable = [this] { return snapshot_->cursor > 0; };
  const auto redoable = [this] { return snapshot_->cursor + 1 < snapshot_->history->size(); };
  const Row rows[] = {
      {"edit.undo", "Undo", "Ctrl+Z", Icon::undo, undoable, Undo{}},
      {"edit.redo", "Redo", "Ctrl+Shift+Z, Ctrl+Y", Icon::redo, redoable, Redo{}},
      {"select.all", "Select all", "Ctrl+A", Icon::none, scan, SelectAll{}},
      {"select.none", "Select none", "Ctrl+Shift+A", Icon::none, selection, Select{}},
      {"select.invert", "Invert selection", "Ctrl+I", Icon::invert, scan, InvertSelection{}},
      {"select.grow", "Grow selection", "Ctrl+Numpad +", Icon::grow, selection, GrowSelection{}},
      {"select.shrink", "Shrink selection", "Ctrl+Numpad -", Icon::shrink, selection,
       ShrinkSelection{}},
  };
  for (const Row& row : rows)
    actions_.add({.id = row.id,
                  .label = row.label,
                  .menu = "Edit",
                  .shortcuts = shortcuts(row.keys),
                  .icon = row.icon,
                  .separatorBefore = std::string_view(row.id) == "select.all",
                  .enabled = row.enabled,
                  .run = [this, command = row.command] { engine_.submit(command); }});
}

void Editor::addRegionActions() {
  actions_.add({.id = "region.add",
                .label = "New region from selection",
                .menu = "Region",
                .shortcuts = shortcuts("Ctrl+G"),
                .icon = Icon::plus,
                .enabled = [this] { return hasSelection(); },
                .run = [this] { engine_.submit(AddRegion{}); }});
  actions_.add({.id = "region.assign",
                .label = "Add selection to region",
                .menu = "Region",
                .shortcuts = shortcuts("G"),
                .help = "The selected points become the chosen region's.",
                .icon = Icon::fill,
                .enabled = [this] { return hasSelection(); },
                .run = [this] { engine_.submit(AssignSelection{chosen_}); }});
  actions_.add({.id = "region.release",
                .label = "Take selection out of its regions",
                .menu = "Region",
                .shortcuts = shortcuts("E"),
                .help = "The selected points become the first region's again.",
                .icon = Icon::eraser,
                .enabled = [this] { return hasSelection(); },
                .run = [this] { engine_.submit(AssignSelection{kUnassigned}); }});
  actions_.add({.id = "region.select",
                .label = "Select region",
                .menu = "Region",
                .enabled = [this] { return hasScan(); },
                .run = [this] { engine_.submit(SelectRegion{chosen_}); }});
  actions_.add({.id = "region.segment",
                .label = "Segment automatically...",
                .menu = "Region",
                .help = "Parts that end at creases and where the colour changes.",
                .icon = Icon::split,
                .enabled = [this] { return hasScan(); },
                .run = [this] { segment_.open(); }});
  addVisibilityActions();
  actions_.add({.id = "region.rename",
                .label = "Rename region...",
                .menu = "Region",
                .shortcuts = shortcuts("F2"),
                .run = [this] { regionPanel_.rename(chosen()); }});
  actions_.add({.id = "region.remove",
                .label = "Remove region",
                .menu = "Region",
                .icon = Icon::trash,
                .enabled = [this] { return chosen_ != kUnassigned; },
                .run = [this] { engine_.submit(RemoveRegion{chosen_}); }});
}

void Editor::addVisibilityActions() {
  actions_.add({.id = "region.hide",
                .label = "Hide region",
                .menu = "Region",
                .shortcuts = shortcuts("H"),
                .icon = Icon::eyeOff,
                .separatorBefore = true,
                .run = [this] {
                  SetRegion set{.region = chosen().id};
                  set.visible = !chosen().visible;
                  engine_.submit(set);
                }});
  actions_.add({.id = "region.show-all",
                .label = "Show all regions",
                .menu = "Region",
                .shortcuts = shortcuts("Shift+H"),
                .icon = Icon::eye,
                .run = [this] { engine_.submit(ShowOnly{}); }});
  const auto alone = [this] {
    for (const Region& region : *snapshot_->document.regions)
      if (region.visible != (region.id == chosen().id)) return false;
    return snapshot_->document.regions->size() > 1;
  };
  actions_.add(
      {.id = "region.isolate",
       .label = "Show only this region",
       .menu = "Region",
       .shortcuts = shortcuts("/"),
       .help = "Again: all are shown.",
       .icon = Icon::layers,
       .enabled = [this] { return snapshot_->document.regions->size() > 1; },
       .checked = alone,
       .run = [this, alone] { engine_.submit(alone() ? ShowOnly{} : ShowOnly{chosen().id}); }});
}

void Editor::addSynthesisActions() {
  actions_.add({.id = "region.swatch",
                .label = "Choose swatch...",
                .menu = "Region",
                .shortcuts = shortcuts("I"),
                .icon = Icon::grid,
                .separatorBefore = true,
                .run = [this] { ask(Asking::Swatch); }});
  actions_.add({.id = "library.folder",
                .label = "Add a folder of swatches...",
                .menu = "Region",
                .help = "A folder of one material, its colour image and maps, becomes the "
                        "region's swatch.",
                .icon = Icon::folder,
                .run = [this] { ask(Asking::Swatches); }});
  actions_.add({.id = "synthesize.region",
                .label = "Synthesize region",
                .menu = "Region",
                .shortcuts = shortcuts("Ctrl+Enter"),
                .icon = Icon::play,
                .enabled = [this] { return hasScan() && chosen().swatch && !working(); },
                .run = [this] { engine_.submit(Synthesize{chosen_}); }});
  actions_.add({.id = "region.blend",
                .label = "Make borders",
                .menu = "Region",
                .help = "By the kinds and widths of the regions; a synthesis does it, too.",
                .enabled = [this] { return snapshot_->document.results.source && !working(); },
                .run = [this] { engine_.submit(BlendBorders{}); }});
  actions_.add({.id = "synthesize.live",
                .label = "Live",
                .menu = "Region",
                .shortcuts = shortcuts("Ctrl+L"),
                .help = "After each edit what it touches is synthesized again.",
                .checked = [this] { return live_; },
                .run = [this] { setLive(!live_); }});
  actions_.add({.id = "synthesize.all",
                .label = "Synthesize all",
                .menu = "Region",
                .shortcuts = shortcuts("Ctrl+Shift+Enter"),
                .icon = Icon::play,
                .enabled =
                    [this] {
                      const auto& regions = *snapshot_->document.regions;
                      return hasScan() && !working() &&
                             std::any_of(regions.begin(), regions.end(), [](const Region& region) {
                               return region.swatch && !region.locked;
                             });
                    },
                .run = [this] { engine_.submit(Synthesize{}); }});
}

void Editor::addStrokeActions() {
  const auto some = [this] { return stroke_.has_value(); };
  actions_.add({.id = "stroke.reverse",
                .label = "Reverse stroke",
                .menu = "Region",
                .help = "The swatch's top points the other way.",
                .separatorBefore = true,
                .enabled = some,
                .run = [this] {
                  Stroke turned = *findStroke(snapshot_->document, *stroke_);
                  std::reverse(turned.positions.begin(), turned.positions.end());
                  std::reverse(turned.points.begin(), turned.points.end());
                  engine_.submit(SetStroke{stroke_->region, stroke_->index, turned});
                }});
  actions_.add({.id = "stroke.reset-scale",
                .label = "Reset stroke's scale",
                .menu = "Region",
                .help = "The swatch is as large along it as the region has it.",
                .icon = Icon::reset,
                .enabled =
                    [this] {
                      const Stroke* stroke =
                          stroke_ ? findStroke(snapshot_->document, *stroke_) : nullptr;
                      return stroke && stroke->scale;
                    },
                .run =
                    [this] {
                      Stroke reset = *findStroke(snapshot_->document, *stroke_);
                      reset.scale.reset();
                      engine_.submit(SetStroke{stroke_->region, stroke_->index, reset});
                    }});
  actions_.add({.id = "stroke.remove",
                .label = "Remove stroke",
                .menu = "Region",
                .shortcuts = shortcuts("Delete"),
                .icon = Icon::trash,
                .enabled = some,
                .run = [this] {
                  engine_.submit(RemoveStroke{stroke_->region, stroke_->index});
                  stroke_.reset();
                }});
}

void Editor::addViewActions() {
  const auto key = [](View view) {
    switch (view) {
      case View::Colour:
        return "C, 1";
      case View::Normals:
        return "N, 2";
      case View::State:
        return "D, 3";
      case View::Patch:
        return "4";
      case View::Distortion:
        return "5";
      case View::Order:
        return "6";
      case View::Regions:
        return "S, 7";
      case View::Coordinates:
        return "8";
      default:
        return "";
    }
  };
  for (const NamedView& view : allViews())
    actions_.add({.id = fmt::format("show.{}", view.name),
                  .label = fmt::format("Show {}", view.name),
                  .menu = "View",
                  .shortcuts = shortcuts(key(view.view)),
                  .help = std::string(view.shows),
                  .checked = [this, show = view.view] { return settings_.show == show; },
                  .run = [this, show = view.view] { settings_.show = show; }});
}

void Editor::addCameraActions() {
  const std::pair<const char*, Shading> lights[] = {
      {"off", Shading::Off}, {"headlight", Shading::Headlight}, {"studio", Shading::Studio}};
  for (const auto& [name, shading] : lights)
    actions_.add({.id = fmt::format("shading.{}", name),
                  .label = name,
                  .menu = "View/Light",
                  .checked = [this, light = shading] { return settings_.shading == light; },
                  .run = [this, light = shading] { settings_.shading = light; }});
  const std::pair<const char*, const char*> directions[] = {{"front", "Numpad 1"},
                                                            {"back", "Ctrl+Numpad 1"},
                                                            {"right", "Numpad 3"},
                                                            {"left", "Ctrl+Numpad 3"},
                                                            {"top", "Numpad 7"},
                                                            {"bottom", "Ctrl+Numpad 7"},
                                                            {"iso", ""}};
  for (const auto& [name, keys] : directions)
    actions_.add({.id = fmt::format("view.{}", name),
                  .label = name,
                  .menu = "View/Look from",
                  .shortcuts = shortcuts(keys),
                  .run = [this, from = std::string(name)] { view_.camera().setView(from); }});
  actions_.add({.id = "view.perspective",
                .label = "Perspective",
                .menu = "View",
                .shortcuts = shortcuts("Numpad 5"),
                .separatorBefore = true,
                .checked = [this] { return !view_.camera().orthographic; },
                .run = [this] { view_.camera().toggleProjection(); }});
  actions_.add({.id = "view.frame",
                .label = "Frame selection",
                .menu = "View",
                .shortcuts = shortcuts("F, ."),
                .icon = Icon::frame,
                .run = [this] { view_.frameSelection(); }});
  actions_.add({.id = "view.frame-all",
                .label = "Frame all",
                .menu = "View",
                .shortcuts = shortcuts("Shift+F, Home"),
                .run = [this] { view_.frameAll(); }});
}

void Editor::addDisplayActions() {
  struct Flag {
    const char *id, *label, *keys, *help;
    bool ViewSettings::*shown;
  };
  constexpr Flag kFlags[] = {
      {"view.strokes", "Strokes", "", "", &ViewSettings::strokes},
      {"view.outlines", "Region outlines", "", "", &ViewSettings::outlines},
      {"view.directions", "Directions", "Shift+D",
       "Where the swatches' tops point, by the strokes as they are.", &ViewSettings::directions},
      {"view.singularities", "Singularities", "Shift+O",
       "Where the directions cannot be smooth: a ring where they turn with the way round it, a "
       "diamond where against it.",
       &ViewSettings::singularities},
      {"view.texels", "Swatch inside the splats", "", "", &ViewSettings::texels},
  };
  for (const Flag& flag : kFlags)
    actions_.add({.id = flag.id,
                  .label = flag.label,
                  .menu = "View",
                  .shortcuts = shortcuts(flag.keys),
                  .help = flag.help,
                  .separatorBefore = std::string_view(flag.id) == "view.strokes",
                  .checked = [this, shown = flag.shown] { return settings_.*shown; },
                  .run = [this, shown = flag.shown] { settings_.*shown = !(settings_.*shown); }});
  const std::pair<const char*, vec3> grounds[] = {{"dark", ViewSettings{}.background},
                                                  {"black", vec3(0)},
                                                  {"grey", vec3(0.5f)},
                                                  {"white", vec3(1)}};
  for (const auto& [name, colour] : grounds)
    actions_.add({.id = fmt::format("background.{}", name),
                  .label = name,
                  .menu = "View/Background",
                  .checked = [this, c = colour] { return settings_.background == c; },
                  .run = [this, c = colour] { settings_.background = c; }});
  const std::pair<const char*, DrawnBy> renderers[] = {{"automatic", DrawnBy::Automatic},
                                                       {"processor", DrawnBy::Processor},
                                                       {"OpenGL", DrawnBy::OpenGl}};
  for (const auto& [name, by] : renderers)
    actions_.add({.id = fmt::format("renderer.{}", name),
                  .label = name,
                  .menu = "View/Drawn by",
                  .help = "Automatic: OpenGL on graphics hardware, else the processor.",
                  .checked = [this, drawnBy = by] { return settings_.drawnBy == drawnBy; },
                  .run = [this, drawnBy = by] { settings_.drawnBy = drawnBy; }});
}

void Editor::addToolActions() {
  for (const ToolRow& row : kTools)
    actions_.add({.id = row.id,
                  .label = row.label,
                  .menu = "Tools",
                  .shortcuts = shortcuts(row.keys),
                  .help = row.help,
                  .icon = row.icon,
                  .checked = [this, tool = row.tool] { return tools_.tool == tool; },
                  .run = [this, tool = row.tool] { chooseTool(tool); }});
  actions_.add({.id = "tool.through",
                .label = "Select through",
                .menu = "Tools",
                .shortcuts = shortcuts("X"),
                .help = "Also what the surface hides.",
                .separatorBefore = true,
                .checked = [this] { return tools_.through; },
                .run = [this] { tools_.through = !tools_.through; }});
  const auto resize = [this](const char* id, const char* label, const char* keys, float factor) {
    actions_.add({.id = id,
                  .label = label,
                  .menu = "Tools",
                  .shortcuts = shortcuts(keys),
                  .repeats = true,
                  .run = [this, factor] {
                    tools_.brushRadius = std::clamp(factor * tools_.brushRadius, 3.f, 500.f);
                  }});
  };
  resize("brush.smaller", "Smaller brush", "[", 1 / 1.15f);
  resize("brush.larger", "Larger brush", "]", 1.15f);
  actions_.add({.id = "tool.cancel",
                .label = "Cancel",
                .menu = "Tools",
                .shortcuts = shortcuts("Escape"),
                .help = "The gesture that goes on, else the job.",
                .run = [this] { cancel(); }});
  actions_.add({.id = "tool.take-back",
                .label = "Take back the last corner",
                .menu = "Tools",
                .shortcuts = shortcuts("Backspace"),
                .run = [this] { hand_.takeBack(); }});
}

void Editor::addActions() {
  addFileActions();
  addEditActions();
  addRegionActions();
  addSynthesisActions();
  addStrokeActions();
  addViewActions();
  addCameraActions();
  addDisplayActions();
  addToolActions();
  actions_.add({.id = "help.search",
                .label = "Search commands...",
                .menu = "Help",
                .shortcuts = shortcuts("Ctrl+K, F3"),
                .icon = Icon::search,
                .run = [this] { search_.open(); }});
  actions_.add({.id = "help.keys",
                .label = "Keys and mouse...",
                .menu = "Help",
                .shortcuts = shortcuts("F1, ?"),
                .icon = Icon::info,
                .run = [this] { sheet_.open(); }});
  memory_->addHabitActions();
}

}  // namespace dapple
