// Borders of regions in the picture: edges between pixels that show different regions are joined
// into chains and smoothed.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "app/render/overlay.h"
#include "base/errors.h"

namespace dapple {
namespace {

constexpr Index kBackground = kNone - 1;   // pixels without a point
constexpr float kWidth = 1.7f;             // pixels, at scale 1
constexpr std::size_t kShortestLoop = 24;  // edges: a speck of less is not drawn
constexpr int kMajorities = 2;
constexpr std::size_t kKeep = 3;  // of so many points of a smoothed chain one is drawn

// The regions that the pixels show.
struct Labels {
  int width, height;
  std::vector<Index> region;

  Index at(int x, int y) const {
    return region[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

// What most of the 3 x 3 pixels show, if more than show the one in the middle.
Index majority(const Labels& labels, int x, int y) {
  const Index own = labels.at(x, y);
  Index best = own;
  int most = 0;
  for (int k = 0; k < 9; ++k) {
    const Index candidate = labels.at(x + k % 3 - 1, y + k / 3 - 1);
    if (candidate == kBackground) continue;
    int votes = candidate == own;  // of equals it stays what it is
    for (int j = 0; j < 9; ++j) votes += 2 * (labels.at(x + j % 3 - 1, y + j / 3 - 1) == candidate);
    if (votes > most || (votes == most && candidate < best)) most = votes, best = candidate;
  }
  return best;
}

bool uniform(const Labels& labels, int x, int y) {
  const Index own = labels.at(x, y);
  return labels.at(x - 1, y) == own && labels.at(x + 1, y) == own && labels.at(x, y - 1) == own &&
         labels.at(x, y + 1) == own;
}

// Single pixels of noise, where splats of two regions blend, are taken away.
void smoothLabels(Labels& labels) {
  for (int pass = 0; pass < kMajorities; ++pass) {
    const Labels before = labels;
    for (int y = 1; y + 1 < labels.height; ++y)
      for (int x = 1; x + 1 < labels.width; ++x)
        if (before.at(x, y) != kBackground && !uniform(before, x, y))
          labels.region[static_cast<std::size_t>(y) * static_cast<std::size_t>(labels.width) +
                        static_cast<std::size_t>(x)] = majority(before, x, y);
  }
}

// The pixels' corners with the border edges that meet there: bit 0 to the right, 1 down, 2 to the
// left, 3 up.
class Corners {
 public:
  explicit Corners(const Labels& labels)
      : width_(labels.width + 1),
        edges_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(labels.height + 1), 0) {
    const auto border = [](Index a, Index b) {
      return a != b && a != kBackground && b != kBackground;
    };
    for (int y = 0; y < labels.height; ++y)
      for (int x = 0; x < labels.width; ++x) {
        if (x + 1 < labels.width && border(labels.at(x, y), labels.at(x + 1, y)))
          join({x + 1, y}, 1);
        if (y + 1 < labels.height && border(labels.at(x, y), labels.at(x, y + 1)))
          join({x, y + 1}, 0);
      }
    whole_ = edges_;
  }

  std::size_t size() const { return edges_.size(); }
  ivec2 place(std::size_t corner) const {
    const auto row = static_cast<std::size_t>(width_);
    return {static_cast<int>(corner % row), static_cast<int>(corner / row)};
  }
  int edgesLeft(ivec2 p) const { return std::popcount(edges_[index(p)]); }
  // Two borders pass it by, others meet or end there.
  bool isMeeting(ivec2 p) const { return std::popcount(whole_[index(p)]) != 2; }

  // Follows the edges from p until they end or meet others, or return to p, and takes them away.
  std::vector<ivec2> take(ivec2 p) {
    std::vector<ivec2> chain{p};
    const ivec2 first = p;
    do {
      const int direction = std::countr_zero(edges_[index(p)]);
      const ivec2 next = p + kSteps[direction];
      edges_[index(p)] &= static_cast<std::uint8_t>(~(1u << direction));
      edges_[index(next)] &= static_cast<std::uint8_t>(~(1u << (direction ^ 2)));
      p = next;
      chain.push_back(p);
    } while (p != first && !isMeeting(p));
    return chain;
  }

 private:
  static constexpr ivec2 kSteps[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};

  std::size_t index(ivec2 p) const {
    return static_cast<std::size_t>(p.y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(p.x);
  }
  void join(ivec2 p, int direction) {
    edges_[index(p)] |= static_cast<std::uint8_t>(1u << direction);
    edges_[index(p + kSteps[direction])] |= static_cast<std::uint8_t>(1u << (direction ^ 2));
  }

  int width_;
  std::vector<std::uint8_t> edges_, whole_;  // what is left, and what was there
};

// Every point becomes the mean of itself and its two neighbours, many times; ends stay.
void smooth(std::vector<vec2>& line, bool closed, int times) {
  const std::size_t n = line.size();
  std::vector<vec2> before;
  for (int k = 0; k < times; ++k) {
    before = line;
    for (std::size_t i = closed ? 0 : 1; i + (closed ? 0 : 1) < n; ++i)
      line[i] = 0.25f * (before[(i + n - 1) % n] + before[(i + 1) % n]) + 0.5f * before[i];
  }
}

std::vector<vec2> thinned(const std::vector<vec2>& line) {
  std::vector<vec2> out;
  for (std::size_t i = 0; i < line.size(); i += kKeep) out.push_back(line[i]);
  if ((line.size() - 1) % kKeep != 0) out.push_back(line.back());
  return out;
}

}  // namespace

OverlayLines outlineLines(const OverlayView& view, std::span<const Index> region,
                          const vec3& colour) {
  const Raster& traced = view.traced;
  Labels labels{traced.width, traced.height, {}};
  float depth = 0;
  std::size_t covered = 0;
  for (std::size_t p = 0; p < traced.points.size(); ++p) {
    const Index i = traced.points[p];
    labels.region.push_back(i == kNone ? kBackground : region[i]);
    if (i != kNone) depth += traced.depths[p], ++covered;
  }
  if (covered == 0) return {};
  smoothLabels(labels);

  // A border zigzags between the discs of its points: it is smoothed over as many pixels.
  const float disc = view.radius * view.pixels.pixelsPerUnit(depth / static_cast<float>(covered));
  const float deviation = std::clamp(0.7f * disc, 1.6f, 8.f);
  const int times = static_cast<int>(2 * deviation * deviation);  // each adds a variance of 1/2
  Corners corners(labels);
  OverlayLines lines;
  const auto add = [&](const std::vector<ivec2>& chain) {
    const bool closed = chain.front() == chain.back();
    if (closed && chain.size() <= kShortestLoop) return;
    OverlayLine line{{}, glm::vec4(colour, 1), kWidth * view.scale, closed};
    for (const ivec2& p : chain) line.points.emplace_back(p);
    if (closed) line.points.pop_back();
    smooth(line.points, closed, times);
    line.points = thinned(line.points);
    lines.push_back(std::move(line));
  };
  // First what begins or ends where borders meet, then what runs in circles.
  for (const bool circles : {false, true})
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const ivec2 p = corners.place(c);
      if (!circles && !corners.isMeeting(p)) continue;
      while (corners.edgesLeft(p) > 0) add(corners.take(p));
    }
  return withCasing(lines, view.scale);
}

}  // namespace dapple
