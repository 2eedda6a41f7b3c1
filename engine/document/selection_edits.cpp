#include "base/errors.h"
#include "document/edits.h"

namespace dapple {
namespace {

constexpr int kMostSteps = 1000;

void needScan(const Document& document) {
  if (!document.scan) throw InvalidInput("there is no scan to select from; open one first");
}

PointMask selected(const Document& document) {
  return document.selection ? *document.selection : PointMask(document.size());
}

Document withSelection(const Document& document, PointMask mask) {
  Document out = document;
  out.selection = mask.count() == 0 ? nullptr : std::make_shared<const PointMask>(std::move(mask));
  return out;
}

Document combined(const Document& document, PointMask mask, SelectMode mode) {
  PointMask before = selected(document);
  switch (mode) {
    case SelectMode::Replace:
      break;
    case SelectMode::Add:
      mask |= before;
      break;
    case SelectMode::Subtract:
      before -= mask;
      mask = std::move(before);
      break;
    case SelectMode::Intersect:
      mask &= before;
      break;
  }
  return withSelection(document, std::move(mask));
}

LinkedPoints graphOf(const Document& document) {
  needScan(document);
  return {document.points(), document.scan->prepared.neighborhoods};
}

void checkSteps(int steps) {
  if (steps < 1 || steps > kMostSteps)
    throw InvalidInput(fmt::format("steps: {} is outside 1 to {}", steps, kMostSteps));
}

}  // namespace

Document edited(const Document& document, const Select& command) {
  needScan(document);
  return combined(document, maskOf(command.points, document.size()), command.mode);
}

Document edited(const Document& document, const SelectAll&) {
  needScan(document);
  return withSelection(document, PointMask(document.size(), true));
}

Document edited(const Document& document, const SelectRegion& command) {
  needScan(document);
  regionOf(document, command.region);
  return combined(document, maskOf(pointsOf(document, command.region), document.size()),
                  command.mode);
}

Document edited(const Document& document, const SelectConnected& command, Monitor& monitor) {
  return combined(document, connectedTo(graphOf(document), command.seed, monitor), command.mode);
}

Document edited(const Document& document, const SelectWand& command, Monitor& monitor) {
  const LinkedPoints graph = graphOf(document);
  WandOptions options = command.wand;
  if (options.by == WandBy::Distance) options.threshold *= document.scan->prepared.spacing;
  const std::vector<vec3>& own = document.points().colours;
  const std::vector<vec3>& colours =
      own.empty() && document.results.colour ? *document.results.colour : own;
  return combined(document, wand(graph, colours, command.seed, options, monitor), command.mode);
}

Document edited(const Document& document, const GrowSelection& command, Monitor& monitor) {
  const LinkedPoints graph = graphOf(document);
  checkSteps(command.steps);
  PointMask mask = selected(document);
  for (int step = 0; step < command.steps; ++step) mask = grown(graph, mask, monitor);
  return withSelection(document, std::move(mask));
}

Document edited(const Document& document, const ShrinkSelection& command, Monitor& monitor) {
  const LinkedPoints graph = graphOf(document);
  checkSteps(command.steps);
  PointMask mask = selected(document);
  for (int step = 0; step < command.steps; ++step) mask = shrunk(graph, mask, monitor);
  return withSelection(document, std::move(mask));
}

Document edited(const Document& document, const InvertSelection&) {
  needScan(document);
  PointMask mask = selected(document);
  mask.invert();
  return withSelection(document, std::move(mask));
}

}  // namespace dapple
