// A pixel is covered as far as the line reaches into it: from the distance between its centre and
// the nearest piece of the line.
#include <algorithm>
#include <cmath>

#include "app/render/overlay.h"

namespace dapple {
namespace {

float distanceToPiece(vec2 p, vec2 a, vec2 b) {
  const vec2 along = b - a, to = p - a;
  const float length2 = glm::dot(along, along);
  const float t = length2 > 0 ? std::clamp(glm::dot(to, along) / length2, 0.f, 1.f) : 0.f;
  return glm::length(to - t * along);
}

// How much of each pixel one line covers: no pixel twice where its pieces meet.
class Coverage {
 public:
  Coverage(int width, int height)
      : width_(width),
        height_(height),
        covered_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.f) {}

  void add(vec2 a, vec2 b, float halfWidth) {
    const float reach = halfWidth + 0.5f;
    const vec2 low = glm::min(a, b) - reach, high = glm::max(a, b) + reach;
    if (!(high.x > 0 && high.y > 0 && low.x < static_cast<float>(width_) &&
          low.y < static_cast<float>(height_)))
      return;
    const auto pixel = [](float at, int size) {
      return static_cast<int>(std::clamp(at, 0.f, static_cast<float>(size - 1)));
    };
    for (int y = pixel(low.y, height_); y <= pixel(high.y, height_); ++y)
      for (int x = pixel(low.x, width_); x <= pixel(high.x, width_); ++x) {
        const vec2 centre(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        const float part = std::min(1.f, reach - distanceToPiece(centre, a, b));
        if (part > 0) cover(x, y, part);
      }
  }

  // Calls blend(x, y, part) for what is covered, and forgets it.
  template <class Blend>
  void take(const Blend& blend) {
    for (const std::size_t at : touched_) {
      const auto row = static_cast<std::size_t>(width_);
      blend(static_cast<int>(at % row), static_cast<int>(at / row), covered_[at]);
      covered_[at] = 0;
    }
    touched_.clear();
  }

 private:
  void cover(int x, int y, float part) {
    const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                           static_cast<std::size_t>(x);
    if (covered_[at] == 0) touched_.push_back(at);
    covered_[at] = std::max(covered_[at], part);
  }

  int width_, height_;
  std::vector<float> covered_;
  std::vector<std::size_t> touched_;
};

}  // namespace

void drawLines(std::span<const OverlayLine> lines, Image& picture) {
  Coverage coverage(picture.width, picture.height);
  for (const OverlayLine& line : lines) {
    const std::size_t n = line.points.size();
    const float halfWidth = 0.5f * std::max(1.f, line.width);
    for (std::size_t i = 0; i + 1 < n; ++i)
      coverage.add(line.points[i], line.points[i + 1], halfWidth);
    if (n == 1 || (line.closed && n > 2))
      coverage.add(line.points[n - 1], line.points[0], halfWidth);
    const float opacity = line.colour.a * std::min(1.f, line.width);  // thinner lines are fainter
    coverage.take([&](int x, int y, float part) {
      for (int c = 0; c < std::min(3, picture.channels); ++c) {
        float& value = picture.at(x, y, c);
        value += part * opacity * (line.colour[c] - value);
      }
    });
  }
}

}  // namespace dapple
