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
constexpr float kUnreached = std::numeric_limits<float>::infinity();

}  // namespace

std::size_t linksOf(const Neighborhoods& neighborhoods) {
  return std::min(kLinks, neighborhoods.k);
}

SurfaceWays::SurfaceWays(const Neighborhoods& neighborhoods, const std::vector<float>& lengths,
                         float step)
    : neighborhoods_(neighborhoods),
      lengths_(lengths),
      links_(linksOf(neighborhoods)),
      step_(step),
      distance_(neighborhoods.size(), kUnreached),
      label_(neighborhoods.size(), kNone) {
  DAPPLE_CHECK(lengths.size(), ==, neighborhoods.size() * links_);
  DAPPLE_CHECK(step, >, 0.f);
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
        const Index* ids = neighborhoods_.of(i).data();
        const float* lengths = lengths_.data() + i * links_;
        for (std::size_t c = 0; c < links_; ++c) {
          const float distance = base + lengths[c];
          if (lengths[c] >= 0 && distance <= limit) enter(ids[c], distance, label_[i]);
        }
      }
    }
}

// Neighbours are not mutual: a point may have a link to one that has none back.
bool SurfaceWays::followLinksOfOthers(float limit, Monitor& monitor) {
  const std::size_t n = distance_.size();
  std::vector<float> shorter(n, kUnreached);
  std::vector<Index> label(n, kNone);
  parallelFor(monitor, n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t c = 0; c < links_; ++c) {
        const float length = lengths_[i * links_ + c];
        const Index j = neighborhoods_.of(i)[c];
        const float distance = distance_[j] + length;
        if (length < 0 || distance > limit) continue;
        if (distance < shorter[i] || (distance == shorter[i] && label_[j] < label[i]))
          shorter[i] = distance, label[i] = label_[j];
      }
  });
  for (std::size_t i = 0; i < n; ++i)
    if (label[i] != kNone) enter(static_cast<Index>(i), shorter[i], label[i]);
  return first_ < buckets_.size();
}

void SurfaceWays::run(float limit, Monitor& monitor) {
  do {
    drain(limit, monitor);
  } while (followLinksOfOthers(limit, monitor));
}

std::vector<float> surfaceDistances(const PointGraph& graph, std::span<const Index> seeds,
                                    float limit, Monitor& monitor) {
  const std::size_t n = graph.points.size(), links = linksOf(graph.neighborhoods);
  std::vector<float> lengths(n * links);
  parallelFor(monitor, n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t c = 0; c < links; ++c) {
        const Index j = graph.neighborhoods.of(i)[c];
        const bool facing = glm::dot(graph.points.normals[i], graph.points.normals[j]) > 0;
        lengths[i * links + c] = facing ? graph.neighborhoods.distancesOf(i)[c] : -1;
      }
  });
  const float spacing = static_cast<float>(meanSpacing(graph.neighborhoods));
  SurfaceWays ways(graph.neighborhoods, lengths, std::max(spacing, 1e-9f));
  for (const Index seed : seeds) {
    DAPPLE_CHECK(seed, <, n);
    ways.add(seed, 0);
  }
  ways.run(limit, monitor);
  return ways.distances();
}

}  // namespace dapple
