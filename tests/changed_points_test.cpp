// What is left alone when a region is synthesized again after an edit, and what is not.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "base/errors.h"
#include "document/region_field.h"
#include "document_fixtures.h"
#include "fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

constexpr float kLong = 60, kWide = 12;  // of a strip, in spacings of 1/2
constexpr Method kMethods[] = {Method::Hybrid, Method::Patches, Method::Match, Method::Coordinates,
                               Method::Mapping};

// A flat strip with strokes up across it every 6 units.
Document stripDocument(const TestFolder& folder, const TextureOptions& options) {
  const PointSet plane = makePlane(kLong, kWide, 0.5f, 0.6f);
  {
    std::ofstream file(folder / "strip.xyz");
    for (std::size_t i = 0; i < plane.size(); ++i) {
      const vec3 p = plane.positions[i];
      file << fmt::format("{} {} 0 0 0 1 128 128 128\n", p.x, p.y);
    }
  }
  Document d = applied(emptyDocument(), OpenScan{.path = folder / "strip.xyz", .neighbours = 16});
  return applied(applied(d, SetSwatch{.region = 0, .reference = {.path = "noise.png"}}),
                 SetRegion{.region = 0, .options = options});
}

Index nearest(const Document& d, float x, float y) {
  const dvec3 model(x, y, 0);
  const vec3 wanted((model - d.points().origin) / d.points().modelUnits);
  Index best = 0;
  const auto apart = [&](Index i) { return glm::length(d.points().positions[i] - wanted); };
  for (Index i = 1; i < d.size(); ++i)
    if (apart(i) < apart(best)) best = i;
  return best;
}

float along(const Document& d, Index i) {
  return static_cast<float>(d.points().origin.x +
                            d.points().modelUnits * double{d.points().positions[i].x});
}

Document withStroke(const Document& d, vec2 from, vec2 to, std::optional<float> scale = {}) {
  Stroke stroke{.scale = scale};
  for (int s = 0; s <= 6; ++s) {
    const vec2 at = from + (to - from) * (static_cast<float>(s) / 6);
    const Index i = nearest(d, at.x, at.y);
    if (!stroke.points.empty() && stroke.points.back() == i) continue;
    stroke.points.push_back(i);
    stroke.positions.push_back(d.points().positions[i]);
  }
  return applied(d, AddStroke{0, stroke});
}

Document upright(const TestFolder& folder, const TextureOptions& options) {
  Document d = stripDocument(folder, options);
  for (float x = 3; x < kLong; x += 6) d = withStroke(d, {x, 1}, {x, kWide - 1});
  return applied(d, Synthesize{});
}

const Synthesize kAgain{.region = RegionId{0}, .onlyChanged = true};

struct Kept {
  std::size_t left = 0, right = 0;  // points whose texel is as it was, of each half
  std::size_t leftAll = 0, rightAll = 0;
};
Kept keptOf(const Document& before, const Document& after, float border) {
  Kept kept;
  for (Index i = 0; i < before.size(); ++i) {
    const bool same = (*before.results.texel)[i] == (*after.results.texel)[i];
    const bool left = along(before, i) < border;
    (left ? kept.leftAll : kept.rightAll) += 1;
    if (same) (left ? kept.left : kept.right) += 1;
  }
  return kept;
}

// Neighbours whose texels are next to each other, as they are.
double coherence(const Document& d) {
  const float size = 48;
  std::size_t coherent = 0, all = 0;
  for (Index i = 0; i < d.size(); ++i)
    for (const Index j : d.scan->prepared.neighborhoods.of(i).first(6)) {
      vec2 step = (*d.results.texel)[j] - (*d.results.texel)[i];
      step -= size * glm::round(step / size);
      const float apart = glm::length(d.points().positions[j] - d.points().positions[i]);
      coherent += glm::length(step) < 1.5f * apart / d.results.sources[0]->unit + 0.5f ? 1 : 0;
      ++all;
    }
  return static_cast<double>(coherent) / static_cast<double>(all);
}

}  // namespace

TEST_CASE("nothing has changed: every byte stays") {
  const TestFolder folder;
  for (const Method method : kMethods) {
    CAPTURE(static_cast<int>(method));
    const Document done = upright(folder, {.method = method, .neighbours = 16});
    const Document again = applied(done, kAgain);
    CHECK(sameContent(done, again));
  }
}

TEST_CASE("a stroke at one end changes that end alone, and the pattern follows it there") {
  const TestFolder folder;
  for (const Method method : kMethods) {
    CAPTURE(static_cast<int>(method));
    const Document before = upright(folder, {.method = method, .neighbours = 16});
    const Document drawn = withStroke(before, {54, 2}, {59, 10});
    std::size_t worked = 0;
    CommandContext context = testContext();
    context.watch.begins = [&](std::span<const Index> points, std::size_t, std::size_t) {
      worked = points.size();
    };
    const Document after = applied(drawn, kAgain, context);
    CHECK(worked > before.size() / 20);
    CHECK(worked < before.size() / 2);
    const Kept kept = keptOf(before, after, 40);
    CHECK(kept.left == kept.leftAll);
    CHECK(kept.right < kept.rightAll * 9 / 10);
    CHECK(after.results.sources.size() == 1);
    const Index at = nearest(after, 56.5f, 6);
    const vec3 up = (*after.results.frame)[at].t;
    // Clusters may lie up to 8 degrees askew.
    CHECK(glm::dot(up, glm::normalize(vec3(5, 8, 0))) > (method == Method::Mapping ? 0.9f : 0.95f));
    // As whole as one piece.
    const double whole = coherence(applied(drawn, Synthesize{}));
    CHECK(coherence(after) > whole - 0.03);
  }
}

// Points are a swatch pixel apart or less with scale 1, and read filtered texels with 0.3.
TEST_CASE("after an edit all texels still give their colours, at their levels") {
  const TestFolder folder;
  for (const Method method : {Method::Coordinates, Method::Match}) {
    CAPTURE(static_cast<int>(method));
    const Document before = upright(folder, {.method = method, .neighbours = 16, .scale = 0.3});
    REQUIRE(before.results.level);
    const Document after = applied(withStroke(before, {54, 2}, {59, 10}), kAgain);
    REQUIRE(after.results.level);
    const Kept kept = keptOf(before, after, 40);
    CHECK(kept.left > kept.leftAll * 9 / 10);
    CHECK(kept.right < kept.rightAll);
    const Swatch& swatch = *after.results.sources[0]->swatch;
    float worst = 0;
    for (Index i = 0; i < after.size(); ++i) {
      const vec3 off = sampleSwatch(swatch, (*after.results.texel)[i], (*after.results.level)[i]) -
                       (*after.results.colour)[i];
      worst = std::max({worst, std::abs(off.x), std::abs(off.y), std::abs(off.z)});
    }
    CHECK(worst < 1e-4f);
  }
}

TEST_CASE("statistics after an edit are those of all points") {
  const TestFolder folder;
  for (const Method method : {Method::Hybrid, Method::Patches, Method::Match}) {
    CAPTURE(static_cast<int>(method));
    const Document before =
        upright(folder, {.method = method, .neighbours = 16, .repair = 0});  // which ends blends
    const Document after = applied(withStroke(before, {54, 2}, {59, 10}), kAgain);
    const Results& results = after.results;
    std::set<Index> patches(results.patch->begin(), results.patch->end());
    patches.erase(kNone);
    std::size_t matched = 0, laid = 0;
    double distortion = 0;
    for (Index i = 0; i < after.size(); ++i) {
      matched += (*results.state)[i] == PointState::Matched ? 1 : 0;
      if ((*results.state)[i] != PointState::Patch) continue;
      ++laid;
      distortion += double{(*results.error)[i]};
    }
    const SynthesisStatistics& told = results.sources[0]->statistics;
    const auto n = static_cast<double>(after.size());
    CHECK(told.patches == patches.size());
    CHECK(told.matchedShare == doctest::Approx(static_cast<double>(matched) / n));
    if (laid > 0)
      CHECK(told.meanDistortion == doctest::Approx(distortion / static_cast<double>(laid)));
    else
      CHECK(told.meanDistortion == 0);
    // What is blended is told in the order of points, one list for all.
    const ResultSource& source = *results.sources[0];
    CHECK(std::is_sorted(source.blended.begin(), source.blended.end()));
    CHECK(source.blended.empty() == (method != Method::Patches));
    if (!source.blended.empty()) CHECK(source.blendEnd.back() == source.blend.size());
  }
}

TEST_CASE("a stroke's scale changes where it counts") {
  const TestFolder folder;
  for (const Method method : kMethods) {
    CAPTURE(static_cast<int>(method));
    const Document before = upright(folder, {.method = method, .neighbours = 16});
    const Document after = applied(withStroke(before, {55, 1}, {55, 11}, 2.f), kAgain);
    const Kept kept = keptOf(before, after, 40);
    CHECK(kept.left == kept.leftAll);
    REQUIRE(after.results.scale);
    CHECK((*after.results.scale)[nearest(after, 55, 6)] == doctest::Approx(2).epsilon(0.05));
    CHECK((*after.results.scale)[nearest(after, 5, 6)] == doctest::Approx(1).epsilon(0.05));
  }
}

TEST_CASE("other options synthesize all of a region, and so does asking for it") {
  const TestFolder folder;
  const Document before = upright(folder, {.method = Method::Hybrid, .neighbours = 16});
  const Document changed = applied(
      before,
      SetRegion{.region = 0,
                .options = TextureOptions{.method = Method::Hybrid, .neighbours = 16, .seed = 5}});
  CHECK(*applied(changed, kAgain).results.texel == *applied(changed, Synthesize{}).results.texel);
  const Document drawn = withStroke(before, {54, 2}, {59, 10});
  CHECK(*applied(drawn, Synthesize{}).results.texel != *applied(drawn, kAgain).results.texel);
}

TEST_CASE("points that a region gains are synthesized, those that it had stay") {
  const TestFolder folder;
  Document d = upright(folder, {.method = Method::Hybrid, .neighbours = 16});
  std::vector<Index> left, more;
  for (Index i = 0; i < d.size(); ++i) {
    if (along(d, i) < 40) left.push_back(i);
    if (along(d, i) < 44) more.push_back(i);
  }
  d = applied(applied(d, Select{.points = left}), AddRegion{});
  d = applied(d, SetSwatch{.region = 1, .reference = {.path = "bricks.png"}});
  for (float x = 3; x < 40; x += 6) {
    const Stroke stroke = (*findRegion(d, 0)->strokes)[static_cast<std::size_t>(x / 6)];
    d = applied(d, AddStroke{1, stroke});
  }
  d = applied(d, Synthesize{.region = 1});
  const Document grown = applied(applied(d, Select{.points = more}), AssignSelection{.region = 1});
  const Document after = applied(grown, Synthesize{.region = 1, .onlyChanged = true});
  const Kept kept = keptOf(d, after, 36);
  CHECK(kept.left == kept.leftAll);
  for (const Index i : more) CHECK((*after.results.source)[i] == (*after.results.source)[more[0]]);
}

TEST_CASE("a field that is kept from edit to edit is what it would be anew, or next to it") {
  const TestFolder folder;
  const Document before = upright(folder, {.method = Method::Hybrid, .neighbours = 16});
  const Document drawn = withStroke(before, {54, 2}, {59, 10});
  Workers workers(1);
  Monitor monitor(workers);
  using Bytes = RegionField::Bytes;
  RegionField kept(before, *findRegion(before, 0), monitor);
  CHECK(kept.fits(drawn, *findRegion(drawn, 0)));
  Region other = *findRegion(drawn, 0);
  other.options.symmetry = FieldSymmetry::Half;
  CHECK_FALSE(kept.fits(drawn, other));
  const auto anew = [&](const Document& d) {
    const Region& region = *findRegion(d, 0);
    const RegionPoints part(d, region, monitor);
    return fieldOf(part, region, part.strokes(region), monitor);
  };
  const auto largestTurn = [&](const OrientationField& a, const OrientationField& b) {
    float least = 1;
    for (std::size_t i = 0; i < a.frames.size(); ++i)
      least = std::min(least, glm::dot(a.frames[i].t, b.frames[i].t));
    return std::acos(std::min(least, 1.f)) * 180 / 3.14159265f;
  };
  const auto same = [](const OrientationField& a, const OrientationField& b) {
    bool equal = a.scale == b.scale && a.frames.size() == b.frames.size();
    for (std::size_t i = 0; equal && i < a.frames.size(); ++i)
      equal = a.frames[i].t == b.frames[i].t && a.frames[i].s == b.frames[i].s;
    return equal;
  };
  CHECK(same(kept.field(*findRegion(before, 0), Bytes::Near, monitor), anew(before)));
  const OrientationField wanted = anew(drawn);
  CHECK(largestTurn(kept.field(*findRegion(drawn, 0), Bytes::Near, monitor), wanted) < 3);
  CHECK(same(kept.field(*findRegion(drawn, 0), Bytes::Exact, monitor), wanted));
  Region turned = *findRegion(drawn, 0);
  turned.rotation = 30;
  const OrientationField& after = kept.field(turned, Bytes::Near, monitor);
  CHECK(glm::dot(after.frames[7].t, wanted.frames[7].t) ==
        doctest::Approx(std::cos(30 * 3.14159265 / 180)).epsilon(0.001));
}
