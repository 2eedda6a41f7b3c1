#include "regions/segmentation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "base/errors.h"
#include "regions/surface_distance.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 64 * 256;  // points; whole words of a mask
constexpr std::size_t kCheckpointEvery = 4096;
constexpr std::size_t kSeedSample = 8;  // neighbours that are averaged with the seed

bool linked(const LinkedPoints& graph, Index i, Index j) {
  return glm::dot(graph.points.normals[i], graph.points.normals[j]) > 0;
}

// Calls add(i, mask) for all points in parallel; each call may change its own point's bit only.
PointMask gathered(const LinkedPoints& graph, Monitor& monitor,
                   const std::function<bool(Index)>& holds) {
  PointMask out(graph.points.size());
  parallelFor(monitor, graph.points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (holds(static_cast<Index>(i))) out.add(i);
  });
  return out;
}

// Links run in both directions: those that a point has, and those that others have to it.
PointMask withLinked(const LinkedPoints& graph, const PointMask& mask, Monitor& monitor) {
  const std::size_t links = linksOf(graph.neighborhoods);
  PointMask out = gathered(graph, monitor, [&](Index i) {
    if (mask.has(i)) return true;
    for (const Index j : graph.neighborhoods.of(i).first(links))
      if (mask.has(j) && linked(graph, i, j)) return true;
    return false;
  });
  std::size_t visited = 0;
  for (const Index i : mask.points()) {
    for (const Index j : graph.neighborhoods.of(i).first(links))
      if (!out.has(j) && linked(graph, i, j)) out.add(j);
    if (++visited % kCheckpointEvery == 0) monitor.checkpoint();
  }
  return out;
}

// All that hangs together with `seed` among the points of `allowed`.
class Flood {
 public:
  Flood(const LinkedPoints& graph, const PointMask& allowed, Monitor& monitor)
      : graph_(graph),
        allowed_(allowed),
        monitor_(monitor),
        links_(linksOf(graph.neighborhoods)),
        reached_(graph.points.size()) {}

  PointMask from(Index seed) {
    reached_.add(seed);
    front_.assign(1, seed);
    while (!front_.empty()) {
      followOwnLinks();
      followLinksOfOthers();
    }
    return std::move(reached_);
  }

 private:
  void followOwnLinks() {
    for (std::size_t at = 0; at < front_.size(); ++at) {
      const Index i = front_[at];
      for (const Index j : graph_.neighborhoods.of(i).first(links_)) {
        if (reached_.has(j) || !allowed_.has(j) || !linked(graph_, i, j)) continue;
        reached_.add(j);
        front_.push_back(j);
      }
      if (at % kCheckpointEvery == 0) monitor_.checkpoint();
    }
  }

  // Points with a link to a reached point that has none back: few.
  void followLinksOfOthers() {
    const PointMask more = gathered(graph_, monitor_, [&](Index i) {
      if (reached_.has(i) || !allowed_.has(i)) return false;
      for (const Index j : graph_.neighborhoods.of(i).first(links_))
        if (reached_.has(j) && linked(graph_, i, j)) return true;
      return false;
    });
    front_ = more.points();
    reached_ |= more;
  }

  const LinkedPoints& graph_;
  const PointMask& allowed_;
  Monitor& monitor_;
  const std::size_t links_;
  PointMask reached_;
  std::vector<Index> front_;
};

void checkSeed(const LinkedPoints& graph, Index seed) {
  if (seed >= graph.points.size())
    throw InvalidInput(
        fmt::format("there is no point {}: the scan has {} points", seed, graph.points.size()));
}

// Mean around a point, so that one noisy point does not decide.
vec3 meanAround(const LinkedPoints& graph, std::span<const vec3> column, Index seed) {
  vec3 sum = column[seed];
  std::size_t count = 1;
  const auto near = graph.neighborhoods.of(seed);
  for (const Index j : near.first(std::min(kSeedSample, near.size())))
    if (linked(graph, seed, j)) sum += column[j], ++count;
  return sum / static_cast<float>(count);
}

PointMask alike(const LinkedPoints& graph, std::span<const vec3> colours, Index seed,
                const WandOptions& options, Monitor& monitor) {
  if (options.by == WandBy::Distance) {
    const std::vector<float> distance =
        surfaceDistances(graph, {&seed, 1}, options.threshold, monitor);
    return gathered(graph, monitor, [&](Index i) { return distance[i] <= options.threshold; });
  }
  if (options.by == WandBy::Colour) {
    const vec3 wanted = meanAround(graph, colours, seed);
    const float limit = options.threshold * options.threshold;
    return gathered(graph, monitor, [&](Index i) {
      const vec3 d = colours[i] - wanted;
      return glm::dot(d, d) <= limit;
    });
  }
  const vec3 mean = meanAround(graph, graph.points.normals, seed);
  const vec3 wanted = mean / glm::length(mean);  // of normals within 90 degrees of the seed's
  const float least =
      std::cos(std::min(options.threshold, 180.f) * std::numbers::pi_v<float> / 180);
  return gathered(graph, monitor,
                  [&](Index i) { return glm::dot(graph.points.normals[i], wanted) >= least; });
}

}  // namespace

PointMask grown(const LinkedPoints& graph, const PointMask& mask, Monitor& monitor) {
  DAPPLE_CHECK(mask.size(), ==, graph.points.size());
  return withLinked(graph, mask, monitor);
}

PointMask shrunk(const LinkedPoints& graph, const PointMask& mask, Monitor& monitor) {
  PointMask rest = mask;
  rest.invert();
  rest = grown(graph, rest, monitor);
  rest.invert();
  return rest;
}

PointMask connectedTo(const LinkedPoints& graph, Index seed, Monitor& monitor) {
  checkSeed(graph, seed);
  const PointMask all(graph.points.size(), true);
  return Flood(graph, all, monitor).from(seed);
}

PointMask wand(const LinkedPoints& graph, std::span<const vec3> colours, Index seed,
               const WandOptions& options, Monitor& monitor) {
  checkSeed(graph, seed);
  if (!(options.threshold >= 0 && std::isfinite(options.threshold)))
    throw InvalidInput(
        fmt::format("the wand's threshold is {}; give a number of 0 or more", options.threshold));
  if (options.by == WandBy::Colour && colours.size() != graph.points.size())
    throw InvalidInput("the wand cannot select by colour: the scan has no colours");
  PointMask mask = alike(graph, colours, seed, options, monitor);
  mask.add(seed);  // also when it is unlike its surroundings
  if (!options.connected || options.by == WandBy::Distance) return mask;
  return Flood(graph, mask, monitor).from(seed);
}

}  // namespace dapple
