// k-medoids under a distance along the surface. Crossing a crease or a change of colour costs as
// much as a walk over a part of the whole scan, so that parts end there; between them the distance
// makes parts compact and of about equal size.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/errors.h"
#include "points/connected_parts.h"
#include "regions/surface_distance.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 8192;
constexpr int kMostParts = 250;
constexpr int kRounds = 3;        // of moving the medoids
constexpr float kCrease = 4;      // cost of a right angle, in extents of the scan
constexpr float kChange = 4;      // cost of a change from black to white, likewise
constexpr float kSmooth = 0.06f;  // 1 - cos up to which a surface counts as smooth: 20 degrees
constexpr float kAlike = 0.06f;   // change of colour that is noise
constexpr double kScrap = 0.02;   // a piece below this share of an even part is no part of its own

float extentOf(const std::vector<vec3>& positions) {
  vec3 low = positions.front(), high = low;
  for (const vec3& p : positions) low = glm::min(low, p), high = glm::max(high, p);
  return glm::length(high - low);
}

std::vector<vec3> smoothed(const Neighborhoods& neighborhoods, std::span<const vec3> column,
                           Monitor& monitor) {
  const std::size_t links = linksOf(neighborhoods);
  std::vector<vec3> out(column.size());
  parallelFor(monitor, column.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      vec3 sum = column[i];
      for (const Index j : neighborhoods.of(i).first(links)) sum += column[j];
      out[i] = sum / static_cast<float>(links + 1);
    }
  });
  return out;
}

class Segmenter {
 public:
  Segmenter(const LinkedPoints& graph, std::span<const vec3> colours, std::size_t parts,
            Monitor& monitor)
      : graph_(graph), monitor_(monitor), links_(linksOf(graph.neighborhoods)), parts_(parts) {
    measureLinks(colours);
    findScraps();
  }

  std::vector<std::uint8_t> run() {
    std::vector<Index> medoids = farthestPoints();
    Parts best = partsOf(medoids);
    for (int round = 0; round < kRounds; ++round) {
      medoids = centres(best);
      Parts next = partsOf(medoids);
      if (!(next.cost < best.cost)) break;
      best = std::move(next);
    }
    return labelsOf(best);
  }

 private:
  struct Parts {
    std::vector<Index> medoids, label;  // label: n, kNone where no medoid reaches
    double cost = 0;                    // sum of distances
  };

  void measureLinks(std::span<const vec3> colours) {
    const std::size_t n = graph_.points.size();
    const float extent = extentOf(graph_.points.positions);
    const std::vector<vec3> plain =
        colours.empty() ? std::vector<vec3>() : smoothed(graph_.neighborhoods, colours, monitor_);
    lengths_.resize(n * links_);
    parallelFor(monitor_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t c = 0; c < links_; ++c) {
          const Index j = graph_.neighborhoods.of(i)[c];
          const float facing = glm::dot(graph_.points.normals[i], graph_.points.normals[j]);
          float cost = kCrease * std::max(0.f, 1 - facing - kSmooth);
          if (!plain.empty())
            cost += kChange * std::max(0.f, glm::length(plain[i] - plain[j]) - kAlike);
          lengths_[i * links_ + c] =
              distanceBetween(graph_.points.positions[i], graph_.points.positions[j]) +
              extent * cost;
        }
    });
  }

  void findScraps() {
    const std::size_t n = graph_.points.size();
    const ConnectedParts pieces = connectedParts(graph_.neighborhoods, graph_.points.positions,
                                                 std::numeric_limits<float>::max());
    std::vector<std::size_t> size(pieces.count, 0);
    for (const Index piece : pieces.part) ++size[piece];
    const double least = kScrap * static_cast<double>(n) / static_cast<double>(parts_);
    scrap_.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i)
      scrap_[i] = static_cast<double>(size[pieces.part[i]]) < least ? 1 : 0;
    if (std::find(scrap_.begin(), scrap_.end(), 0) == scrap_.end())
      scrap_.assign(n, 0);  // nothing but scraps: all count
  }

  // Each the furthest from all before; what nothing has reached yet is furthest.
  std::vector<Index> farthestPoints() {
    std::vector<Index> out;
    SurfaceWays ways(graph_, lengths_);
    while (out.size() < parts_) {
      Index next = kNone;
      for (Index i = 0; i < scrap_.size(); ++i)
        if (!scrap_[i] && (next == kNone || ways.distances()[i] > ways.distances()[next])) next = i;
      if (ways.distances()[next] == 0) break;  // fewer points than parts
      ways.add(next, static_cast<Index>(out.size()));
      out.push_back(next);
      ways.run(std::numeric_limits<float>::infinity(), monitor_);
    }
    return out;
  }

  Parts partsOf(const std::vector<Index>& medoids) {
    SurfaceWays ways(graph_, lengths_);
    for (std::size_t m = 0; m < medoids.size(); ++m) ways.add(medoids[m], static_cast<Index>(m));
    ways.run(std::numeric_limits<float>::infinity(), monitor_);
    Parts parts{.medoids = medoids, .label = ways.labels()};
    for (std::size_t i = 0; i < parts.label.size(); ++i)
      if (parts.label[i] != kNone && !scrap_[i])
        parts.cost += static_cast<double>(ways.distances()[i]);
    return parts;
  }

  // Of each part the point nearest to the part's mean position.
  std::vector<Index> centres(const Parts& parts) const {
    const std::size_t m = parts.medoids.size();
    std::vector<dvec3> sum(m, dvec3(0));
    std::vector<double> count(m, 0);
    const std::vector<vec3>& positions = graph_.points.positions;
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (parts.label[i] != kNone)
        sum[parts.label[i]] += dvec3(positions[i]), ++count[parts.label[i]];
    std::vector<Index> out = parts.medoids;
    std::vector<double> nearest(m, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Index p = parts.label[i];
      if (p == kNone || scrap_[i]) continue;
      const dvec3 away = dvec3(positions[i]) - sum[p] / count[p];
      if (const double d = glm::dot(away, away); d < nearest[p])
        nearest[p] = d, out[p] = static_cast<Index>(i);
    }
    return out;
  }

  std::vector<std::uint8_t> labelsOf(const Parts& parts) const {
    const std::vector<vec3>& positions = graph_.points.positions;
    std::vector<std::uint8_t> out(parts.label.size(), 0);
    for (std::size_t i = 0; i < out.size(); ++i) {
      Index label = parts.label[i];
      float nearest = std::numeric_limits<float>::infinity();
      for (Index m = 0; m < parts.medoids.size() && parts.label[i] == kNone; ++m) {
        const vec3 away = positions[parts.medoids[m]] - positions[i];
        if (const float d = glm::dot(away, away); d < nearest) nearest = d, label = m;
      }
      out[i] = static_cast<std::uint8_t>(label);
    }
    return out;
  }

  const LinkedPoints& graph_;
  Monitor& monitor_;
  const std::size_t links_;
  const std::size_t parts_;
  std::vector<float> lengths_;
  std::vector<std::uint8_t> scrap_;  // n: of a piece too small to be a part
};

}  // namespace

std::vector<std::uint8_t> segment(const LinkedPoints& graph, std::span<const vec3> colours,
                                  const SegmentOptions& options, Monitor& monitor) {
  if (options.parts < 1 || options.parts > kMostParts)
    throw InvalidInput(fmt::format("parts: {} is outside 1 to {}; give a number between",
                                   options.parts, kMostParts));
  const std::size_t n = graph.points.size();
  DAPPLE_CHECK(colours.size() == n || colours.empty(), ==, true);
  monitor.begin(Stage::Segments, 0);
  return Segmenter(graph, colours, static_cast<std::size_t>(options.parts), monitor).run();
}

}  // namespace dapple
