#include "app/gui/icons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "app/gui/theme.h"

namespace dapple {
namespace {

constexpr float kUnits = 24;  // of the square in which the icons are drawn
constexpr float kStroke = 2;  // units
constexpr float kTurn = 2 * std::numbers::pi_v<float>;

// Pen over the square of 24 x 24 units, y down. Lines have round ends.
class Pen {
 public:
  Pen(ImDrawList& list, ImVec2 min, float size, ImU32 colour)
      : list_(list), min_(min), unit_(size / kUnits), colour_(colour) {
    width_ = std::max(1.25f, kStroke * unit_);
  }

  void line(std::initializer_list<ImVec2> points, bool closed = false) {
    for (const ImVec2& p : points) list_.PathLineTo(at(p));
    stroke(closed);
    if (closed) return;
    dot(*points.begin(), width_ / (2 * unit_));
    dot(*(points.end() - 1), width_ / (2 * unit_));
  }
  void curve(ImVec2 a, ImVec2 b, ImVec2 c, ImVec2 d) {
    list_.PathLineTo(at(a));
    list_.PathBezierCubicCurveTo(at(b), at(c), at(d));
    stroke(false);
  }
  // Angles in turns, clockwise from the right.
  void arc(ImVec2 centre, float radius, float from, float to) {
    list_.PathArcTo(at(centre), radius * unit_, from * kTurn, to * kTurn);
    stroke(false);
  }
  void circle(ImVec2 centre, float radius) {
    list_.AddCircle(at(centre), radius * unit_, colour_, 0, width_);
  }
  void dot(ImVec2 centre, float radius) {
    list_.AddCircleFilled(at(centre), radius * unit_, colour_);
  }
  void box(ImVec2 a, ImVec2 b, float rounding = 2) {
    list_.AddRect(at(a), at(b), colour_, rounding * unit_, 0, width_);
  }
  void filledBox(ImVec2 a, ImVec2 b, float rounding = 1) {
    list_.AddRectFilled(at(a), at(b), colour_, rounding * unit_);
  }
  void filled(std::initializer_list<ImVec2> convex) {
    for (const ImVec2& p : convex) list_.PathLineTo(at(p));
    list_.PathFillConvex(colour_);
  }

 private:
  ImVec2 at(ImVec2 p) const { return {min_.x + p.x * unit_, min_.y + p.y * unit_}; }
  void stroke(bool closed) {
    list_.PathStroke(colour_, closed ? ImDrawFlags_Closed : ImDrawFlags_None, width_);
  }

  ImDrawList& list_;
  ImVec2 min_;
  float unit_, width_;
  ImU32 colour_;
};

void drawBrush(Pen& pen) {
  pen.line({{20, 4}, {11, 13}});
  pen.line({{20, 4}, {13, 15}});
  pen.line({{9, 11}, {13, 15}});
  pen.filled({{8.5f, 12.5f}, {11.5f, 15.5f}, {11, 18}, {8, 20.5f}, {3, 21}, {5.5f, 17}, {6, 14}});
}
void drawLasso(Pen& pen) {
  pen.curve({8, 15}, {0, 12}, {3, 4}, {12, 4});
  pen.curve({12, 4}, {22, 4}, {24, 14}, {14, 15.5f});
  pen.curve({14, 15.5f}, {11, 16}, {9, 15.5f}, {8, 15});
  pen.curve({8, 16}, {11, 19}, {8, 22}, {5, 21});
  pen.dot({8, 15.5f}, 2.2f);
}
void drawPolygon(Pen& pen) {
  pen.line({{5, 8}, {15, 4}, {20, 13}, {13, 20}, {6, 17}}, true);
  for (const ImVec2 corner : {ImVec2{5, 8}, {15, 4}, {20, 13}, {13, 20}, {6, 17}})
    pen.dot(corner, 2.2f);
}
void drawWand(Pen& pen) {
  pen.line({{4, 20}, {14, 10}});
  pen.line({{17, 3}, {17, 7}});
  pen.line({{17, 13}, {17, 15}});
  pen.line({{11, 5}, {12.5f, 6.5f}});
  pen.line({{21, 9}, {20, 9}});
  pen.line({{22, 4}, {20.5f, 5.5f}});
  pen.line({{21, 14}, {20, 13}});
}
void drawOrientation(Pen& pen) {
  pen.curve({3, 19}, {8, 8}, {12, 20}, {18, 8});
  pen.line({{13, 8}, {19, 6}, {20, 12}});
}
void drawEye(Pen& pen) {
  pen.curve({2, 12}, {7, 4}, {17, 4}, {22, 12});
  pen.curve({22, 12}, {17, 20}, {7, 20}, {2, 12});
  pen.dot({12, 12}, 3.4f);
}
void drawEyeOff(Pen& pen) {
  pen.curve({2, 12}, {7, 4}, {17, 4}, {22, 12});
  pen.curve({22, 12}, {17, 20}, {7, 20}, {2, 12});
  pen.line({{4, 20}, {20, 4}});
}
void drawLock(Pen& pen, bool locked) {
  pen.filledBox({5, 11}, {19, 21}, 2);
  pen.line({{8, 11}, {8, 8}});
  pen.arc({12, 8}, 4, 0.5f, 1.0f);
  if (locked) pen.line({{16, 8}, {16, 11}});
}
void drawTrash(Pen& pen) {
  pen.line({{4, 7}, {20, 7}});
  pen.line({{9, 7}, {9, 4}, {15, 4}, {15, 7}});
  pen.line({{6, 7}, {7, 20}, {17, 20}, {18, 7}});
  pen.line({{10, 11}, {10, 16}});
  pen.line({{14, 11}, {14, 16}});
}
void drawUndo(Pen& pen, bool redo) {
  const auto x = [&](float value) { return redo ? kUnits - value : value; };
  pen.line({{x(8), 4}, {x(3), 9}, {x(8), 14}});
  pen.line({{x(3), 9}, {x(14), 9}});
  if (redo)
    pen.arc({x(14), 14}, 5, 0.75f, 0.25f);
  else
    pen.arc({x(14), 14}, 5, -0.25f, 0.25f);
  pen.line({{x(14), 19}, {x(9), 19}});
}
void drawFolder(Pen& pen) {
  pen.line({{3, 19}, {3, 5}, {9, 5}, {11.5f, 8}, {21, 8}, {21, 19}}, true);
}
void drawFile(Pen& pen) {
  pen.line({{6, 3}, {14, 3}, {19, 8}, {19, 21}, {6, 21}}, true);
  pen.line({{13.5f, 3}, {13.5f, 8.5f}, {19, 8.5f}});
}
void drawSave(Pen& pen) {
  pen.line({{4, 4}, {16, 4}, {20, 8}, {20, 20}, {4, 20}}, true);
  pen.filledBox({8, 13}, {16, 20});
  pen.line({{8, 4}, {8, 8}, {14, 8}, {14, 4}});
}
void drawCamera(Pen& pen) {
  pen.line({{3, 20}, {3, 8}, {7.5f, 8}, {9.5f, 5}, {14.5f, 5}, {16.5f, 8}, {21, 8}, {21, 20}},
           true);
  pen.circle({12, 13.5f}, 3.8f);
}
void drawSearch(Pen& pen) {
  pen.circle({10.5f, 10.5f}, 6.5f);
  pen.line({{15.5f, 15.5f}, {20.5f, 20.5f}});
}
void drawGear(Pen& pen) {
  pen.circle({12, 12}, 6);
  pen.dot({12, 12}, 2.2f);
  for (int tooth = 0; tooth < 8; ++tooth) {
    const float angle = kTurn * static_cast<float>(tooth) / 8;
    const float x = std::cos(angle), y = std::sin(angle);
    pen.line({{12 + 7 * x, 12 + 7 * y}, {12 + 9.2f * x, 12 + 9.2f * y}});
  }
}
void drawGrid(Pen& pen) {
  pen.box({4, 4}, {20, 20}, 2);
  pen.filledBox({4, 4}, {12, 12});
  pen.filledBox({12, 12}, {20, 20});
}
void drawLayers(Pen& pen) {
  pen.line({{12, 3}, {21, 8}, {12, 13}, {3, 8}}, true);
  pen.line({{3, 12.5f}, {12, 17.5f}, {21, 12.5f}});
  pen.line({{3, 16.5f}, {12, 21.5f}, {21, 16.5f}});
}
void drawFrame(Pen& pen) {
  pen.line({{4, 9}, {4, 4}, {9, 4}});
  pen.line({{15, 4}, {20, 4}, {20, 9}});
  pen.line({{20, 15}, {20, 20}, {15, 20}});
  pen.line({{9, 20}, {4, 20}, {4, 15}});
  pen.dot({12, 12}, 2.4f);
}
void drawWarning(Pen& pen) {
  pen.line({{12, 4}, {21.5f, 20}, {2.5f, 20}}, true);
  pen.line({{12, 10}, {12, 14}});
  pen.dot({12, 17}, 1.2f);
}
void drawInfo(Pen& pen) {
  pen.circle({12, 12}, 9);
  pen.line({{12, 11.5f}, {12, 16.5f}});
  pen.dot({12, 7.8f}, 1.3f);
}
void drawError(Pen& pen) {
  pen.circle({12, 12}, 9);
  pen.line({{12, 7.5f}, {12, 13}});
  pen.dot({12, 16.4f}, 1.3f);
}
void drawHome(Pen& pen) {
  pen.line({{3, 12}, {12, 4}, {21, 12}});
  pen.line({{6, 10}, {6, 20}, {18, 20}, {18, 10}});
}
void drawClock(Pen& pen) {
  pen.circle({12, 12}, 9);
  pen.line({{12, 7}, {12, 12}, {15.5f, 14}});
}
void drawCopy(Pen& pen) {
  pen.box({9, 9}, {20, 20}, 2);
  pen.line({{6, 15}, {4, 15}, {4, 4}, {15, 4}, {15, 6}});
}
void drawPoints(Pen& pen) {
  for (const ImVec2 p : {ImVec2{12, 4},
                         {6, 7},
                         {18, 7},
                         {12, 10},
                         {5, 13},
                         {19, 13},
                         {9, 16},
                         {15, 16},
                         {12, 20.5f}})
    pen.dot(p, 1.6f);
}
void drawEraser(Pen& pen) {
  pen.line({{9, 20}, {3, 14}, {13, 4}, {20, 11}, {11, 20}}, true);
  pen.line({{8, 9}, {15, 16}});
  pen.line({{11, 20}, {20, 20}});
}
void drawFill(Pen& pen) {
  pen.line({{10, 4}, {19, 13}, {11, 20}, {3, 12}}, true);
  pen.filled({{4, 12.5f}, {17.5f, 13.5f}, {11, 19}});
  pen.line({{10, 4}, {7, 2}});
  pen.curve({21, 15}, {19, 18}, {19.5f, 20}, {21, 20});
  pen.curve({21, 15}, {23, 18}, {22.5f, 20}, {21, 20});
}
void drawPick(Pen& pen) {
  pen.line({{4, 20}, {5, 16}, {13, 8}, {16, 11}, {8, 19}}, true);
  pen.line({{11.5f, 6.5f}, {17.5f, 12.5f}});
  pen.line({{15, 9}, {19, 5}});
  pen.dot({18.5f, 5.5f}, 2.6f);
}
void drawGrow(Pen& pen, float direction) {  // 1 outwards, -1 inwards
  pen.circle({12, 12}, 4);
  for (int i = 0; i < 4; ++i) {
    const float angle = kTurn * (static_cast<float>(i) / 4 + 0.125f);
    const float x = std::cos(angle), y = std::sin(angle);
    const float tip = direction > 0 ? 12.5f : 7;
    const float back = tip - 3.2f * direction;
    pen.line({{12 + back * x - 2.4f * y, 12 + back * y + 2.4f * x},
              {12 + tip * x, 12 + tip * y},
              {12 + back * x + 2.4f * y, 12 + back * y - 2.4f * x}});
  }
}
void drawInvert(Pen& pen) {
  pen.circle({12, 12}, 9);
  pen.filled({{12, 3}, {17, 4.6f}, {20, 8}, {21, 12}, {20, 16}, {17, 19.4f}, {12, 21}});
}
void drawSplit(Pen& pen) {
  pen.circle({12, 12}, 9);
  pen.line({{12, 12}, {12, 3}});
  pen.line({{12, 12}, {19.5f, 17}});
  pen.line({{12, 12}, {4.5f, 17}});
}
void drawExport(Pen& pen) {
  pen.line({{12, 15}, {12, 3}});
  pen.line({{7.5f, 7.5f}, {12, 3}, {16.5f, 7.5f}});
  pen.line({{4, 14}, {4, 20}, {20, 20}, {20, 14}});
}
void drawReset(Pen& pen) {
  pen.arc({12, 13}, 7.5f, -0.2f, 0.62f);
  pen.line({{4, 4.5f}, {5.2f, 9.8f}, {10.5f, 8.8f}});
  pen.arc({12, 13}, 7.5f, 0.62f, 0.8f);
}

// Icons of one or two strokes.
bool drawSimple(Pen& pen, Icon icon) {
  switch (icon) {
    case Icon::none:
      return true;
    case Icon::rectangle:
      return pen.box({4, 5}, {20, 19}), true;
    case Icon::plus:
      return pen.line({{12, 5}, {12, 19}}), pen.line({{5, 12}, {19, 12}}), true;
    case Icon::minus:
      return pen.line({{5, 12}, {19, 12}}), true;
    case Icon::play:
      return pen.filled({{7, 4}, {20, 12}, {7, 20}}), true;
    case Icon::pause:
      return pen.filledBox({6, 4}, {10.5f, 20}), pen.filledBox({13.5f, 4}, {18, 20}), true;
    case Icon::stop:
      return pen.filledBox({5, 5}, {19, 19}, 2), true;
    case Icon::close:
      return pen.line({{6, 6}, {18, 18}}), pen.line({{18, 6}, {6, 18}}), true;
    case Icon::chevronRight:
      return pen.line({{9, 5}, {16, 12}, {9, 19}}), true;
    case Icon::chevronDown:
      return pen.line({{5, 9}, {12, 16}, {19, 9}}), true;
    case Icon::check:
      return pen.line({{4, 13}, {9.5f, 18.5f}, {20, 6}}), true;
    case Icon::up:
      return pen.line({{12, 20}, {12, 4}}), pen.line({{5, 11}, {12, 4}, {19, 11}}), true;
    default:
      return false;
  }
}

// long: one line an icon
void drawComposed(Pen& pen, Icon icon) {
  switch (icon) {
    case Icon::brush:
      return drawBrush(pen);
    case Icon::lasso:
      return drawLasso(pen);
    case Icon::polygon:
      return drawPolygon(pen);
    case Icon::wand:
      return drawWand(pen);
    case Icon::orientation:
      return drawOrientation(pen);
    case Icon::eye:
      return drawEye(pen);
    case Icon::eyeOff:
      return drawEyeOff(pen);
    case Icon::lock:
      return drawLock(pen, true);
    case Icon::unlock:
      return drawLock(pen, false);
    case Icon::trash:
      return drawTrash(pen);
    case Icon::undo:
      return drawUndo(pen, false);
    case Icon::redo:
      return drawUndo(pen, true);
    case Icon::folder:
      return drawFolder(pen);
    case Icon::file:
      return drawFile(pen);
    case Icon::save:
      return drawSave(pen);
    case Icon::camera:
      return drawCamera(pen);
    case Icon::search:
      return drawSearch(pen);
    case Icon::gear:
      return drawGear(pen);
    case Icon::grid:
      return drawGrid(pen);
    case Icon::layers:
      return drawLayers(pen);
    case Icon::frame:
      return drawFrame(pen);
    case Icon::warning:
      return drawWarning(pen);
    case Icon::error:
      return drawError(pen);
    case Icon::info:
      return drawInfo(pen);
    case Icon::home:
      return drawHome(pen);
    case Icon::clock:
      return drawClock(pen);
    case Icon::copy:
      return drawCopy(pen);
    case Icon::points:
      return drawPoints(pen);
    case Icon::eraser:
      return drawEraser(pen);
    case Icon::fill:
      return drawFill(pen);
    case Icon::pick:
      return drawPick(pen);
    case Icon::grow:
      return drawGrow(pen, 1);
    case Icon::shrink:
      return drawGrow(pen, -1);
    case Icon::invert:
      return drawInvert(pen);
    case Icon::split:
      return drawSplit(pen);
    case Icon::exportFile:
      return drawExport(pen);
    case Icon::reset:
      return drawReset(pen);
    default:
      return;
  }
}

}  // namespace

void drawIcon(ImDrawList& list, Icon icon, ImVec2 min, float size, ImU32 colour) {
  Pen pen(list, {std::round(min.x), std::round(min.y)}, size, colour);
  if (!drawSimple(pen, icon)) drawComposed(pen, icon);
}

void iconItem(Icon icon, const ImVec4& colour, float size) {
  const float side = size > 0 ? size : theme::px(theme::kIconSize);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  drawIcon(*ImGui::GetWindowDrawList(), icon, at, side, ImGui::GetColorU32(colour));
  ImGui::Dummy({side, side});
}

}  // namespace dapple
