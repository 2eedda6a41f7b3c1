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

}  // namespace

std::size_t linksOf(const Neighborhoods& neighborhoods) {
  return std::min(kLinks, neighborhoods.k);
}

SurfaceWays::SurfaceWays(const PointGraph& graph, const std::vector<float>* lengths)
    : graph_(graph),
      lengths_(lengths),
      links_(linksOf(graph.neighborhoods)),
      distance_(graph.points.size(), kUnreached),
      label_(graph.points.size(), kNone) {
  if (lengths) DAPPLE_CHECK(lengths->size(), ==, graph.points.size() * links_);
  step_ = std::max(kStep * static_cast<float>(meanSpacing(graph.neighborhoods)), 1e-9f);
}

float SurfaceWays::length(std::size_t i, std::size_t link) const {
  if (lengths_) return (*lengths_)[i * links_ + link];
  const std::vector<vec3>& normals = graph_.points.normals;
  const bool facing = glm::dot(normals[i], normals[graph_.neighborhoods.of(i)[link]]) > 0;
  return facing ? graph_.neighborhoods.distancesOf(i)[link] : kUnreached;
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
  SurfaceWays ways(graph, nullptr);
  for (const Index seed : seeds) {
    DAPPLE_CHECK(seed, <, graph.points.size());
    ways.add(seed, 0);
  }
  ways.run(limit, monitor);
  return ways.distances();
}

}  // namespace dapple
