// Methods, section 9, item 10. Departures: the coarsest level does not start at random, which
// leaves dislocations all over that no sweep ever removes, but is grown from one site, so that what
// can be exact is; and both axes choose among the starts by themselves, as they do not depend on
// each other.
#include "synthesis/phase_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "regions/field_relaxation.h"

namespace dapple {
namespace {

constexpr std::size_t kLinks = 10;  // nearest neighbours of a site that take part
constexpr float kStepsPerSwatch = 6;
// Of each start of the coarsest level: what does not close around the surface has to spread along
// all of the way.
constexpr int kLeastSweeps = 20, kMostSweeps = 120;
constexpr double kSweepsPerSide = 2;  // of a square of as many sites

int sweepsOf(std::size_t level) {
  return level == 0 ? 3 : level == 1 ? 6 : 12;
}

vec2 phaseOf(float turns) {
  const float angle = 2 * std::numbers::pi_v<float> * (turns - std::floor(turns));
  return {std::cos(angle), std::sin(angle)};
}

// Of the phase, 0..1.
float turnsOf(const vec2& phase) {
  const float turns = std::atan2(phase.y, phase.x) * (0.5f / std::numbers::pi_v<float>);
  return turns < 0 ? turns + 1 : turns;
}

// Sites from one to the next along links, each part of the surface from where it is first met.
std::vector<Index> growthOrder(const PointGraph& graph, Index seed) {
  std::vector<Index> order;
  order.reserve(graph.size());
  std::vector<std::uint8_t> met(graph.size(), 0);
  const auto meet = [&](Index i) {
    if (met[i]) return;
    met[i] = 1;
    order.push_back(i);
  };
  meet(seed);
  Index next = 0;
  for (std::size_t at = 0; at < graph.size(); ++at) {
    while (at == order.size()) meet(next++);
    for (const Index j : graph.of(order[at])) meet(j);
  }
  return order;
}

// Each site as those before it say; the first of a part as it is.
std::vector<vec2> grown(const FieldLevel& level, Index seed, float turns) {
  const std::size_t n = level.size();
  std::vector<vec2> sum(n, vec2(0)), phase(n, vec2(0));
  for (const Index i : growthOrder(level.graph, seed)) {
    for (std::size_t e = level.graph.offset[i]; e < level.graph.offset[i + 1]; ++e)
      sum[i] += product(level.turn[e], phase[level.graph.ids[e]]);
    phase[i] = unit(sum[i]);
    if (phase[i] == vec2(0)) phase[i] = phaseOf(turns);
    // Links need not be mutual.
    for (std::size_t e = level.graph.offset[i]; e < level.graph.offset[i + 1]; ++e)
      sum[level.graph.ids[e]] += product(conjugate(level.turn[e]), phase[i]);
  }
  return phase;
}

// How much neighbours differ, up to a constant of the level.
double roughness(const FieldLevel& level, const std::vector<vec2>& phase) {
  double sum = 0;
  for (std::size_t i = 0; i < level.size(); ++i)
    for (std::size_t e = level.graph.offset[i]; e < level.graph.offset[i + 1]; ++e)
      sum -= glm::dot(phase[i], product(level.turn[e], phase[level.graph.ids[e]]));
  return sum;
}

std::vector<vec2> smoothestStart(const FieldLevel& level, const ClassOrder& order,
                                 const PhaseOptions& options, int axis, Monitor& monitor) {
  const int sweeps = static_cast<int>(std::clamp<double>(
      kSweepsPerSide * std::sqrt(static_cast<double>(level.size())), kLeastSweeps, kMostSweeps));
  std::vector<vec2> best;
  double least = 0;
  for (std::uint64_t start = 0; start < static_cast<std::uint64_t>(options.starts); ++start) {
    const auto seed = static_cast<Index>(hashBelow(level.size(), options.seed, start, 21));
    const auto salt = static_cast<std::uint64_t>(axis);
    std::vector<vec2> phase = grown(level, seed, hashUniform(options.seed, start, 22, salt));
    relax<vec2>({level, order, {}}, sweeps, phase, monitor);
    const double rough = roughness(level, phase);
    if (best.empty() || rough < least) best = std::move(phase), least = rough;
  }
  return best;
}

// The part of `way` that is left when whole periods do not count.
float withoutPeriods(float way, float period) {
  return way - period * std::round(way / period);
}

float sizeAlong(const Swatch& swatch, int axis) {
  return static_cast<float>(axis == 0 ? swatch.width : swatch.height);
}

}  // namespace

int phaseLevels(const Swatch& swatch) {
  const float most = static_cast<float>(std::min(swatch.width, swatch.height)) / kStepsPerSwatch;
  return 1 + std::max(0, static_cast<int>(std::floor(std::log2(most))));
}

PhaseField::PhaseField(const SynthesisInput& input, std::span<const SurfaceLevel> surface,
                       const PhaseOptions& options)
    : in_(input), surface_(surface), options_(options), ways_(input) {
  DAPPLE_CHECK(options.starts, >=, 1);
}

void PhaseField::link(std::size_t l, Monitor& monitor) {
  const Neighborhoods& near = nearOf(surface_[l], in_);
  const std::size_t n = near.size();
  links_.ids.resize(n * kLinks);
  links_.pixels.assign(n * kLinks, vec2(0));
  links_.length.assign(n, 0);
  links_.cut.assign(n, 0);
  forChunks(monitor, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::size_t count = 0, seen = 0;
      for (const Index j : near.of(i)) {
        const auto way = ways_.between(pointAt(surface_[l], i), pointAt(surface_[l], j));
        if (!way.seen) continue;
        const float squared = glm::dot(way.pixels, way.pixels);
        links_.length[i] += squared;
        if (way.quarters != 0) {
          links_.cut[i] += squared;
        } else {
          links_.ids[i * kLinks + count] = j;
          links_.pixels[i * kLinks + count++] = way.pixels;
        }
        if (++seen == kLinks) break;
      }
      for (; count < kLinks; ++count) links_.ids[i * kLinks + count] = static_cast<Index>(i);
    }
  });
}

// Phases of level l from those of the next.
void PhaseField::prolong(std::size_t l, Monitor& monitor) {
  const SurfaceLevel &fine = surface_[l], &above = surface_[l + 1];
  std::vector<vec2> out[2];
  for (auto& phase : out) phase.resize(fine.parent.size());
  forChunks(monitor, fine.parent.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index parent = fine.parent[i];
      const Index from = pointAt(above, parent), to = pointAt(fine, i);
      const vec2 way = from == to ? vec2(0) : ways_.between(from, to).pixels;
      for (int axis = 0; axis < 2; ++axis)
        out[axis][i] =
            product(phaseOf(way[axis] / sizeAlong(in_.swatch, axis)), phase_[axis][parent]);
    }
  });
  for (int axis = 0; axis < 2; ++axis) phase_[axis] = std::move(out[axis]);
}

void PhaseField::solve(std::size_t l, Monitor& monitor) {
  const bool first = l + 1 == surface_.size();
  if (!first) prolong(l, monitor);
  link(l, monitor);
  const std::size_t n = links_.length.size();
  FieldLevel level;
  level.graph.offset.resize(n + 1);
  for (std::size_t i = 0; i <= n; ++i) level.graph.offset[i] = i * kLinks;
  level.graph.ids.swap(links_.ids);
  level.turn.resize(n * kLinks);
  std::vector<Index> all(n);
  std::iota(all.begin(), all.end(), Index{0});
  const ClassOrder order = classOrder(all);
  for (int axis = 0; axis < 2; ++axis) {
    const float size = sizeAlong(in_.swatch, axis);
    forChunks(monitor, n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t e = i * kLinks; e < (i + 1) * kLinks; ++e)
          level.turn[e] =
              level.graph.ids[e] == i ? vec2(0) : phaseOf(-links_.pixels[e][axis] / size);
    });
    if (first) phase_[axis] = smoothestStart(level, order, options_, axis, monitor);
    relax<vec2>({level, order, {}}, sweepsOf(l), phase_[axis], monitor);
  }
  level.graph.ids.swap(links_.ids);
}

std::vector<vec2> PhaseField::texels(Monitor& monitor) const {
  std::vector<vec2> out(phase_[0].size());
  forChunks(monitor, out.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      out[i] = wrapTexel(in_.swatch, {turnsOf(phase_[0][i]) * sizeAlong(in_.swatch, 0),
                                      turnsOf(phase_[1][i]) * sizeAlong(in_.swatch, 1)});
  });
  return out;
}

std::vector<float> PhaseField::residuals(Monitor& monitor) const {
  const std::vector<vec2> texel = texels(monitor);
  std::vector<float> out(texel.size(), 0.f);
  forChunks(monitor, out.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      float sum = links_.cut[i];
      for (std::size_t e = i * kLinks; e < (i + 1) * kLinks; ++e)
        for (int axis = 0; axis < 2; ++axis) {
          const float off =
              withoutPeriods(texel[links_.ids[e]][axis] - texel[i][axis] - links_.pixels[e][axis],
                             sizeAlong(in_.swatch, axis));
          sum += off * off;
        }
      if (links_.length[i] > 0) out[i] = std::sqrt(sum / links_.length[i]);
    }
  });
  return out;
}

}  // namespace dapple
