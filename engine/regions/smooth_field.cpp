// Departures from methods 1.3: coarse links are merged fine ones (field_levels.h); directions are
// powers of complex numbers, so that no sweep has to choose among N signs or quarter turns; and the
// coarsest level starts from nothing. Sweeps from `up` or from chance are trapped easily: a stroke
// against what surrounds it would never turn its neighbours. Two ways from nothing are tried, and
// the smoother is taken: without the condition of unit length at first, which is a linear problem
// with one solution, and with it, so that directions spread from point to point.
#include "regions/smooth_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/errors.h"
#include "points/tangent_frames.h"
#include "regions/field_combing.h"

namespace dapple {
namespace {

constexpr int kMostLevels = 16;
constexpr int kFirstSweeps = 60;   // of the coarsest level
constexpr float kNothing = 1e-6f;  // shorter sums have no direction
// Levels of fewer nodes are solved anew by update().
constexpr std::size_t kSmallLevel = 8192;
constexpr int kRounds = 6, kRoundSweeps = 2;  // of update(), around what it touches

// Of a level of a quarter of the nodes twice as many: the finer levels take over its mistakes. The
// finest only has to even out what it takes over.
int sweepsOf(std::size_t level) {
  return level == 0 ? 2 : 4 << std::min<std::size_t>(level, 6);
}

template <class Value>
void setFixed(std::span<const Fixed<Value>> fixed, std::vector<Value>& values) {
  for (const Fixed<Value>& f : fixed) values[f.node] = f.value;
}

// `nodes`, or all of n when there are none given, without the fixed ones.
template <class Value>
ClassOrder orderOfFree(std::size_t n, std::span<const Fixed<Value>> fixed) {
  std::vector<Index> ids;
  ids.reserve(n);
  auto skip = fixed.begin();
  for (Index i = 0; i < n; ++i) {
    if (skip != fixed.end() && skip->node == i)
      ++skip;
    else
      ids.push_back(i);
  }
  return classOrder(ids);
}

// What is fixed on the next level: the mean of a node's fixed members, as long as it has one.
vec2 towardsParent(const FieldLevel& level, const Fixed<vec2>& f) {
  return product(conjugate(level.fromParent[f.node]), f.value);
}
float towardsParent(const FieldLevel&, const Fixed<float>& f) {
  return f.value;
}

bool finishMean(vec2& sum, float) {
  const bool some = glm::dot(sum, sum) > kNothing * kNothing;
  sum = unit(sum);
  return some;
}
bool finishMean(float& sum, float count) {
  sum /= count;
  return true;
}

template <class Value>
std::vector<Fixed<Value>> fixedParents(const FieldLevel& level,
                                       const std::vector<Fixed<Value>>& fixed) {
  std::vector<Fixed<Value>> all;
  for (const Fixed<Value>& f : fixed)
    all.push_back({level.parent[f.node], towardsParent(level, f)});
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.node < b.node; });
  std::vector<Fixed<Value>> out;
  for (std::size_t i = 0; i < all.size();) {
    Fixed<Value> mean{all[i].node, Value(0)};
    float count = 0;
    for (; i < all.size() && all[i].node == mean.node; ++i, ++count) mean.value += all[i].value;
    if (finishMean(mean.value, count)) out.push_back(mean);
  }
  return out;
}

template <class Value>
std::vector<std::vector<Fixed<Value>>> fixedLevels(const FieldLevels& field,
                                                   std::vector<Fixed<Value>> finest) {
  std::vector<std::vector<Fixed<Value>>> out{std::move(finest)};
  while (out.size() < field.levels.size())
    out.push_back(fixedParents(field.levels[out.size() - 1], out.back()));
  return out;
}

vec2 prolonged(const vec2& fromParent, const vec2& direction) {
  return product(fromParent, direction);
}
float prolonged(const vec2&, float scale) {
  return scale;
}

template <class Value>
std::vector<Value> prolong(const FieldLevel& level, const std::vector<Value>& coarse,
                           Monitor& monitor) {
  std::vector<Value> out(level.size());
  forChunks(monitor, out.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      out[i] = prolonged(level.fromParent[i], coarse[level.parent[i]]);
  });
  return out;
}

// Where nothing pulls anywhere (part of a scan that faces `up`), any direction will do.
void pointSomewhere(std::vector<vec2>& values) {
  for (vec2& value : values)
    value = glm::dot(value, value) > kNothing * kNothing ? unit(value) : vec2(1, 0);
}

// How much neighbours differ, up to a constant of the level.
double roughness(const FieldLevel& level, std::span<const std::uint8_t> pulled,
                 const std::vector<vec2>& values) {
  double sum = 0;
  for (std::size_t i = 0; i < level.size(); ++i) {
    for (std::size_t e = level.graph.offset[i]; e < level.graph.offset[i + 1]; ++e)
      sum -= glm::dot(values[i], product(level.turn[e], values[level.graph.ids[e]]));
    if (!pulled.empty() && pulled[i]) sum -= 2 * glm::dot(values[i], level.pull[i]);
  }
  return sum;
}

std::vector<Index> nodesOf(const std::vector<Fixed<vec2>>& fixed) {
  std::vector<Index> nodes;
  for (const Fixed<vec2>& f : fixed) nodes.push_back(f.node);
  return nodes;
}

// Nodes that are fixed in one of the two only, or otherwise.
std::vector<Index> changedNodes(const std::vector<Fixed<vec2>>& a,
                                const std::vector<Fixed<vec2>>& b) {
  std::vector<Index> out;
  auto x = a.begin(), y = b.begin();
  while (x != a.end() || y != b.end()) {
    if (y == b.end() || (x != a.end() && x->node < y->node)) {
      out.push_back(x++->node);
    } else if (x == a.end() || y->node < x->node) {
      out.push_back(y++->node);
    } else {
      if (x->value != y->value) out.push_back(x->node);
      ++x, ++y;
    }
  }
  return out;
}

// A set of nodes that grows.
class NodeSet {
 public:
  explicit NodeSet(std::size_t n) : in_(n, 0) {}
  void add(Index i) {
    if (in_[i]) return;
    in_[i] = 1;
    ids.push_back(i);
  }
  std::vector<Index> ids;

 private:
  std::vector<std::uint8_t> in_;
};

// Those of `nodes` that are not fixed.
std::vector<Index> freeOf(std::span<const Index> nodes, const std::vector<Fixed<vec2>>& fixed) {
  std::vector<Index> out;
  for (const Index i : nodes) {
    const auto at =
        std::lower_bound(fixed.begin(), fixed.end(), i,
                         [](const Fixed<vec2>& f, Index node) { return f.node < node; });
    if (at == fixed.end() || at->node != i) out.push_back(i);
  }
  return out;
}

// Gives the memory back; `= {}` would keep it.
template <class T>
void release(std::vector<T>& column) {
  std::vector<T>().swap(column);
}

bool haveScales(std::span<const StrokeMark> marks) {
  return std::any_of(marks.begin(), marks.end(),
                     [](const StrokeMark& mark) { return mark.scale != 1; });
}

}  // namespace

std::vector<Fixed<vec2>> fixedDirections(const PointSet& points, std::span<const StrokeMark> marks,
                                         int folds) {
  std::vector<Fixed<vec2>> all, out;
  for (const StrokeMark& mark : marks)
    all.push_back({mark.point, mark.weight * power(unit(tangentNumber(points.normals[mark.point],
                                                                      mark.direction)),
                                                   folds)});
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.node < b.node; });
  for (std::size_t i = 0; i < all.size();) {
    Fixed<vec2> sum{all[i].node, vec2(0)};
    for (; i < all.size() && all[i].node == sum.node; ++i) sum.value += all[i].value;
    if (finishMean(sum.value, 1)) out.push_back(sum);
  }
  return out;
}

std::vector<float> smoothScales(const FieldLevels& field, std::span<const StrokeMark> marks,
                                Monitor& monitor) {
  if (!haveScales(marks)) return {};
  std::vector<StrokeMark> sorted(marks.begin(), marks.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const StrokeMark& a, const StrokeMark& b) { return a.point < b.point; });
  std::vector<Fixed<float>> drawn;
  for (std::size_t i = 0; i < sorted.size();) {
    float sum = 0, weight = 0;
    const Index point = sorted[i].point;
    for (; i < sorted.size() && sorted[i].point == point; ++i) {
      sum += sorted[i].weight * std::log(sorted[i].scale);
      weight += sorted[i].weight;
    }
    drawn.push_back({point, sum / weight});
  }
  const auto fixed = fixedLevels(field, std::move(drawn));
  std::vector<float> values(field.levels.back().size(), 0.f);
  for (std::size_t l = field.levels.size(); l-- > 0;) {
    const FieldLevel& level = field.levels[l];
    const bool top = l + 1 == field.levels.size();
    if (!top) values = prolong(level, values, monitor);
    setFixed<float>(fixed[l], values);
    const ClassOrder order = orderOfFree<float>(level.size(), fixed[l]);
    relax<float>({.level = level, .order = order, .step = 1}, top ? kFirstSweeps : sweepsOf(l),
                 values, monitor);
  }
  for (float& value : values) value = std::exp(value);
  return values;
}

SmoothField::SmoothField(const PointSet& points, const Neighborhoods& neighborhoods,
                         const FieldOptions& options, Monitor& monitor)
    : points_(points),
      options_(options),
      levels_(clusterField(points, neighborhoods, options, kMostLevels, monitor)),
      value_(levels_.levels.size()) {}

// The coarsest level, from nothing but what is fixed and pulled.
std::vector<vec2> SmoothField::coarsest(Monitor& monitor) const {
  const std::size_t l = levels_.levels.size() - 1;
  const FieldLevel& level = levels_.levels[l];
  const ClassOrder order = orderOfFree<vec2>(level.size(), fixed_[l]);
  std::vector<vec2> best;
  double least = 0;
  for (const bool linear : {true, false}) {
    std::vector<vec2> value(level.size(), vec2(0));
    setFixed<vec2>(fixed_[l], value);
    relax<vec2>({level, order, pulled_[l], !linear, 1}, kFirstSweeps, value, monitor);
    pointSomewhere(value);
    relax<vec2>({level, order, pulled_[l]}, sweepsOf(l), value, monitor);
    const double rough = roughness(level, pulled_[l], value);
    if (best.empty() || rough < least) best = std::move(value), least = rough;
  }
  return best;
}

void SmoothField::fix(std::span<const StrokeMark> marks) {
  fixed_ = fixedLevels(levels_, fixedDirections(points_, marks, foldsOf(options_.symmetry)));
  pulled_ = freeParts(levels_, nodesOf(fixed_.back()));
}

// What the next level found, where there is one.
void SmoothField::enterLevel(std::size_t l, Monitor& monitor) {
  if (l + 1 < levels_.levels.size()) value_[l] = prolong(levels_.levels[l], value_[l + 1], monitor);
}

void SmoothField::relaxLevel(std::size_t l, Monitor& monitor) {
  if (l == 0 && levels_.levels[0].pull.empty()) connectFinest(points_, levels_, monitor);
  std::vector<vec2>& value = value_[l];
  if (l + 1 == levels_.levels.size()) {
    value = coarsest(monitor);
    return;
  }
  const FieldLevel& level = levels_.levels[l];
  setFixed<vec2>(fixed_[l], value);
  relax<vec2>({level, orderOfFree<vec2>(level.size(), fixed_[l]), pulled_[l]}, sweepsOf(l), value,
              monitor);
}

void SmoothField::solveLevel(std::size_t l, Monitor& monitor) {
  enterLevel(l, monitor);
  relaxLevel(l, monitor);
}

void SmoothField::writeFrames(std::span<const StrokeMark> marks, Monitor& monitor) {
  const std::vector<vec2> direction =
      combed({points_, levels_.levels[0].graph, value_[0], foldsOf(options_.symmetry), options_.up},
             marks, monitor);
  field_.frames.resize(points_.size());
  forChunks(monitor, points_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      field_.frames[i] =
          orthonormalFrame(points_.normals[i], tangentDirection(points_.normals[i], direction[i]));
  });
}

void SmoothField::solve(std::span<const StrokeMark> marks, Monitor& monitor) {
  fix(marks);
  for (std::size_t l = levels_.levels.size(); l-- > 0;) solveLevel(l, monitor);
  seen_.clear();
  writeFrames(marks, monitor);
  field_.scale = smoothScales(levels_, marks, monitor);
}

OrientationField SmoothField::solveOnce(std::span<const StrokeMark> marks, Monitor& monitor) && {
  if (haveScales(marks)) {  // they need the levels once more
    solve(marks, monitor);
    return std::move(field_);
  }
  fix(marks);
  for (std::size_t l = levels_.levels.size(); l-- > 0;) {
    FieldLevel& level = levels_.levels[l];
    enterLevel(l, monitor);
    if (l + 1 < levels_.levels.size()) release(value_[l + 1]);
    release(level.parent), release(level.fromParent);
    relaxLevel(l, monitor);
    release(level.turn), release(level.pull);
    if (l > 0) level.graph = PointGraph{};  // that of the points leads the frames
  }
  writeFrames(marks, monitor);
  return std::move(field_);
}

// Of `nodes` those that turned since they were seen last; they count as seen now.
std::vector<Index> SmoothField::turnedSince(std::size_t l, std::span<const Index> nodes,
                                            float cosine) {
  std::vector<Index> out;
  for (const Index i : nodes)
    if (glm::dot(value_[l][i], seen_[l][i]) < cosine) out.push_back(i);
  for (const Index i : out) seen_[l][i] = value_[l][i];
  return out;
}

// Relaxes what lies under `parents` or at `drawn`, and returns the nodes that it looked at.
std::vector<Index> SmoothField::refreshLevel(std::size_t l, std::span<const Index> parents,
                                             std::span<const Index> drawn, Monitor& monitor) {
  const FieldLevel& level = levels_.levels[l];
  std::vector<vec2>& value = value_[l];
  NodeSet active(level.size());
  std::vector<std::uint8_t> turned(levels_.levels[l + 1].size(), 0);
  for (const Index p : parents) turned[p] = 1;
  for (Index i = 0; i < level.size(); ++i)
    if (turned[level.parent[i]]) active.add(i);
  for (const Index i : drawn) {
    active.add(i);
    for (const Index j : level.graph.of(i)) active.add(j);
  }
  for (const Index i : active.ids)
    value[i] = product(level.fromParent[i], value_[l + 1][level.parent[i]]);
  setFixed<vec2>(fixed_[l], value);
  std::size_t done = 0;
  for (int round = 0; round <= kRounds && done < active.ids.size(); ++round) {
    const std::span<const Index> fresh = std::span(active.ids).subspan(done);
    const ClassOrder order = classOrder(freeOf(fresh, fixed_[l]));
    relax<vec2>({level, order, pulled_[l]}, round == 0 ? sweepsOf(l) : kRoundSweeps, value,
                monitor);
    const std::size_t end = active.ids.size();
    for (; done < end; ++done) {
      const Index i = active.ids[done];
      if (glm::dot(value[i], seen_[l][i]) < cosine_)
        for (const Index j : level.graph.of(i)) active.add(j);
    }
  }
  std::sort(active.ids.begin(), active.ids.end());
  return std::move(active.ids);
}

std::vector<Index> SmoothField::update(std::span<const StrokeMark> marks, float degrees,
                                       Monitor& monitor) {
  const std::size_t depth = levels_.levels.size();
  const int folds = foldsOf(options_.symmetry);
  cosine_ = std::cos(static_cast<float>(folds) * degrees * std::numbers::pi_v<float> / 180);
  FixedLevels fixed = fixedLevels(levels_, fixedDirections(points_, marks, folds));
  auto pulled = freeParts(levels_, nodesOf(fixed.back()));
  if (seen_.empty()) seen_ = value_;
  std::swap(fixed_, fixed);
  const bool samePull = pulled == pulled_;
  pulled_ = std::move(pulled);
  std::vector<Index> turned;
  for (std::size_t l = depth; l-- > 0;) {
    const std::size_t n = levels_.levels[l].size();
    std::vector<Index> looked;
    if (!samePull || l + 1 == depth || n <= kSmallLevel) {
      solveLevel(l, monitor);
      looked.resize(n);
      std::iota(looked.begin(), looked.end(), Index{0});
    } else {
      looked = refreshLevel(l, turned, changedNodes(fixed[l], fixed_[l]), monitor);
    }
    turned = turnedSince(l, looked, cosine_);
  }
  for (const Index i : turned) {
    const vec3& n = points_.normals[i];
    const vec2 before = tangentNumber(n, field_.frames[i].t);
    const vec2 now = folds == 1 ? value_[0][i] : nearestRoot(value_[0][i], folds, before);
    field_.frames[i] = orthonormalFrame(n, tangentDirection(n, now));
  }
  field_.scale = smoothScales(levels_, marks, monitor);
  return turned;
}

}  // namespace dapple
