// [Zeng] keeps three sets: Y, coloured; B, the border, next to them; N, all others. The next point
// is the one of B with the shortest way from the start. The point before it on that way is nearer
// to the start, so that it is coloured already whenever all nearer points are: the nearest point
// that is not in Y always is in B. Points in the order of their distance, without those coloured
// meanwhile, are therefore the paper's order, and no set has to be kept.
//
// Departure: links lead both ways, as neighbours need not be mutual, and not through a thin sheet.
#include "synthesis/surface_order.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "base/errors.h"
#include "base/hashed_order.h"

namespace dapple {
namespace {

constexpr std::size_t kLinks = 8;  // of a point, to its nearest
constexpr std::size_t kCheckpointEvery = 4096;
constexpr std::uint64_t kStartStream = 401;
constexpr float kUnreached = std::numeric_limits<float>::infinity();

// Dijkstra's search, point by point.
class Spreading {
 public:
  Spreading(const PointSet& points, const Neighborhoods& near, const Monitor& monitor)
      : points_(points),
        near_(near),
        links_(std::min(kLinks, near.k)),
        monitor_(monitor),
        distance_(points.size(), kUnreached) {
    addLinksBack();
  }

  bool reached(Index i) const { return distance_[i] < kUnreached; }

  void start(Index i) {
    distance_[i] = 0;
    queue_.push({0.f, i});
  }

  // Appends all that the starts reach.
  void run(std::vector<Index>& order) {
    while (!queue_.empty()) {
      const auto [distance, i] = queue_.top();
      queue_.pop();
      if (distance > distance_[i]) continue;
      order.push_back(i);
      if (order.size() % kCheckpointEvery == 0) monitor_.checkpoint();
      for (const Index j : linksOf(i)) follow(i, j);
      for (Index l = firstBack_[i]; l < firstBack_[i + 1]; ++l) follow(i, back_[l]);
    }
  }

 private:
  using Entry = std::pair<float, Index>;

  std::span<const Index> linksOf(Index i) const { return near_.of(i).first(links_); }

  template <class Visit>
  void forLinksBack(Visit visit) const {
    for (Index i = 0; i < points_.size(); ++i) {
      if (i % kCheckpointEvery == 0) monitor_.checkpoint();
      for (const Index j : linksOf(i)) {
        const auto theirs = linksOf(j);
        if (std::find(theirs.begin(), theirs.end(), i) == theirs.end()) visit(j, i);
      }
    }
  }

  // From j to i where only i has j among its nearest.
  void addLinksBack() {
    firstBack_.assign(points_.size() + 1, 0);
    forLinksBack([&](Index j, Index) { ++firstBack_[j + 1]; });
    for (std::size_t i = 0; i < points_.size(); ++i) firstBack_[i + 1] += firstBack_[i];
    back_.resize(firstBack_.back());
    std::vector<Index> next(firstBack_.begin(), firstBack_.end() - 1);
    forLinksBack([&](Index j, Index i) { back_[next[j]++] = i; });
  }

  void follow(Index i, Index j) {
    const float distance =
        distance_[i] + distanceBetween(points_.positions[i], points_.positions[j]);
    if (!(distance < distance_[j])) return;
    if (!(glm::dot(points_.normals[i], points_.normals[j]) > 0)) return;
    distance_[j] = distance;
    queue_.push({distance, j});
  }

  const PointSet& points_;
  const Neighborhoods& near_;
  const std::size_t links_;
  const Monitor& monitor_;
  std::vector<float> distance_;
  std::vector<Index> firstBack_, back_;  // n + 1, links
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

std::vector<Index> surfaceOrder(const PointSet& points, const Neighborhoods& neighborhoods,
                                std::span<const Index> starts, std::uint64_t seed,
                                Monitor& monitor) {
  const std::size_t n = points.size();
  for (const Index start : starts)
    if (start >= n) throw InvalidInput(fmt::format("start: {} is not one of {} points", start, n));
  std::vector<Index> order;
  order.reserve(n);
  Spreading spreading(points, neighborhoods, monitor);
  for (const Index start : starts) spreading.start(start);
  spreading.run(order);
  const HashedOrder shuffled(n, hashBits(seed, kStartStream));
  for (std::size_t s = 0; order.size() < n; ++s) {
    const Index start = shuffled.at(s);
    if (spreading.reached(start)) continue;
    spreading.start(start);
    spreading.run(order);
  }
  return order;
}

}  // namespace dapple
