// [Soler] Hierarchical Pattern Mapping, carried from meshes to points (methods: section 6).
//
// Departures, apart from those of cluster_split.cpp, cluster_chart.cpp, cluster_matching.cpp and
// lattice_relaxation.cpp:
// - clusters are cut when they are needed, not beforehand;
// - what is coloured already is compared by the points around the cluster, in the cluster's own
//   chart, so that nothing is resampled;
// - a cluster is accepted by its border's difference after relaxation: before, it would be cut
//   although it can be made to fit;
// - angles are counted from that of the cluster next door that has most of the border: where
//   pieces meet at the same angle the pattern goes on;
// - where directions are followed a cluster may lie a little askew: F grows by .03, the mean of
//   eight swatches on 85,000 points of bunny.ply, and F along the directions as much;
// - of the best angles the one is taken that fits best once its place is bent.
#include "synthesis/pattern_mapping.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <queue>
#include <utility>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "synthesis/cluster_chart.h"
#include "synthesis/cluster_matching.h"
#include "synthesis/cluster_split.h"
#include "synthesis/spacing_reads.h"

namespace dapple {
namespace {

constexpr std::size_t kChildren = 5;   // of a cluster
constexpr std::size_t kFewest = 24;    // points: smaller clusters are not cut further
constexpr float kMostOfSwatch = 0.8f;  // of its width and height: larger clusters are cut at once
constexpr double kComplete = 0.98;     // of a cluster's points that the chart has, at least
constexpr double kMostStrained = 0.1;  // of them
constexpr std::size_t kAngles = 19;    // of a whole turn
constexpr std::size_t kBent = 3;       // best angles whose places are bent to see which fits
constexpr float kAskew = 8;            // degrees from a direction that is followed
constexpr std::size_t kSamples = 240;  // of a border, at most
constexpr float kRounding = 1e-4f;     // of a difference of colours: a plain swatch has no contrast
constexpr int kCoarser = 2;            // levels from what is compared to what is relaxed first
constexpr std::uint64_t kPlaceStream = 501;

struct Cluster {
  std::vector<Index> points;
  std::size_t known = 0;  // links from points that are coloured
  bool waits = false;     // on the level at hand
};

class Mapper {
 public:
  Mapper(const SynthesisInput& input, const MappingOptions& options, SourceMap& map,
         Monitor& monitor)
      : input_(input),
        options_(options),
        map_(map),
        monitor_(monitor),
        level_(meanReadLevel(input)),
        graph_(linkBothWays(input.neighborhoods, input.points.normals, 0, monitor)),
        splitter_(input.points, graph_),
        chart_(input, graph_),
        matcher_(input.swatch, level_),
        blurred_(input.swatch, level_ + kCoarser),
        contrast_(static_cast<float>(swatchContrast(input.swatch, level_))),
        spacing_(localSpacing(input.neighborhoods, input.points.positions)),
        known_(input.points.size(), 0),
        touched_(input.points.size(), 0),
        clusterOf_(input.points.size(), kNone) {}

  MappingStatistics run() {
    const std::size_t n = input_.points.size();
    map_.domain.resize(n, vec2(0));
    std::vector<Index> open;
    for (Index i = 0; i < n; ++i)
      if (!input_.isKept(i)) open.push_back(i);
    for (Index i = 0; i < n; ++i)
      if (input_.isKept(i)) know(i);
    add(splitter_.pieces(open, monitor_));
    while (!next_.empty()) mapLevel();
    readBySpacing(input_, map_, monitor_);
    if (compared_ > 0 && contrast_ > 0) {
      statistics_.matchedError = std::sqrt(matchedSquares_ / compared_) / contrast_;
      statistics_.borderError = std::sqrt(borderSquares_ / compared_) / contrast_;
    }
    return statistics_;
  }

 private:
  // A laid-out cluster that may be accepted.
  struct Layout {
    ClusterMatch match;
    Relaxation relaxation;
    std::size_t samples = 0;  // of the border
  };

  float threshold() const {
    return (input_.follow ? options_.followThreshold : options_.threshold) * contrast_ + kRounding;
  }

  // Clusters that wait for the next level.
  void add(std::vector<std::vector<Index>> clusters) {
    for (std::vector<Index>& points : clusters) {
      const Index id = static_cast<Index>(clusters_.size());
      Cluster& cluster = clusters_.emplace_back();
      for (const Index i : points) clusterOf_[i] = id, cluster.known += touched_[i];
      cluster.points = std::move(points);
      next_.push_back(id);
    }
  }

  // Point i is coloured from now on.
  void know(Index i) {
    known_[i] = 1;
    for (const Index j : graph_.of(i)) {
      ++touched_[j];
      const Index cluster = clusterOf_[j];
      if (known_[j] || cluster == kNone) continue;
      ++clusters_[cluster].known;
      if (clusters_[cluster].waits && (raised_.empty() || raised_.back() != cluster))
        raised_.push_back(cluster);
    }
  }

  // Clusters of one level, those that most of is coloured around first. Entries of the queue that
  // are out of date are skipped.
  void mapLevel() {
    const std::vector<Index> level = std::exchange(next_, {});
    std::priority_queue<std::pair<std::size_t, Index>> queue;  // known, from the last id
    const auto push = [&](Index id) { queue.push({clusters_[id].known, kNone - id}); };
    for (const Index id : level) clusters_[id].waits = true, push(id);
    while (!queue.empty()) {
      const auto [known, fromLast] = queue.top();
      queue.pop();
      const Index id = kNone - fromLast;
      if (!clusters_[id].waits || clusters_[id].known != known) continue;
      clusters_[id].waits = false;
      raised_.clear();
      visit(std::exchange(clusters_[id].points, {}));
      for (const Index raised : raised_) push(raised);
    }
  }

  void visit(const std::vector<Index>& points) {
    monitor_.checkpoint();
    const bool smallest = points.size() < kFewest;
    if (points.size() > 1 && areaOf(points) > mostArea()) return cut(points);
    chart_.flatten(points, monitor_);
    ++statistics_.flattened;
    if (!smallest && !wellFlattened(points.size())) return cut(points);
    chart_.addBand(known_, options_.band, monitor_);
    Layout layout;
    if (!layOut(layout)) return points.size() > 1 ? cut(points) : placeAlone(points[0]);
    const bool fits = layout.relaxation.after <= threshold();
    if (!fits && !smallest) return cut(points);
    if (smallest) statistics_.forcedPoints += chart_.members();
    accept(layout);
    addRest(points);
  }

  void cut(const std::vector<Index>& points) { add(splitter_.split(points, kChildren, monitor_)); }

  // Square pixels.
  double areaOf(const std::vector<Index>& points) const {
    double sum = 0;
    for (const Index i : points) {
      const double side = spacing_[i] / input_.unitAt(i);
      sum += side * side;
    }
    return sum;
  }
  double mostArea() const {
    return static_cast<double>(kMostOfSwatch * kMostOfSwatch) *
           static_cast<double>(input_.swatch.pixels());
  }

  bool wellFlattened(std::size_t points) const {
    const auto charted = static_cast<double>(chart_.members());
    return charted >= kComplete * static_cast<double>(points) &&
           static_cast<double>(chart_.strained()) <= kMostStrained * charted;
  }

  // Places, bends and checks the cluster of the chart.
  bool layOut(Layout& best) {
    gatherInside();
    gatherBorder();
    best.samples = samples_.size();
    if (samples_.empty()) return placeFirst(best);
    std::vector<ClusterMatch> matches = matcher_.matches({inside_, samples_}, angles(), monitor_);
    if (matches.size() > kBent) matches.resize(kBent);
    bool any = false;
    for (const ClusterMatch& match : matches) {
      Layout layout{.match = match, .samples = samples_.size()};
      bend(layout);
      if (!allUsable(layout) || (any && layout.relaxation.after >= best.relaxation.after)) continue;
      best = std::move(layout);
      any = true;
    }
    return any;
  }

  // Unless that would lead out of the swatch.
  void bend(Layout& layout) {
    std::vector<BorderSample> turned(samples_);
    for (BorderSample& sample : turned) sample.place = layout.match.turn(sample.place);
    layout.relaxation = relaxBorder(blurred_, matcher_.reader(), turned, layout.match.placement);
    if (allUsable(layout)) return;
    layout.relaxation.lattice = {};
    layout.relaxation.after = layout.relaxation.before;
  }

  void gatherInside() {
    inside_.clear();
    for (const ChartSite& site : chart_.sites().first(chart_.members())) inside_.push_back(site.q);
  }

  // Evenly along the Morton order.
  void gatherBorder() {
    const std::size_t members = chart_.members(), count = chart_.sites().size() - members;
    std::vector<Index> order(count);
    std::iota(order.begin(), order.end(), static_cast<Index>(members));
    std::sort(order.begin(), order.end(),
              [&](Index a, Index b) { return chart_.ids()[a] < chart_.ids()[b]; });
    samples_.clear(), border_.clear();
    const std::size_t used = std::min(kSamples, count);
    for (std::size_t s = 0; s < used; ++s) {
      const Index c = order[s * count / used];
      border_.push_back(c);
      samples_.push_back({chart_.sites()[c].q, map_.texel[chart_.ids()[c]]});
    }
  }

  std::vector<float> angles() const {
    constexpr float kTurn = 2 * std::numbers::pi_v<float>;
    if (input_.follow) return {0, kTurn * kAskew / 360, -kTurn * kAskew / 360};
    const float first = neighboursAngle();
    std::vector<float> out;
    for (std::size_t a = 0; a < kAngles; ++a)
      out.push_back(first + kTurn * static_cast<float>(a) / kAngles);
    return out;
  }

  // How far the patch with most of the border is turned in this chart: a mean over its samples.
  float neighboursAngle() const {
    std::vector<Index> patches;
    for (const Index c : border_) patches.push_back(map_.patch[chart_.ids()[c]]);
    std::sort(patches.begin(), patches.end());
    Index most = kNone;
    std::size_t longest = 0;
    for (std::size_t begin = 0, end; begin < patches.size(); begin = end) {
      end = begin;
      while (end < patches.size() && patches[end] == patches[begin]) ++end;
      if (end - begin > longest) longest = end - begin, most = patches[begin];
    }
    float cosine = 0, sine = 0;
    for (const Index c : border_) {
      const Index i = chart_.ids()[c];
      if (map_.patch[i] != most) continue;
      const ChartSite& site = chart_.sites()[c];
      const vec3 up = map_.frame[i].t;
      cosine += glm::dot(up, site.t), sine -= glm::dot(up, glm::cross(site.t, site.n));
    }
    return std::atan2(sine, cosine);
  }

  // Where nothing around is coloured: anywhere, inside a swatch that does not tile and, of some
  // tries, where it has no holes.
  bool placeFirst(Layout& layout) const {
    constexpr std::uint64_t kTries = 16;
    const vec2 size(input_.swatch.width, input_.swatch.height);
    const PlacementBox box = roomyBox(input_.swatch, boxOf(inside_, layout.match.turn));
    const vec2 slack = size - 1.f - (box.high - box.low);
    if (!input_.swatch.tileable && !(slack.x >= 0 && slack.y >= 0)) return false;
    for (std::uint64_t attempt = 0; attempt < kTries; ++attempt) {
      const std::uint64_t patch = map_.placement.size();
      const vec2 random(hashUniform(options_.seed, kPlaceStream, patch, 2 * attempt),
                        hashUniform(options_.seed, kPlaceStream, patch, 2 * attempt + 1));
      layout.match.placement =
          input_.swatch.tileable ? random * size : 0.5f - box.low + random * slack;
      if (allUsable(layout)) return true;
    }
    return false;
  }

  vec2 domainOf(const Layout& layout, std::size_t site) const {
    const vec2 q = layout.match.turn(chart_.sites()[site].q);
    return q + layout.relaxation.lattice.at(q);
  }

  bool allUsable(const Layout& layout) const {
    if (input_.swatch.tileable) return true;
    for (std::size_t s = 0; s < chart_.members(); ++s)
      if (!usableTexel(input_.swatch, domainOf(layout, s) + layout.match.placement)) return false;
    return true;
  }

  void accept(const Layout& layout) {
    const auto patch = static_cast<Index>(map_.placement.size());
    map_.placement.push_back(layout.match.placement);
    for (std::size_t s = 0; s < chart_.members(); ++s) {
      const ChartSite& site = chart_.sites()[s];
      const TangentFrame frame{glm::cross(site.t, site.n), site.t, site.n};
      write(chart_.ids()[s], patch, domainOf(layout, s), layout.match.turn.of(frame),
            layout.relaxation.after);
    }
    const auto samples = static_cast<double>(layout.samples);
    const double before = layout.relaxation.before, after = layout.relaxation.after;
    matchedSquares_ += samples * before * before, borderSquares_ += samples * after * after;
    compared_ += samples;
    finish(chart_.ids().first(chart_.members()));
  }

  // A point that nothing can be made to fit.
  void placeAlone(Index i) {
    const auto patch = static_cast<Index>(map_.placement.size());
    map_.placement.push_back(randomTexel(input_.swatch, options_.seed, i, kPlaceStream));
    write(i, patch, vec2(0), orthonormalFrame(input_.points.normals[i], input_.frames[i].t), 0);
    ++statistics_.forcedPoints;
    finish({&i, 1});
  }

  void write(Index i, Index patch, vec2 domain, const TangentFrame& frame, float error) {
    map_.domain[i] = domain;
    map_.patch[i] = patch;
    map_.state[i] = PointState::Matched;
    map_.frame[i] = frame;
    map_.error[i] = error;
    map_.order[i] = coloured_++;
    placePoint(map_, input_.swatch, i);
  }

  void finish(std::span<const Index> ids) {
    ++statistics_.clusters;
    for (const Index i : ids) know(i);
    monitor_.advance(ids.size());
    if (monitor_.wantsPreview()) monitor_.publish({map_.colour, map_.state});
  }

  // Points of an accepted cluster that the chart does not have.
  void addRest(const std::vector<Index>& points) {
    if (chart_.members() == points.size()) return;
    std::vector<Index> rest;
    for (const Index i : points)
      if (!known_[i]) rest.push_back(i);
    add(splitter_.pieces(rest, monitor_));
  }

  const SynthesisInput& input_;
  const MappingOptions& options_;
  SourceMap& map_;
  Monitor& monitor_;
  const int level_;  // of the swatch's stack: pixels as wide as points are apart
  const PointGraph graph_;
  ClusterSplitter splitter_;
  ClusterChart chart_;
  const ClusterMatcher matcher_;
  const TexelReader blurred_;
  const float contrast_;
  const std::vector<float> spacing_;    // n, local units
  std::vector<std::uint8_t> known_;     // n: has its colour
  std::vector<std::uint16_t> touched_;  // n: links from points that have
  std::vector<Index> clusterOf_;        // n
  std::vector<Cluster> clusters_;       // of all levels; those that were visited are empty
  std::vector<Index> next_;             // clusters of the next level
  std::vector<Index> raised_;           // that wait and of which more has become known
  std::vector<vec2> inside_;            // of the cluster at hand
  std::vector<BorderSample> samples_;
  std::vector<Index> border_;  // sites of the samples
  Index coloured_ = 0;
  double matchedSquares_ = 0, borderSquares_ = 0, compared_ = 0;
  MappingStatistics statistics_;
};

}  // namespace

MappingStatistics mapPattern(const SynthesisInput& input, const MappingOptions& options,
                             SourceMap& map, Monitor& monitor) {
  DAPPLE_CHECK(input.unit, >, 0);
  DAPPLE_CHECK(map.state.size(), ==, input.points.size());
  const ChartedInput charted(input, true, monitor);
  return Mapper(charted.get(), options, map, monitor).run();
}

}  // namespace dapple
