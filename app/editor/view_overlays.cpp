#include "app/editor/view_overlays.h"

#include <fmt/format.h>

#include "app/gui/gui_context.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"

namespace dapple {
namespace {

constexpr float kCell = 14;  // of directions, logical pixels
// While strokes are drawn the texture is to be seen, too: fewer and fainter.
constexpr float kWideCell = 28, kFaint = 0.7f;
constexpr float kStale = 0.35f;  // opacity, while others are being found

void add(OverlayLines& lines, const OverlayLines& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

void addFaded(OverlayLines& lines, OverlayLines more, float opacity) {
  for (OverlayLine& line : more) line.colour.a *= opacity;
  add(lines, more);
}

// Those of regions that are shown.
std::vector<FieldSingularity> shownOf(const ShownField& field, const Document& document) {
  std::vector<FieldSingularity> shown;
  for (const FieldSingularity& s : field.singularities)
    if (const Region* region = findRegion(document, s.region); region && region->visible)
      shown.push_back(s);
  return shown;
}

double turnsOf(const FieldSingularity& s) {
  return static_cast<double>(s.index) / s.folds;
}

std::string noteOf(const std::vector<FieldSingularity>& shown) {
  double sum = 0;
  for (const FieldSingularity& s : shown) sum += turnsOf(s);
  if (shown.empty()) return "No singularities";
  if (shown.size() == 1) return fmt::format("1 singularity, its index is {:g}", sum);
  return fmt::format("{} singularities, their indices sum to {:g}", shown.size(), sum);
}

void drawLine(const OverlayLine& line, ImVec2 min, std::vector<ImVec2>& points) {
  points.clear();
  for (const vec2& p : line.points) points.push_back({min.x + p.x, min.y + p.y});
  const glm::vec4& c = line.colour;
  ImGui::GetWindowDrawList()->AddPolyline(points.data(), static_cast<int>(points.size()),
                                          ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, c.a}),
                                          line.closed ? ImDrawFlags_Closed : ImDrawFlags_None,
                                          line.width);
}

// A dark card beside its place, to be read on anything.
void drawLabel(const OverlayLabel& label, ImVec2 min, const std::string& mark) {
  const float pad = theme::px(3);
  const ImVec2 at(min.x + label.place.x + theme::px(12), min.y + label.place.y + theme::px(10));
  const ImVec2 size = ImGui::CalcTextSize(label.text.c_str());
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 low(at.x - pad, at.y), high(at.x + size.x + pad, at.y + size.y);
  list.AddRectFilled(low, high, theme::packed(theme::withAlpha(theme::kPanel, 0.85f)), pad);
  list.AddText(at, theme::packed(theme::kText), label.text.c_str());
  markRectangle(mark, low, high);
}

}  // namespace

void ViewOverlays::followField(const Document& document, const ViewSettings& settings,
                               const Extra& extra) {
  wanted_ = settings.directions || settings.singularities || extra.field;
  if (wanted_)
    finder_.follow(document);
  else
    finder_.rest(document);
  const auto& found = finder_.field();
  shown_ = wanted_ && found && found->scan == document.scan ? found : nullptr;
  note_.clear();
  if (!settings.singularities && !extra.field) return;
  if (finding())
    note_ = "Finding the directions...";
  else if (shown_)
    note_ = noteOf(shownOf(*shown_, document));
}

void ViewOverlays::makeResting(const SceneView& view, const ViewSettings& settings,
                               const Extra& extra, const OverlayView& over) {
  const Document& document = view.snapshot().document;
  const bool directions = shown_ && !shown_->up.empty();
  const Of wanted{.camera = view.pictureCamera(),
                  .width = view.picture().width,
                  .height = view.picture().height,
                  .cell = !directions           ? 0
                          : settings.directions ? kCell
                          : extra.field         ? kWideCell
                                                : 0,
                  .outlines = settings.outlines && view.regions(),
                  .labels = view.regions(),
                  .regions = document.regions,
                  .field = shown_};
  if (wanted == of_) return;
  of_ = wanted;
  outlines_.clear(), directions_.clear();
  if (wanted.outlines) outlines_ = outlineLines(over, *view.regions());
  if (wanted.cell > 0)
    directions_ = directionLines(over, document.points().positions, shown_->up, wanted.cell);
}

void ViewOverlays::drawSingularities(const Document& document, const OverlayView& over,
                                     const Extra& extra, ImVec2 min) {
  const std::vector<FieldSingularity> shown = shownOf(*shown_, document);
  std::vector<SingularMark> marks;
  for (const FieldSingularity& s : shown) marks.push_back({s.position, s.index});
  OverlayLines lines;
  addFaded(lines, singularityLines(over, marks), finding() ? kStale : 1);
  std::vector<ImVec2> points;
  for (const OverlayLine& line : lines) drawLine(line, min, points);
  if (!extra.cursor) return;
  for (const FieldSingularity& s : shown)
    if (const auto at = placeOf(over, s.position);
        at && glm::distance(*at, *extra.cursor) < kMarkRadius * over.scale)
      return drawLabel({*at, fmt::format("index {:+g}", turnsOf(s))}, min, "singularity.label");
}

void ViewOverlays::draw(const SceneView& view, const ViewSettings& settings, const Extra& extra,
                        ImVec2 min) {
  if (view.empty() || view.opening()) return followField({}, {}, {});
  const Document& document = view.snapshot().document;
  followField(document, settings, extra);
  if (view.picture().width == 0) return;
  const Camera camera = view.pictureCamera();
  const OverlayView over(camera, view.picture(), view.splatRadius(),
                         GuiContext::current().uiScale());
  OverlayLines lines, hand;
  if (view.complete() || camera == of_.camera) {
    makeResting(view, settings, extra, over);
    add(lines, outlines_);
    addFaded(lines, directions_, (finding() ? kStale : 1) * (settings.directions ? 1 : kFaint));
  }
  std::vector<ImVec2> points;
  for (const OverlayLine& line : lines) drawLine(line, min, points);
  if (shown_ && (settings.singularities || extra.field))
    drawSingularities(document, over, extra, min);
  if (settings.strokes) hand = strokesOverlay(over, document, extra.stroke);
  add(hand, extra.hand);
  for (const OverlayLine& line : hand) drawLine(line, min, points);
  if (!settings.strokes) return;
  const scope::Font font(GuiContext::current().fonts().small);
  const std::vector<OverlayLabel> labels = strokeLabels(over, document);
  for (std::size_t k = 0; k < labels.size(); ++k)
    drawLabel(labels[k], min, fmt::format("stroke.label.{}", k));
}

}  // namespace dapple
