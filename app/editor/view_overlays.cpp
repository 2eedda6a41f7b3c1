#include "app/editor/view_overlays.h"

#include <fmt/format.h>

#include "app/gui/gui_context.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"

namespace dapple {
namespace {

// The swatch's up on the surface, none where nothing was synthesized.
std::vector<vec3> upOf(const Document& document) {
  const Results& results = document.results;
  std::vector<vec3> up(document.size(), vec3(0));
  for (std::size_t i = 0; i < up.size(); ++i)
    if ((*results.source)[i] != kNoSource) up[i] = (*results.frame)[i].t;
  return up;
}

void add(OverlayLines& lines, const OverlayLines& more) {
  lines.insert(lines.end(), more.begin(), more.end());
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
  const ImVec2 at(min.x + label.place.x + theme::px(10), min.y + label.place.y + theme::px(6));
  const ImVec2 size = ImGui::CalcTextSize(label.text.c_str());
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 low(at.x - pad, at.y), high(at.x + size.x + pad, at.y + size.y);
  list.AddRectFilled(low, high, theme::packed(theme::withAlpha(theme::kPanel, 0.85f)), pad);
  list.AddText(at, theme::packed(theme::kText), label.text.c_str());
  markRectangle(mark, low, high);
}

}  // namespace

const OverlayLines& ViewOverlays::resting(const SceneView& view, const ViewSettings& settings,
                                          const OverlayView& over) {
  const Document& document = view.snapshot().document;
  const Of wanted{.camera = view.pictureCamera(),
                  .width = view.picture().width,
                  .height = view.picture().height,
                  .outlines = settings.outlines && view.regions(),
                  .directions = settings.directions && document.results.frame,
                  .labels = view.regions(),
                  .regions = document.regions,
                  .frames = document.results.frame};
  if (wanted == of_) return lines_;
  of_ = wanted;
  lines_.clear();
  if (wanted.outlines) lines_ = outlineLines(over, *view.regions());
  if (wanted.directions)
    add(lines_, directionLines(over, document.points().positions, upOf(document)));
  return lines_;
}

void ViewOverlays::draw(const SceneView& view, const ViewSettings& settings, const Extra& extra,
                        ImVec2 min) {
  if (view.empty() || view.opening() || view.picture().width == 0) return;
  const Camera camera = view.pictureCamera();
  const OverlayView over(camera, view.picture(), view.splatRadius(),
                         GuiContext::current().uiScale());
  OverlayLines lines;
  if (view.complete() || camera == of_.camera) add(lines, resting(view, settings, over));
  if (settings.strokes) add(lines, strokesOverlay(over, view.snapshot().document, extra.stroke));
  add(lines, extra.hand);
  std::vector<ImVec2> points;
  for (const OverlayLine& line : lines) drawLine(line, min, points);
  if (!settings.strokes) return;
  const scope::Font font(GuiContext::current().fonts().small);
  const std::vector<OverlayLabel> labels = strokeLabels(over, view.snapshot().document);
  for (std::size_t k = 0; k < labels.size(); ++k)
    drawLabel(labels[k], min, fmt::format("stroke.label.{}", k));
}

}  // namespace dapple
