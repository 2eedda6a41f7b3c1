#include "synthesis/pattern_cut.h"

#include <doctest/doctest.h>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

using Pattern = vec3 (*)(vec3 position, std::uint64_t seed);

vec3 grain(vec3 p, std::uint64_t seed) {
  const auto x = static_cast<std::uint64_t>(p.x * 2), y = static_cast<std::uint64_t>(p.y * 2);
  return {hashUniform(seed, x, y), hashUniform(seed, x, y, 1), hashUniform(seed, x, y, 2)};
}

// White discs around whole tens on black.
vec3 discs(vec3 p, std::uint64_t) {
  const vec2 d = vec2(p) - 10.f * glm::round(vec2(p) / 10.f);
  return vec3(glm::length(d) < 4 ? 1.f : 0.f);
}

vec3 grey(vec3, std::uint64_t) {
  return vec3(0.5f);
}

// A plane in vertical parts, each with a pattern; those of its neighbours reach `reach` into it.
struct Parts {
  Parts(const std::vector<Pattern>& patterns, float width, float reach, std::uint64_t seed)
      : points(makePlane(width, 40, 1)), near(neighbourhoods(points)) {
    const float each = width / static_cast<float>(patterns.size());
    for (Index i = 0; i < points.size(); ++i) {
      const vec3 p = points.positions[i];
      const auto part = std::min(static_cast<std::size_t>(p.x / each), patterns.size() - 1);
      own.push_back(static_cast<std::uint16_t>(part));
      colour.push_back(patterns[part](p, seed + part));
      for (std::size_t q = 0; q < patterns.size(); ++q) {
        const float left = each * static_cast<float>(q), right = left + each;
        if (q != part && p.x > left - reach && p.x < right + reach)
          options.push_back({i, static_cast<std::uint16_t>(q), patterns[q](p, seed + q)});
      }
    }
  }

  PatternCutInput input() const { return {points, near, own, colour, options}; }
  std::vector<bool> none() const { return std::vector<bool>(options.size(), false); }

  PatternCut cut() const {
    Workers workers;
    Monitor monitor(workers);
    return cutPatterns(input(), monitor);
  }
  double energy(const std::vector<bool>& taken) const {
    Workers workers;
    Monitor monitor(workers);
    return patternSeams(input(), taken, monitor);
  }

  PointSet points;
  Neighborhoods near;
  std::vector<std::uint16_t> own;
  std::vector<vec3> colour;
  std::vector<PatternOption> options;
};

}  // namespace

TEST_CASE("a cut border costs no more than a hard one, whatever the patterns") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Parts parts({grain, seed % 2 ? grain : discs}, 40, 1 + static_cast<float>(seed % 8),
                      seed);
    const PatternCut made = parts.cut();
    CHECK(made.energyBefore == parts.energy(parts.none()));
    CHECK(made.energyAfter == parts.energy(made.taken));
    CHECK(made.energyAfter <= made.energyBefore);
    if (seed % 8 > 4) CHECK(made.energyAfter < 0.8 * made.energyBefore);
  }
}

TEST_CASE("no change of a few points makes the border between two patterns cheaper") {
  const Parts parts({grain, discs}, 40, 6, 5);
  const PatternCut made = parts.cut();
  for (std::uint64_t turn = 0; turn < 200; ++turn) {
    std::vector<bool> other = made.taken;
    const std::size_t at = hashBelow(other.size(), 3, turn);
    const vec3 centre = parts.points.positions[parts.options[at].point];
    const bool to = !other[at];
    for (std::size_t o = 0; o < other.size(); ++o)
      if (glm::distance(parts.points.positions[parts.options[o].point], centre) <
          static_cast<float>(turn % 5))
        other[o] = to;
    other[at] = to;
    // But for the least that a point costs which is not its own.
    CHECK(parts.energy(other) >= made.energyAfter - 0.1);
  }
}

TEST_CASE("a border runs around the features of a pattern, not through them") {
  // The border x = 20 runs through the middles of discs. It may not cross the half of one.
  const Parts parts({discs, grey}, 40, 8, 1);
  const PatternCut made = parts.cut();
  std::vector<std::uint16_t> shown = parts.own;
  for (std::size_t o = 0; o < parts.options.size(); ++o)
    if (made.taken[o]) shown[parts.options[o].point] = parts.options[o].pattern;
  for (float y = 10; y < 35; y += 10) {
    std::size_t whole = 0, all = 0;
    for (Index i = 0; i < parts.points.size(); ++i) {
      const vec2 d = vec2(parts.points.positions[i]) - vec2(20, y);
      if (glm::length(d) > 3.5f) continue;
      ++all;
      whole += shown[i] == 0 ? 1 : 0;
    }
    CHECK((whole == 0 || whole == all));
  }
  CHECK(made.energyAfter < 0.75 * made.energyBefore);
}

TEST_CASE("patterns that look alike cost nothing and stay where they are") {
  const Parts parts({discs, discs}, 40, 6, 1);
  const PatternCut made = parts.cut();
  CHECK(made.energyBefore == 0);
  CHECK(made.energyAfter == 0);
  CHECK(made.taken == parts.none());
}

TEST_CASE("where three patterns meet each point shows one of them") {
  const Parts parts({grain, discs, grain}, 36, 8, 2);  // the outer ones meet in the middle
  const PatternCut made = parts.cut();
  CHECK(made.energyAfter < made.energyBefore);
  std::size_t far = 0;
  std::vector<int> count(parts.points.size(), 0);
  for (std::size_t o = 0; o < parts.options.size(); ++o) {
    if (!made.taken[o]) continue;
    CHECK(++count[parts.options[o].point] == 1);
    far += parts.options[o].pattern != 1 ? 1 : 0;
  }
  CHECK(far > 20);
}

TEST_CASE("points that take no part neither cost nor change") {
  Parts parts({grain, grain}, 40, 6, 3);
  const PatternCut all = parts.cut();
  for (Index i = 0; i < parts.points.size(); ++i)
    if (parts.points.positions[i].y < 20) parts.own[i] = kNoPattern;
  std::erase_if(parts.options,
                [&](const PatternOption& o) { return parts.own[o.point] == kNoPattern; });
  const PatternCut upper = parts.cut();
  CHECK(upper.energyBefore < 0.6 * all.energyBefore);
  CHECK(upper.energyAfter < upper.energyBefore);
  parts.options.clear();
  CHECK(parts.cut().taken.empty());
}

TEST_CASE("a cut of patterns is stopped by a monitor") {
  const Parts parts({grain, discs}, 40, 6, 1);
  std::stop_source stop;
  stop.request_stop();
  Workers workers;
  Monitor stopped(workers, stop.get_token());
  CHECK_THROWS_AS(cutPatterns(parts.input(), stopped), Cancelled);
}
