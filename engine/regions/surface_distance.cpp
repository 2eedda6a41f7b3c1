#include "regions/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kLinks = 12;
constexpr std::size_t kGrain = 8192;
constexpr std::size_t kCheckpointEvery = 4096;
constexpr std::size_t kMostBuckets = 1 << 16;  // what lies further shares the last one
constexpr float kStep = 0.3f;                  // mean spacings: little is entered twice
constexpr float kUnreached = std::numeric_limits<float>::infinity();

// Width of a bucket, a speed and not a precision: from the spacing of some of the points.
float stepOf(const LinkedPoints& graph) {
  constexpr std::size_t kAsked = 4096;
  const std::size_t n = graph.points.size(), every = std::max<std::size_t>(1, n / kAsked);
  const double perDistance =
      std::sqrt(std::numbers::pi / (static_cast<double>(graph.neighborhoods.k) + 0.5));
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; i += every, ++count)
    sum += distanceBetween(graph.points.positions[i],
                           graph.points.positions[graph.neighborhoods.of(i).back()]);
  return std::max(static_cast<float>(kStep * perDistance * sum / static_cast<double>(count)),
                  1e-9f);
}

// Without labels, and along the links that face each other: what SurfaceWays would find, several
// times as fast, as ways back towards the sources are not measured.
class PlainWays {
 public:
  PlainWays(const LinkedPoints& graph, float limit)
      : near_(graph.neighborhoods),
        positions_(graph.points.positions),
        normals_(graph.points.normals),
        links_(linksOf(graph.neighborhoods)),
        limit_(limit),
        step_(stepOf(graph)),
        distance_(graph.points.size(), kUnreached),
        followed_(graph.points.size(), kUnreached),
        closer_(graph.points.size()) {}

  std::vector<float> run(std::span<const Index> seeds, Monitor& monitor) {
    for (const Index seed : seeds) {
      low_ = glm::min(low_, positions_[seed] - limit_),
      high_ = glm::max(high_, positions_[seed] + limit_);
      enter(seed, 0);
    }
    do {
      drain(monitor);
    } while (followLinksOfOthers(monitor));
    return std::move(distance_);
  }

 private:
  bool linked(std::size_t i, Index j) const { return glm::dot(normals_[i], normals_[j]) > 0; }

  // False: further from all seeds than the limit, as the crow flies.
  bool inReach(std::size_t i) const {
    const vec3& p = positions_[i];
    return p.x >= low_.x && p.y >= low_.y && p.z >= low_.z && p.x <= high_.x && p.y <= high_.y &&
           p.z <= high_.z;
  }

  std::size_t bucketOf(float distance) const {
    return static_cast<std::size_t>(
        std::min(distance / step_, static_cast<float>(kMostBuckets - 1)));
  }

  void enter(Index i, float distance) {
    distance_[i] = distance;
    closer_.add(i);
    const std::size_t bucket = bucketOf(distance);
    if (bucket >= buckets_.size()) buckets_.resize(bucket + 1);
    buckets_[bucket].push_back(i);
    first_ = std::min(first_, bucket);
  }

  void follow(Index i) {
    const float base = distance_[i];
    if (base == followed_[i]) return;
    followed_[i] = base;
    float atLeast = 0;  // links come in the order of their lengths: those to come are no shorter
    for (const Index j : near_.of(i).first(links_)) {
      if (!(base + atLeast < distance_[j])) continue;
      atLeast = distanceBetween(positions_[i], positions_[j]);
      const float distance = base + atLeast;
      if (distance < distance_[j] && distance <= limit_ && linked(i, j)) enter(j, distance);
    }
  }

  void drain(Monitor& monitor) {
    std::size_t visited = 0;
    std::vector<Index> now;
    while (first_ < buckets_.size()) {
      if (buckets_[first_].empty()) {
        ++first_;
        continue;
      }
      now.clear();
      now.swap(buckets_[first_]);  // it may refill itself
      for (const Index i : now) {
        if (++visited % kCheckpointEvery == 0) monitor.checkpoint();
        follow(i);
      }
    }
  }

  bool followLinksOfOthers(Monitor& monitor) {
    const std::size_t n = distance_.size();
    std::vector<std::vector<std::pair<Index, float>>> found((n + kGrain - 1) / kGrain);
    parallelFor(monitor, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!inReach(i)) continue;
        float least = distance_[i], atLeast = 0;
        for (const Index j : near_.of(i).first(links_)) {
          if (!closer_.has(j) || !(distance_[j] + atLeast < least)) continue;
          atLeast = distanceBetween(positions_[i], positions_[j]);
          const float distance = distance_[j] + atLeast;
          if (distance < least && distance <= limit_ && linked(i, j)) least = distance;
        }
        if (least < distance_[i]) found[begin / kGrain].push_back({static_cast<Index>(i), least});
      }
    });
    closer_ = PointMask(n);
    bool any = false;
    for (const auto& part : found)
      for (const auto& [i, distance] : part) enter(i, distance), any = true;
    return any;
  }

  const Neighborhoods& near_;
  const std::vector<vec3>&positions_, &normals_;
  const std::size_t links_;
  const float limit_, step_;
  vec3 low_{kUnreached}, high_{-kUnreached};  // around all that may be reached
  std::vector<float> distance_;
  std::vector<float> followed_;  // from which distance the links of a point were followed
  PointMask closer_;             // points that came closer since links of others were followed last
  std::vector<std::vector<Index>> buckets_;
  std::size_t first_ = 0;
};

}  // namespace

std::size_t linksOf(const Neighborhoods& neighborhoods) {
  return std::min(kLinks, neighborhoods.k);
}

SurfaceWays::SurfaceWays(const LinkedPoints& graph, const std::vector<float>& lengths)
    : graph_(graph),
      lengths_(lengths),
      links_(linksOf(graph.neighborhoods)),
      distance_(graph.points.size(), kUnreached),
      label_(graph.points.size(), kNone) {
  DAPPLE_CHECK(lengths.size(), ==, graph.points.size() * links_);
  step_ = stepOf(graph);
}

void SurfaceWays::add(Index source, Index label) {
  enter(source, 0, label);
}

// Of equally long ways the one of the smallest label counts.
void SurfaceWays::enter(Index i, float distance, Index label) {
  if (!(distance < distance_[i] || (distance == distance_[i] && label < label_[i]))) return;
  distance_[i] = distance;
  label_[i] = label;
  const auto bucket =
      static_cast<std::size_t>(std::min(distance / step_, static_cast<float>(kMostBuckets - 1)));
  if (bucket >= buckets_.size()) buckets_.resize(bucket + 1);
  buckets_[bucket].push_back(i);
  first_ = std::min(first_, bucket);
}

void SurfaceWays::drain(float limit, Monitor& monitor) {
  std::size_t visited = 0;
  std::vector<Index> now;
  for (; first_ < buckets_.size(); ++first_)
    // A bucket may refill itself and, as the steps are no lower bound, is then searched again.
    while (!buckets_[first_].empty()) {
      now.clear();
      now.swap(buckets_[first_]);
      const std::size_t bucket = first_;
      for (const Index i : now) {
        if (++visited % kCheckpointEvery == 0) monitor.checkpoint();
        const float base = distance_[i];
        // Entered again since, in an earlier bucket, and followed from there.
        if (std::min(base / step_, static_cast<float>(kMostBuckets - 1)) <
            static_cast<float>(bucket))
          continue;
        for (std::size_t c = 0; c < links_; ++c) {
          const float distance = base + length(i, c);
          if (distance <= limit && distance < kUnreached)
            enter(graph_.neighborhoods.of(i)[c], distance, label_[i]);
        }
      }
    }
}

bool SurfaceWays::followLinksOfOthers(float limit, Monitor& monitor) {
  const std::size_t n = distance_.size();
  PointMask closer(n);
  const auto nearest = [&](std::size_t i) {
    std::pair<float, Index> best{kUnreached, kNone};
    for (std::size_t c = 0; c < links_; ++c) {
      const Index j = graph_.neighborhoods.of(i)[c];
      if (distance_[j] >= distance_[i]) continue;  // also where neither is reached
      const float distance = distance_[j] + length(i, c);
      if (distance <= limit && distance < kUnreached)
        best = std::min(best, std::pair(distance, label_[j]));
    }
    return best;
  };
  parallelFor(monitor, n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (nearest(i) < std::pair(distance_[i], label_[i])) closer.add(i);
  });
  const std::vector<Index> points = closer.points();
  std::vector<std::pair<float, Index>> ways;
  for (const Index i : points) ways.push_back(nearest(i));  // before any of them counts
  for (std::size_t p = 0; p < points.size(); ++p) enter(points[p], ways[p].first, ways[p].second);
  return !points.empty();
}

void SurfaceWays::run(float limit, Monitor& monitor) {
  do {
    drain(limit, monitor);
  } while (followLinksOfOthers(limit, monitor));
}

std::vector<float> surfaceDistances(const LinkedPoints& graph, std::span<const Index> seeds,
                                    float limit, Monitor& monitor) {
  for (const Index seed : seeds) DAPPLE_CHECK(seed, <, graph.points.size());
  return PlainWays(graph, limit).run(seeds, monitor);
}

}  // namespace dapple
