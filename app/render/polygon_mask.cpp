#include "app/render/polygon_mask.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dapple {
namespace {

constexpr float kMostCells = 1024;  // a side
// Cells by which an edge's reach is rounded outwards: a cell that counts as whole has no edge.
constexpr float kSlack = 0.01f;

}  // namespace

PolygonMask::PolygonMask(std::span<const vec2> corners, int width, int height) {
  std::vector<vec2> finite;
  for (const vec2& c : corners)
    if (std::isfinite(c.x) && std::isfinite(c.y)) finite.push_back(c);
  if (finite.size() < 3) return;
  vec2 low(std::numeric_limits<float>::infinity()), high = -low;
  for (std::size_t i = 0; i < finite.size(); ++i) {
    edges_.push_back({finite[i], finite[(i + 1) % finite.size()]});
    low = glm::min(low, finite[i]);
    high = glm::max(high, finite[i]);
  }
  low = glm::max(low, vec2(0));
  high = glm::min(high, vec2(width, height));
  if (!(low.x < high.x && low.y < high.y)) return;
  low_ = low, high_ = high;
  const vec2 size = high - low;
  side_ = std::max(1.f, std::max(size.x, size.y) / kMostCells);
  perSide_ = 1 / side_;
  columns_ = static_cast<int>(size.x / side_) + 1;
  rows_ = static_cast<int>(size.y / side_) + 1;
  cells_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kOutside);
  gatherRows();
  fillRows();
  markEdges();
}

int PolygonMask::columnOf(float x) const {
  return static_cast<int>(
      std::clamp((x - low_.x) * perSide_, 0.f, static_cast<float>(columns_ - 1)));
}

int PolygonMask::rowOf(float y) const {
  return static_cast<int>(std::clamp((y - low_.y) * perSide_, 0.f, static_cast<float>(rows_ - 1)));
}

void PolygonMask::gatherRows() {
  const auto forRows = [&](const Edge& e, const auto& visit) {
    const float slack = kSlack * side_;
    const float top = std::min(e.a.y, e.b.y) - slack, bottom = std::max(e.a.y, e.b.y) + slack;
    if (bottom < low_.y || top > high_.y) return;
    for (int row = rowOf(top); row <= rowOf(bottom); ++row) visit(static_cast<std::size_t>(row));
  };
  rowBegin_.assign(static_cast<std::size_t>(rows_) + 1, 0);
  for (const Edge& e : edges_) forRows(e, [&](std::size_t row) { ++rowBegin_[row + 1]; });
  for (std::size_t row = 1; row < rowBegin_.size(); ++row) rowBegin_[row] += rowBegin_[row - 1];
  rowEdges_.resize(rowBegin_.back());
  std::vector<std::size_t> next(rowBegin_.begin(), rowBegin_.end() - 1);
  for (const Edge& e : edges_) forRows(e, [&](std::size_t row) { rowEdges_[next[row]++] = e; });
}

// Every cell as its centre: right for those without an edge.
void PolygonMask::fillRows() {
  std::vector<float> crossings;
  for (int row = 0; row < rows_; ++row) {
    const float y = low_.y + (static_cast<float>(row) + 0.5f) * side_;
    crossings.clear();
    for (const Edge& e : edgesOf(row))
      if (e.crosses(y)) crossings.push_back(e.at(y));
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const float first = (crossings[i] - low_.x) / side_ - 0.5f,
                  last = (crossings[i + 1] - low_.x) / side_ - 0.5f;
      const float most = static_cast<float>(columns_ - 1);
      const int begin = static_cast<int>(std::clamp(std::ceil(first), 0.f, most + 1)),
                end = static_cast<int>(std::clamp(std::floor(last), -1.f, most));
      if (begin <= end) std::fill(&cell(begin, row), &cell(end, row) + 1, kInside);
    }
  }
}

void PolygonMask::markEdges() {
  const float slack = kSlack * side_;
  for (int row = 0; row < rows_; ++row) {
    const float top = low_.y + static_cast<float>(row) * side_ - slack,
                bottom = top + side_ + 2 * slack;
    for (const Edge& e : edgesOf(row)) {
      float left = std::min(e.a.x, e.b.x), right = std::max(e.a.x, e.b.x);
      if (std::abs(e.b.y - e.a.y) > slack) {  // the part of the edge inside the row
        const auto inside = [&](float y) {
          return e.at(std::clamp(y, std::min(e.a.y, e.b.y), std::max(e.a.y, e.b.y)));
        };
        const float x0 = inside(top), x1 = inside(bottom);
        left = std::max(left, std::min(x0, x1)), right = std::min(right, std::max(x0, x1));
      }
      left -= slack, right += slack;
      if (right < low_.x || left > high_.x) continue;
      std::fill(&cell(columnOf(left), row), &cell(columnOf(right), row) + 1, kMixed);
    }
  }
}

bool PolygonMask::contains(vec2 pixel) const {
  const int row = rowOf(pixel.y);
  const Cell known = cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                            static_cast<std::size_t>(columnOf(pixel.x))];
  if (known != kMixed) return known == kInside;
  bool inside = false;
  for (const Edge& e : edgesOf(row))
    if (e.crosses(pixel.y) && pixel.x < e.at(pixel.y)) inside = !inside;
  return inside;
}

}  // namespace dapple
