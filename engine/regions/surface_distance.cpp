#include "regions/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kLinks = 12;
constexpr std::size_t kGrain = 8192;
constexpr std::size_t kCheckpointEvery = 4096;
constexpr std::size_t kMostBuckets = 1 << 16;  // what lies further shares the last one
constexpr float kStep = 0.3f;                  // mean spacings: little is entered twice
constexpr float kUnreached = std::numeric_limits<float>::infinity();

// Without labels, and along the links that face each other: what SurfaceWays would find, several
// times as fast: all that a link asks of a point lies in half a cache line, and ways back towards
// the sources are not measured.
class PlainWays {
 public:
  PlainWays(const PointGraph& graph, float limit)
      : near_(graph.neighborhoods),
        links_(linksOf(graph.neighborhoods)),
        limit_(limit),
        step_(std::max(
            kStep * static_cast<float>(meanSpacing(graph.neighborhoods, graph.points.positions)),
            1e-9f)),
        sites_(graph.points.size()) {
    for (std::size_t i = 0; i < sites_.size(); ++i)
      sites_[i].position = graph.points.positions[i], sites_[i].normal = graph.points.normals[i];
  }

  std::vector<float> run(std::span<const Index> seeds, Monitor& monitor) {
    for (const Index seed : seeds) enter(seed, 0);
    do {
      drain(monitor);
    } while (followLinksOfOthers(monitor));
    std::vector<float> distances(sites_.size());
    for (std::size_t i = 0; i < sites_.size(); ++i) distances[i] = sites_[i].distance;
    return distances;
  }

 private:
  struct alignas(32) Site {
    vec3 position;
    float distance = kUnreached;
    vec3 normal;
    float followed = kUnreached;  // the distance from which its links were followed
  };

  static bool linked(const Site& a, const Site& b) { return glm::dot(a.normal, b.normal) > 0; }

  std::size_t bucketOf(float distance) const {
    return static_cast<std::size_t>(
        std::min(distance / step_, static_cast<float>(kMostBuckets - 1)));
  }

  void enter(Index i, float distance) {
    sites_[i].distance = distance;
    const std::size_t bucket = bucketOf(distance);
    if (bucket >= buckets_.size()) buckets_.resize(bucket + 1);
    buckets_[bucket].push_back(i);
    first_ = std::min(first_, bucket);
  }

  void follow(Index i) {
    Site& from = sites_[i];
    const float base = from.distance;
    if (base == from.followed) return;
    from.followed = base;
    for (const Index j : near_.of(i).first(links_)) {
      const Site& to = sites_[j];
      if (!(base < to.distance) || !linked(from, to)) continue;
      const float distance = base + distanceBetween(from.position, to.position);
      if (distance < to.distance && distance <= limit_) enter(j, distance);
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
    const std::size_t n = sites_.size();
    std::vector<std::vector<std::pair<Index, float>>> found((n + kGrain - 1) / kGrain);
    parallelFor(monitor, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Site& own = sites_[i];
        float least = own.distance;
        for (const Index j : near_.of(i).first(links_)) {
          const Site& from = sites_[j];
          if (!(from.distance < least) || !linked(own, from)) continue;
          const float distance = from.distance + distanceBetween(own.position, from.position);
          if (distance < least && distance <= limit_) least = distance;
        }
        if (least < own.distance) found[begin / kGrain].push_back({static_cast<Index>(i), least});
      }
    });
    bool any = false;
    for (const auto& part : found)
      for (const auto& [i, distance] : part) enter(i, distance), any = true;
    return any;
  }

  const Neighborhoods& near_;
  const std::size_t links_;
  const float limit_, step_;
  std::vector<Site> sites_;
  std::vector<std::vector<Index>> buckets_;
  std::size_t first_ = 0;
};

}  // namespace

std::size_t linksOf(const Neighborhoods& neighborhoods) {
  return std::min(kLinks, neighborhoods.k);
}

SurfaceWays::SurfaceWays(const PointGraph& graph, const std::vector<float>& lengths)
    : graph_(graph),
      lengths_(lengths),
      links_(linksOf(graph.neighborhoods)),
      distance_(graph.points.size(), kUnreached),
      label_(graph.points.size(), kNone) {
  DAPPLE_CHECK(lengths.size(), ==, graph.points.size() * links_);
  step_ = std::max(
      kStep * static_cast<float>(meanSpacing(graph.neighborhoods, graph.points.positions)), 1e-9f);
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

std::vector<float> surfaceDistances(const PointGraph& graph, std::span<const Index> seeds,
                                    float limit, Monitor& monitor) {
  for (const Index seed : seeds) DAPPLE_CHECK(seed, <, graph.points.size());
  return PlainWays(graph, limit).run(seeds, monitor);
}

}  // namespace dapple
