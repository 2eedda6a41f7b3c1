#include "document/apply.h"

#include <algorithm>
#include <array>

#include "base/errors.h"
#include "document/border_blend.h"
#include "document/edits.h"
#include "document/export.h"
#include "document/project_io.h"
#include "document/region_synthesis.h"

namespace dapple {
namespace {

// Overloads as one visitor.
template <class... F>
struct Visitor : F... {
  using F::operator()...;
};
template <class... F>
Visitor(F...) -> Visitor<F...>;

Change always(Document document) {
  return [document = std::move(document)](const Document&) { return document; };
}

Document withResults(const Document& document, Results results) {
  Document out = document;
  out.results = std::move(results);
  return out;
}

Change nothing() {
  return [](const Document& document) { return document; };
}

void needScan(const Document& document) {
  if (!document.scan) throw InvalidInput("no scan is open; open one first");
}

std::vector<RegionId> regionsOf(const Synthesize& command, const Document& document) {
  if (command.region) return {*command.region};
  std::array<bool, 256> used{};
  if (document.labels)
    for (const RegionId id : *document.labels) used[id] = true;
  std::vector<RegionId> out;
  for (const Region& region : *document.regions)
    if (region.swatch && !region.locked && used[region.id]) out.push_back(region.id);
  return out;
}

Change opened(const OpenScan& command, const CommandContext& context, Monitor& monitor) {
  auto scan = std::make_shared<OpenedScan>(
      openScan(command.path, command.load, command.neighbours, context.loaded, monitor));
  Document document = emptyDocument();
  document.labels =
      std::make_shared<const std::vector<RegionId>>(scan->prepared.scan.points.size(), kUnassigned);
  document.scan = std::move(scan);
  return always(std::move(document));
}

// What borders follow from, besides labels and results.
bool sameBorders(const std::vector<Region>& a, const std::vector<Region>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Region& x, const Region& y) {
    return x.id == y.id && asksForSameBorder(x, y);
  });
}

Results blendedAtOnce(const Document& document) {
  Workers workers(1);
  Monitor monitor(workers);
  return blendBorders(document, monitor);
}

// The results of `made` with their borders, for documents that have come from it meanwhile. A stop
// that keeps what is done does not leave borders as they were.
Change withBlendedBorders(const Document& made, const SynthesisWatch& watch, Monitor& monitor) {
  Results results;
  try {
    results = blendBorders(made, monitor);
  } catch (const Cancelled&) {
    if (!watch.keepsDone || !watch.keepsDone()) throw;
    results = blendedAtOnce(made);
  }
  return [made, results](const Document& now) {
    if (sameBorders(*now.regions, *made.regions)) return withResults(now, results);
    const Document since = withResults(now, made.results);
    return withResults(since, blendedAtOnce(since));
  };
}

Change synthesized(const Document& document, const Synthesize& command,
                   const CommandContext& context, Monitor& monitor) {
  needScan(document);
  if (command.region) regionOf(document, *command.region);
  const std::vector<RegionId> regions = regionsOf(command, document);
  if (regions.empty())
    throw InvalidInput("no region has points, a swatch and is unlocked; choose a swatch first");
  const Document made = withResults(
      document,
      synthesizeRegions(
          document, {regions, command.onlyChanged, command.onlyChanged ? context.field : nullptr},
          context.watch, monitor),
      monitor.workers());
  return withBlendedBorders(made, context.watch, monitor);
}

Change blended(const Document& document, Monitor& monitor) {
  needScan(document);
  return always(withResults(document, blendBorders(document, monitor)));
}

// Parts become regions in the places that are not taken; points of locked regions stay theirs.
Change segmented(const Document& document, const SegmentAutomatically& command, Monitor& monitor) {
  needScan(document);
  const std::vector<std::uint8_t> parts =
      segment({document.points(), document.scan->prepared.neighborhoods}, document.points().colours,
              {.parts = command.parts}, monitor);
  std::array<bool, 256> locked{};
  Document next = document;
  std::vector<Region> regions;
  for (const Region& region : *document.regions) {
    locked[region.id] = region.locked;
    if (region.locked || region.id == kUnassigned) regions.push_back(region);
  }
  next.regions = std::make_shared<const std::vector<Region>>(regions);
  std::array<RegionId, 256> idOf{};
  for (int part = 0; part < command.parts; ++part) {
    next =
        edited(next, AddRegion{.name = fmt::format("Part {}", part + 1), .fromSelection = false});
    std::vector<Region> list = *next.regions;
    Region& added = list.back();
    idOf[static_cast<std::size_t>(part)] = added.id;
    Region settings = *findRegion(document, kUnassigned);
    settings.id = added.id, settings.name = added.name, settings.colour = added.colour;
    settings.locked = false, settings.visible = true, settings.strokes = nullptr;
    added = std::move(settings);
    next.regions = std::make_shared<const std::vector<Region>>(std::move(list));
  }
  std::vector<RegionId> labels = *document.labels;
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (!locked[labels[i]]) labels[i] = idOf[parts[i]];
  next.labels = std::make_shared<const std::vector<RegionId>>(std::move(labels));
  return [next](const Document& now) {
    Document out = now;
    out.regions = next.regions;
    out.labels = next.labels;
    return out;
  };
}

std::string nameOf(const Document& document, RegionId id) {
  const Region* region = findRegion(document, id);
  return region ? region->name : fmt::format("region {}", id);
}

std::string fileName(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::string setLabel(const SetRegion& c, const Document& d) {
  if (c.name) return fmt::format("Rename {} to {}", nameOf(d, c.region), *c.name);
  if (c.visible) return (*c.visible ? "Show " : "Hide ") + nameOf(d, c.region);
  if (c.locked) return (*c.locked ? "Lock " : "Unlock ") + nameOf(d, c.region);
  if (c.colour) return "Colour of " + nameOf(d, c.region);
  if (c.rotation) return "Rotate swatch of " + nameOf(d, c.region);
  if (c.borderKind || c.borderWidth) return "Border of " + nameOf(d, c.region);
  return "Options of " + nameOf(d, c.region);
}

std::string selectLabel(const Select& c) {
  if (c.mode == SelectMode::Replace && c.points.empty()) return "Select none";
  static constexpr std::array kVerbs{
      "Select", "Add to selection:", "Take from selection:", "Intersect selection with"};
  return fmt::format("{} {} points", kVerbs[static_cast<std::size_t>(c.mode)], c.points.size());
}

bool inJob(const std::vector<RegionId>& regions, RegionId id) {
  return std::find(regions.begin(), regions.end(), id) != regions.end();
}

bool selectionTouches(const Document& document, const std::vector<RegionId>& regions) {
  if (!document.selection) return false;
  std::array<bool, 256> of{};
  for (const RegionId id : regions) of[id] = true;
  for (std::size_t i = 0; i < document.size(); ++i)
    if (of[(*document.labels)[i]] && document.selection->has(i)) return true;
  return false;
}

bool onlySelects(const Command& command) {
  return std::holds_alternative<Select>(command) || std::holds_alternative<SelectAll>(command) ||
         std::holds_alternative<SelectRegion>(command) ||
         std::holds_alternative<SelectConnected>(command) ||
         std::holds_alternative<SelectWand>(command) ||
         std::holds_alternative<GrowSelection>(command) ||
         std::holds_alternative<ShrinkSelection>(command) ||
         std::holds_alternative<InvertSelection>(command);
}

bool opensAnother(const Command& command) {
  return std::holds_alternative<OpenScan>(command) || std::holds_alternative<OpenProject>(command);
}

bool makesResults(const Command& command) {
  return std::holds_alternative<Synthesize>(command) ||
         std::holds_alternative<BlendBorders>(command);
}

Meeting meetsSynthesis(const Command& command, const Synthesize& job, const Document& document) {
  const std::vector<RegionId> regions = regionsOf(job, document);
  const auto stopsIf = [](bool stops) { return stops ? Meeting::Stops : Meeting::Beside; };
  const auto ofRegion = [&](const auto& c) { return stopsIf(inJob(regions, c.region)); };
  return std::visit(
      Visitor{[&](const AddRegion& c) {
                return stopsIf(c.fromSelection && selectionTouches(document, regions));
              },
              [&](const AssignSelection& c) {
                return stopsIf(inJob(regions, c.region) || selectionTouches(document, regions));
              },
              [&](const RemoveRegion& c) {
                return stopsIf(inJob(regions, c.region) || inJob(regions, kUnassigned));
              },
              [&](const SetRegion& c) {
                const bool input =
                    c.options || c.rotation || c.borderKind || c.borderWidth || c.locked;
                return stopsIf(input && inJob(regions, c.region));
              },
              [](const ShowOnly&) { return Meeting::Beside; },
              [](const MoveRegion&) { return Meeting::Beside; },
              [&](const SetSwatch& c) { return ofRegion(c); },
              [&](const AddStroke& c) { return ofRegion(c); },
              [&](const SetStroke& c) { return ofRegion(c); },
              [&](const RemoveStroke& c) { return ofRegion(c); },
              [](const Synthesize&) { return Meeting::Waits; },
              [](const BlendBorders&) { return Meeting::Waits; },
              [](const auto&) { return Meeting::Stops; }},
      command);
}

}  // namespace

// long: one line a command
std::string label(const Command& command, const Document& d) {
  return std::visit(
      Visitor{[](const OpenScan& c) { return "Open " + fileName(c.path); },
              [](const AddRegion& c) {
                return c.name.empty() ? std::string("Add region") : "Add region " + c.name;
              },
              [&](const RemoveRegion& c) { return "Remove " + nameOf(d, c.region); },
              [&](const SetRegion& c) { return setLabel(c, d); },
              [&](const ShowOnly& c) {
                return c.region ? "Show only " + nameOf(d, *c.region) : "Show all regions";
              },
              [&](const MoveRegion& c) { return "Move " + nameOf(d, c.region); },
              [](const Select& c) { return selectLabel(c); },
              [](const SelectAll&) { return std::string("Select all"); },
              [&](const SelectRegion& c) { return "Select " + nameOf(d, c.region); },
              [](const SelectConnected&) { return std::string("Select connected"); },
              [](const SelectWand&) { return std::string("Wand"); },
              [](const GrowSelection&) { return std::string("Grow selection"); },
              [](const ShrinkSelection&) { return std::string("Shrink selection"); },
              [](const InvertSelection&) { return std::string("Invert selection"); },
              [&](const AssignSelection& c) { return "Assign to " + nameOf(d, c.region); },
              [&](const SetSwatch& c) {
                return c.reference.path.empty()
                           ? "Remove swatch of " + nameOf(d, c.region)
                           : fmt::format("Swatch {} for {}", fileName(c.reference.path),
                                         nameOf(d, c.region));
              },
              [&](const AddStroke& c) { return "Stroke on " + nameOf(d, c.region); },
              [&](const SetStroke& c) { return "Change stroke on " + nameOf(d, c.region); },
              [&](const RemoveStroke& c) { return "Remove stroke from " + nameOf(d, c.region); },
              [](const SegmentAutomatically& c) {
                return fmt::format("Segment into {} parts", c.parts);
              },
              [&](const Synthesize& c) {
                return c.region ? "Synthesize " + nameOf(d, *c.region) : "Synthesize all";
              },
              [](const BlendBorders&) { return std::string("Make borders"); },
              [&](const ClearResult& c) {
                return c.region ? "Clear result of " + nameOf(d, *c.region) : "Clear results";
              },
              [](const OpenProject& c) { return "Open " + fileName(c.path); },
              [](const SaveProject& c) { return "Save " + fileName(c.path); },
              [](const ExportScan& c) { return "Export " + fileName(c.path); },
              [](const Undo&) { return std::string("Undo"); },
              [](const Redo&) { return std::string("Redo"); },
              [](const GoTo&) { return std::string("Go to step"); }},
      command);
}

bool isJob(const Command& command) {
  return opensAnother(command) || onlyReads(command) ||
         std::holds_alternative<SegmentAutomatically>(command) || makesResults(command);
}

bool onlyReads(const Command& command) {
  return std::holds_alternative<SaveProject>(command) ||
         std::holds_alternative<ExportScan>(command);
}

Meeting meeting(const Command& command, const Command& job, const Document& document) {
  if (onlyReads(job)) return onlyReads(command) ? Meeting::Waits : Meeting::Beside;
  if (opensAnother(job)) return opensAnother(command) ? Meeting::Stops : Meeting::Waits;
  if (onlySelects(command) || onlyReads(command)) return Meeting::Beside;
  if (const auto* synthesis = std::get_if<Synthesize>(&job))
    return meetsSynthesis(command, *synthesis, document);
  return makesResults(command) ? Meeting::Waits : Meeting::Stops;
}

Change compute(const Document& document, const Command& command, const CommandContext& context,
               Monitor& monitor) {
  return std::visit(
      Visitor{[&](const OpenScan& c) { return opened(c, context, monitor); },
              [&](const Synthesize& c) { return synthesized(document, c, context, monitor); },
              [&](const BlendBorders&) { return blended(document, monitor); },
              [&](const SegmentAutomatically& c) { return segmented(document, c, monitor); },
              [&](const OpenProject& c) { return always(loadProject(c, context, monitor)); },
              [&](const SaveProject& c) {
                saveProject(document, c.path, monitor);
                return nothing();
              },
              [&](const ExportScan& c) {
                needScan(document);
                exportScan(document, c, monitor);
                return nothing();
              },
              [&](const ClearResult& c) {
                return always(withoutResults(document, c.region, monitor.workers()));
              },
              [&](const SetSwatch& c) { return always(edited(document, c, context)); },
              [&](const auto& c) -> Change {
                using C = std::remove_cvref_t<decltype(c)>;
                if constexpr (std::is_same_v<C, Undo> || std::is_same_v<C, Redo> ||
                              std::is_same_v<C, GoTo>)
                  throw Bug("a history, not apply(), carries out Undo, Redo and GoTo");
                else if constexpr (requires { edited(document, c, monitor); })
                  return always(edited(document, c, monitor));
                else
                  return always(edited(document, c));
              }},
      command);
}

Document apply(const Document& document, const Command& command, const CommandContext& context,
               Monitor& monitor) {
  return compute(document, command, context, monitor)(document);
}

}  // namespace dapple
