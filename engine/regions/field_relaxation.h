// Sweeps over the nodes of a level that bring each to what its neighbours say.
//
// Nodes are updated in classes, one after the other; inside a class all read what was there before,
// so that the order makes no difference and any number of threads gives the same bytes (methods:
// 3.4, step 3).
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>
#include <vector>

#include "base/hash_rng.h"
#include "regions/field_levels.h"
#include "regions/tangent_numbers.h"

namespace dapple {

// Values of nodes that do not change, ascending by node.
template <class Value>
struct Fixed {
  Index node;
  Value value;
};

// Steps beyond what the neighbours say: long waves settle in a fraction of the sweeps. Only where
// values are brought back to length 1; as members of a class do not see each other's steps, linear
// sweeps could blow up.
inline constexpr float kOverRelaxation = 1.5f;

// Nodes by class.
struct ClassOrder {
  static constexpr std::size_t kClasses = 8;
  std::vector<Index> ids;
  std::array<std::size_t, kClasses + 1> begin{};
};

ClassOrder classOrder(std::span<const Index> nodes);

// What a level is relaxed for. Value: vec2, powers of directions; or float, logarithms of scales.
template <class Value>
struct Relaxation {
  const FieldLevel& level;
  const ClassOrder& order;
  std::span<const std::uint8_t> pulled;  // n_l: nodes that feel the level's pull; empty: none
  bool normalised = true;  // vec2: bring each to length 1; else the mean, which is a linear problem
  float step = kOverRelaxation;  // of the way to what the neighbours say
};

// Calls body(begin, end) over [0, count), without waking other threads for little.
template <class Body>
void forChunks(Monitor& monitor, std::size_t count, const Body& body) {
  constexpr std::size_t kGrain = 4096;
  if (count > kGrain) return parallelFor(monitor, count, kGrain, body);
  monitor.checkpoint();
  if (count > 0) body(std::size_t{0}, count);
}

inline vec2 carried(const vec2& turn, const vec2& direction) {
  return product(turn, direction);
}
inline float carried(const vec2& turn, float scale) {
  return std::sqrt(turn.x * turn.x + turn.y * turn.y) * scale;
}

// What the neighbours of node i say; `before` where they say nothing.
template <class Value>
Value relaxed(const Relaxation<Value>& r, Index i, const std::vector<Value>& values) {
  const FieldLevel& level = r.level;
  Value sum(0);
  for (std::size_t e = level.graph.offset[i]; e < level.graph.offset[i + 1]; ++e)
    sum += carried(level.turn[e], values[level.graph.ids[e]]);
  const bool pulled = !r.pulled.empty() && r.pulled[i];
  if constexpr (std::is_same_v<Value, vec2>) {
    if (pulled) sum += level.pull[i];
    if (r.normalised) {
      const float squared = sum.x * sum.x + sum.y * sum.y;
      if (!(squared > 0)) return values[i];
      const vec2 mean = sum * (1 / std::sqrt(squared));
      return unit(values[i] + r.step * (mean - values[i]));
    }
  }
  float weight = 0;
  for (std::size_t e = level.graph.offset[i]; e < level.graph.offset[i + 1]; ++e)
    weight += carried(level.turn[e], 1.f);
  if (pulled) weight += glm::length(level.pull[i]);
  return weight > 0 ? values[i] + r.step * (sum * (1 / weight) - values[i]) : values[i];
}

// Members of a class lie about eight apart: too far for the processor to foresee the next row.
inline constexpr std::size_t kAhead = 8;
inline void prefetchRow(const FieldLevel& level, Index i) {
  const std::size_t row = level.graph.offset[i];
  __builtin_prefetch(level.graph.ids.data() + row);
  __builtin_prefetch(level.turn.data() + row);
  __builtin_prefetch(level.turn.data() + row + 8);
}

template <class Value>
void relax(const Relaxation<Value>& r, int sweeps, std::vector<Value>& values, Monitor& monitor) {
  std::size_t most = 0;
  for (std::size_t c = 0; c < ClassOrder::kClasses; ++c)
    most = std::max(most, r.order.begin[c + 1] - r.order.begin[c]);
  std::vector<Value> next(most);  // of a class
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t c = 0; c < ClassOrder::kClasses; ++c) {
      const std::size_t first = r.order.begin[c], count = r.order.begin[c + 1] - first;
      forChunks(monitor, count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = first + begin; k < first + end; ++k) {
          prefetchRow(r.level, r.order.ids[std::min(k + kAhead, r.order.ids.size() - 1)]);
          next[k - first] = relaxed(r, r.order.ids[k], values);
        }
      });
      forChunks(monitor, count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) values[r.order.ids[first + k]] = next[k];
      });
    }
}

}  // namespace dapple
