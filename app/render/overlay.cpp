#include "app/render/overlay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kDeeper = 1.5f;  // radii below the traced surface that still count as on it
// Of a brush's radius: its circle dips into every hollow, and is not hidden by that.
constexpr float kBrushDeeper = 0.3f;
// Pixels unless said otherwise, at scale 1.
constexpr float kStep = 2;        // between the places where a line is looked up in the trace
constexpr int kMostSteps = 4000;  // along one segment
constexpr float kStrokeWidth = 2.4f, kArrowWidth = 1.2f, kBrushWidth = 1.6f;
constexpr float kCasing = 0.9f;  // that the casing is wider, at each side
const glm::vec4 kCasingColour{0.04f, 0.05f, 0.08f, 0.58f};
constexpr float kHead = 9, kHeadEvery = 110;  // an arrow head's length and distance along a stroke
constexpr float kArrowLength = 0.78f;         // of a direction's cell
constexpr float kArrowHead = 0.27f;           // of its length on the picture
constexpr float kShortestArrow = 4.5f;        // a more foreshortened one is a blot
constexpr int kLookups = 7;                   // a side of a direction's cell
constexpr float kDash = 5, kGap = 4;
constexpr float kFaint = 0.45f;  // opacity of what is hidden
const vec3 kArrowColour{0.98f, 0.98f, 0.96f};
constexpr float kMarkWidth = 2, kMarkStep = 3.5f;  // of a mark's outlines, from one to the next
constexpr float kSign = 0.48f;                     // half its length, of the mark's radius
constexpr float kDiamond = 1.2f;  // half its diagonal: it looks as large as the ring
constexpr int kMostOutlines = 3, kRingSides = 24;
// Apart for the colour-blind, too, and on light and dark.
const vec3 kPositive{1.0f, 0.47f, 0.66f}, kNegative{0.40f, 0.80f, 1.0f};
const glm::vec4 kMarkGround{0.04f, 0.05f, 0.08f, 0.62f};

// Not deeper by more than `deeper` than the surface that is seen there. Where that is steep, its
// depth in the pixels around counts, too.
bool seen(const OverlayView& view, const vec3& at, float deeper) {
  const Raster& traced = view.traced;
  if (!(at.z > view.pixels.nearest && at.x >= 0 && at.y >= 0 &&
        at.x < static_cast<float>(traced.width) && at.y < static_cast<float>(traced.height)))
    return false;
  const int column = static_cast<int>(at.x), row = static_cast<int>(at.y);
  float deepest = -1;
  for (int y = std::max(0, row - 1); y <= std::min(traced.height - 1, row + 1); ++y)
    for (int x = std::max(0, column - 1); x <= std::min(traced.width - 1, column + 1); ++x)
      deepest = std::max(
          deepest,
          traced.depths[static_cast<std::size_t>(y) * static_cast<std::size_t>(traced.width) +
                        static_cast<std::size_t>(x)]);
  return at.z <= deepest + deeper;
}

// A line on the surface as runs of pixels that are all seen or all hidden.
struct Run {
  std::vector<vec2> points;
  bool isSeen = false;
  bool toEnd = false;  // of the whole line
};

std::vector<Run> runsOf(const OverlayView& view, std::span<const vec3> line, float deeper) {
  std::vector<Run> runs;
  const auto visit = [&](const vec3& at) {
    if (at.z <= view.pixels.nearest) return;  // beside or behind the eye: it has no pixel
    const bool isSeen = seen(view, at, deeper);
    if (runs.empty() || runs.back().isSeen != isSeen) {
      std::vector<vec2> first;
      if (!runs.empty()) first.push_back(runs.back().points.back());
      runs.push_back({std::move(first), isSeen});
    }
    runs.back().points.emplace_back(at);
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const vec3 to = view.pixels.project(line[i]);
    if (i > 0) {
      const vec3 from = view.pixels.project(line[i - 1]);
      const float length = from.z > 0 && to.z > 0 ? glm::distance(vec2(from), vec2(to)) : 0;
      const int steps =
          static_cast<int>(std::clamp(length / kStep, 1.f, static_cast<float>(kMostSteps)));
      for (int s = 1; s < steps; ++s)
        visit(view.pixels.project(
            glm::mix(line[i - 1], line[i], static_cast<float>(s) / static_cast<float>(steps))));
    }
    visit(to);
  }
  if (!runs.empty()) runs.back().toEnd = true;
  return runs;
}

OverlayLine headAt(vec2 tip, vec2 along, float length, const OverlayLine& style) {
  const vec2 back = -along * length, side = 0.55f * vec2(-back.y, back.x);
  return {{tip + back + side, tip, tip + back - side}, style.colour, style.width};
}

// Where a polyline passes the given length, and its direction over the last `smooth` pixels.
struct Passage {
  vec2 at, along;
};
std::optional<Passage> passage(const std::vector<vec2>& line, float length, float smooth) {
  float so = 0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const float step = glm::distance(line[i - 1], line[i]);
    if (so + step < length || step == 0) {
      so += step;
      continue;
    }
    const vec2 at = glm::mix(line[i - 1], line[i], (length - so) / step);
    std::size_t from = i - 1;
    while (from > 0 && glm::distance(line[from], at) < smooth) --from;
    const vec2 along = at - line[from];
    if (glm::length(along) < 1e-3f) return std::nullopt;
    return Passage{at, glm::normalize(along)};
  }
  return std::nullopt;
}

float lengthOf(const std::vector<vec2>& line) {
  float length = 0;
  for (std::size_t i = 1; i < line.size(); ++i) length += glm::distance(line[i - 1], line[i]);
  return length;
}

// The visible point nearest to the middle of the cell at `low`, that lies in it.
Index pointOfCell(const OverlayView& view, std::span<const vec3> positions, vec2 low, float cell) {
  const vec2 middle = low + 0.5f * cell;
  Index best = kNone;
  float nearest = std::numeric_limits<float>::infinity();
  for (int k = 0; k < kLookups * kLookups; ++k) {
    const vec2 step((static_cast<float>(k % kLookups) + 0.5f) / kLookups,
                    (static_cast<float>(k / kLookups) + 0.5f) / kLookups);
    const ivec2 at(low + cell * step);
    if (at.x >= view.traced.width || at.y >= view.traced.height) continue;
    const Index i =
        view.traced
            .points[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(view.traced.width) +
                    static_cast<std::size_t>(at.x)];
    if (i == kNone || i == best) continue;
    const vec2 away = glm::abs(vec2(view.pixels.project(positions[i])) - middle);
    if (std::max(away.x, away.y) > 0.5f * cell) continue;
    const float distance = glm::length(away);
    if (distance < nearest || (distance == nearest && i < best)) nearest = distance, best = i;
  }
  return best;
}

// The pieces of a line that dashes leave.
void addDashed(const std::vector<vec2>& line, const OverlayLine& style, float scale,
               OverlayLines& out) {
  float so = 0;
  OverlayLine dash = style;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (i > 0) so += glm::distance(line[i - 1], line[i]);
    const bool on = std::fmod(so, (kDash + kGap) * scale) < kDash * scale;
    if (on) dash.points.push_back(line[i]);
    if ((!on || i + 1 == line.size()) && !dash.points.empty()) {
      if (dash.points.size() > 1) out.push_back(dash);
      dash.points.clear();
    }
  }
}

// Two directions across the normal.
std::pair<vec3, vec3> tangentsOf(const vec3& normal) {
  const vec3 n = glm::normalize(normal);
  const vec3 other = std::abs(n.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
  const vec3 s = glm::normalize(glm::cross(other, n));
  return {s, glm::cross(n, s)};
}

void addCircle(const OverlayView& view, const BrushCursor& brush, float radius, float opacity,
               OverlayLines& out) {
  const auto [s, t] = tangentsOf(brush.normal);
  const float around =
      2 * kPi * radius * view.pixels.pixelsPerUnit(view.pixels.project(brush.centre).z);
  const int sides = static_cast<int>(std::clamp(around / 2, 48.f, 720.f));
  std::vector<vec3> circle;
  for (int k = 0; k <= sides; ++k) {
    const float angle = 2 * kPi * static_cast<float>(k) / static_cast<float>(sides);
    circle.push_back(brush.centre + radius * (std::cos(angle) * s + std::sin(angle) * t));
  }
  const OverlayLine style{{}, glm::vec4(brush.colour, opacity), kBrushWidth * view.scale};
  if (brush.through) {
    OverlayLine whole = style;
    whole.closed = true;
    for (const vec3& p : circle)
      if (const vec3 at = view.pixels.project(p); at.z > view.pixels.nearest)
        whole.points.emplace_back(at);
    out.push_back(whole);
    return;
  }
  const float deeper = std::max(kDeeper * view.radius, kBrushDeeper * brush.radius);
  for (Run& run : runsOf(view, circle, deeper)) {
    OverlayLine line = style;
    if (run.isSeen) {
      line.points = std::move(run.points);
      out.push_back(line);
    } else {
      line.colour.a *= kFaint;
      addDashed(run.points, line, view.scale, out);
    }
  }
}

OverlayLine polygonAround(vec2 centre, float radius, int sides, const OverlayLine& style) {
  OverlayLine line{{}, style.colour, style.width, true};
  for (int k = 0; k < sides; ++k) {
    const float angle = 2 * kPi * static_cast<float>(k) / static_cast<float>(sides);
    line.points.push_back(centre + radius * vec2(std::cos(angle), std::sin(angle)));
  }
  return line;
}

void addMark(vec2 at, int index, float scale, OverlayLines& grounds, OverlayLines& out) {
  const bool positive = index > 0;
  const int sides = positive ? kRingSides : 4, outlines = std::min(std::abs(index), kMostOutlines);
  const OverlayLine style{{}, glm::vec4(positive ? kPositive : kNegative, 1), kMarkWidth * scale};
  const float radius = (positive ? 1 : kDiamond) * kMarkRadius * scale;
  // As wide as it is far from the centre: that fills it.
  grounds.push_back(polygonAround(at, 0.5f * radius, sides, {{}, kMarkGround, radius}));
  for (int k = 0; k < outlines; ++k)
    out.push_back(
        polygonAround(at, radius + static_cast<float>(k) * kMarkStep * scale, sides, style));
  const vec2 right(kSign * radius, 0), down(0, kSign * radius);
  out.push_back({{at - right, at + right}, style.colour, style.width});
  if (positive) out.push_back({{at - down, at + down}, style.colour, style.width});
}

}  // namespace

std::optional<vec2> placeOf(const OverlayView& view, const vec3& at) {
  const vec3 pixel = view.pixels.project(at);
  if (!seen(view, pixel, kDeeper * view.radius)) return std::nullopt;
  return vec2(pixel);
}

OverlayLines withCasing(const OverlayLines& lines, float scale) {
  OverlayLines all = lines;
  for (OverlayLine& line : all) {
    line.width += 2 * kCasing * scale;
    const float opacity = kCasingColour.a * line.colour.a;
    line.colour = kCasingColour;
    line.colour.a = opacity;
  }
  all.insert(all.end(), lines.begin(), lines.end());
  return all;
}

OverlayLines strokeLines(const OverlayView& view, std::span<const SurfaceStroke> strokes) {
  OverlayLines lines;
  for (const SurfaceStroke& stroke : strokes)
    for (Run& run : runsOf(view, stroke.points, kDeeper * view.radius)) {
      if (!run.isSeen || run.points.size() < 2) continue;
      OverlayLine line{std::move(run.points), glm::vec4(stroke.colour, 1),
                       kStrokeWidth * view.scale};
      const float length = lengthOf(line.points), every = kHeadEvery * view.scale,
                  head = kHead * view.scale;
      OverlayLines heads;
      const auto addHead = [&](float at) {
        if (const auto p = passage(line.points, at, head))
          heads.push_back(headAt(p->at, p->along, head, line));
      };
      if (run.toEnd) addHead(length * 0.9999f);
      for (float at = every; at < length - 0.6f * every; at += every) addHead(at);
      lines.push_back(std::move(line));
      lines.insert(lines.end(), heads.begin(), heads.end());
    }
  return withCasing(lines, view.scale);
}

OverlayLines directionLines(const OverlayView& view, std::span<const vec3> positions,
                            std::span<const vec3> directions, float cell) {
  DAPPLE_CHECK(directions.size(), ==, positions.size());
  const float side = cell * view.scale;
  OverlayLines lines;
  for (float y = 0; y < static_cast<float>(view.traced.height); y += side)
    for (float x = 0; x < static_cast<float>(view.traced.width); x += side) {
      const Index i = pointOfCell(view, positions, {x, y}, side);
      if (i == kNone) continue;
      const float length = glm::length(directions[i]);
      if (!(length > 0) || !std::isfinite(length)) continue;
      const float depth = view.pixels.project(positions[i]).z;
      const vec3 half =
          directions[i] * (0.5f * kArrowLength * side * view.pixels.unitsPerPixel(depth) / length);
      const vec2 from = view.pixels.project(positions[i] - half),
                 to = view.pixels.project(positions[i] + half);
      const float drawn = glm::distance(from, to);
      if (!(drawn > kShortestArrow * view.scale)) continue;  // towards the eye or away from it
      const OverlayLine shaft{{from, to}, glm::vec4(kArrowColour, 1), kArrowWidth * view.scale};
      lines.push_back(shaft);
      lines.push_back(headAt(to, (to - from) / drawn, kArrowHead * drawn, shaft));
    }
  return withCasing(lines, view.scale);
}

OverlayLines singularityLines(const OverlayView& view, std::span<const SingularMark> marks) {
  OverlayLines lines, marksLines;
  for (const SingularMark& mark : marks)
    if (const auto at = placeOf(view, mark.at))
      addMark(*at, mark.index, view.scale, lines, marksLines);
  const OverlayLines cased = withCasing(marksLines, view.scale);
  lines.insert(lines.end(), cased.begin(), cased.end());
  return lines;
}

OverlayLines brushLines(const OverlayView& view, const BrushCursor& brush) {
  OverlayLines lines;
  if (!(brush.radius > 0) || view.pixels.project(brush.centre).z <= view.pixels.nearest)
    return lines;
  addCircle(view, brush, brush.radius, 1, lines);
  if (brush.core > 0 && brush.core < 1)
    addCircle(view, brush, brush.core * brush.radius, 0.6f, lines);
  return withCasing(lines, view.scale);
}

}  // namespace dapple
