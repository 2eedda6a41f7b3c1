#include "document/border_blend.h"

#include <doctest/doctest.h>

#include <set>

#include "base/errors.h"
#include "document_fixtures.h"
#include "regions/segmentation.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

// Reads the swatch as it is: others may filter it, so that no texel has a point's colour.
const TextureOptions kUnfiltered{.method = Method::Hybrid};

// A sphere in two halves of different swatches, synthesized; the borders are `width` wide.
Document halves(const TestFolder& folder, double width, std::size_t count = 6000,
                const char* left = "bricks", const char* right = "noise") {
  Document d = sphereDocument(folder, count);
  d = applied(d, Select{.points = half(d, true)});
  d = applied(d, AddRegion{});
  d = applied(d, SetSwatch{.region = 1, .reference = {.path = "/swatches/" + std::string(left)}});
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = "/swatches/" + std::string(right)}});
  for (const RegionId r : {0, 1})
    d = applied(d, SetRegion{.region = r, .borderWidth = width, .options = kUnfiltered});
  return applied(d, Synthesize{});
}

// In thirds about the z axis.
Document thirds(const TestFolder& folder, double width) {
  Document d = sphereDocument(folder, 6000);
  const char* swatches[] = {"noise", "bricks", "stripes"};
  for (int part = 1; part < 3; ++part) {
    std::vector<Index> points;
    for (Index i = 0; i < d.size(); ++i) {
      const vec3 p = d.points().positions[i];
      const double turn = std::atan2(p.y, p.x) / 6.2831853 + 0.5;
      if (static_cast<int>(turn * 3) == part) points.push_back(i);
    }
    d = applied(d, Select{.points = points});
    d = applied(d, AddRegion{});
  }
  for (RegionId r = 0; r < 3; ++r) {
    d = applied(
        d, SetSwatch{.region = r, .reference = {.path = "/swatches/" + std::string(swatches[r])}});
    d = applied(d, SetRegion{.region = r, .borderWidth = width, .options = kUnfiltered});
  }
  return applied(d, Synthesize{});
}

// Mean spacings from each point to the nearest of the other label (infinite from 40 on).
std::vector<float> distanceToOther(const Document& d) {
  const PreparedScan& scan = d.scan->prepared;
  std::vector<float> out(d.size());
  for (const RegionId r : {0, 1}) {
    const std::vector<float> from = [&] {
      Workers workers;
      Monitor monitor(workers);
      return surfaceDistances({d.points(), scan.neighborhoods}, pointsOf(d, r), 40 * scan.spacing,
                              monitor);
    }();
    for (const Index i : pointsOf(d, static_cast<RegionId>(1 - r))) out[i] = from[i] / scan.spacing;
  }
  return out;
}

float otherWeight(const Document& d, Index i) {
  float sum = 0;
  if (const auto b = d.results.border ? d.results.border->find(i) : std::nullopt)
    for (const BorderTerm& term : d.results.border->termsOf(*b)) sum += term.weight;
  return sum;
}

// The largest difference of a colour channel between the colours shown and the terms' mix, over
// points near borders: of their own colour the one that was kept counts.
float worstRebuilt(const Document& d) {
  const Results& r = d.results;
  float worst = 0;
  std::vector<SourceTerm> terms;
  for (Index i = 0; i < d.size(); ++i) {
    gatherTerms(r, i, terms);
    float sum = 0;
    vec3 colour(0);
    for (const SourceTerm& term : terms) {
      sum += term.weight;
      colour += term.weight * sampleSwatch(*r.sources[term.source]->swatch, term.texel);
    }
    CHECK(std::abs(sum - 1) < 1e-5f);
    const vec3 d3 = glm::abs(colour - (*r.colour)[i]);
    worst = std::max({worst, d3.x, d3.y, d3.z});
  }
  return worst;
}

Document undone(const Document& d) {
  Document out = d;
  for (const Region& region : *d.regions)
    out = applied(out, SetRegion{.region = region.id, .borderWidth = 0});
  return applied(out, BlendBorders{});
}

}  // namespace

TEST_CASE("a border without width leaves the results byte for byte as without borders") {
  const TestFolder folder;
  const Document hard = halves(folder, 0), soft = halves(folder, 8);
  CHECK(!hard.results.border);
  REQUIRE(soft.results.border);
  const Document again = undone(soft);
  CHECK(!again.results.border);
  CHECK(*again.results.colour == *hard.results.colour);
  // A blended border changes nothing but colours.
  CHECK(*soft.results.texel == *hard.results.texel);
  CHECK(*soft.results.source == *hard.results.source);
  CHECK(*soft.results.patch == *hard.results.patch);
  CHECK(*soft.results.order == *hard.results.order);
}

TEST_CASE("the weight of the other side falls smoothly from a half on the border to none") {
  const TestFolder folder;
  const Document d = halves(folder, 10);
  const std::vector<float> distance = distanceToOther(d);
  const Document hard = undone(d);
  std::size_t near = 0;
  for (Index i = 0; i < d.size(); ++i) {
    const float weight = otherWeight(d, i), depth = distance[i] - 0.5f;
    CHECK(weight <= 0.5001f);
    if (depth > 5) {
      CHECK(weight == 0);
      CHECK((*d.results.colour)[i] == (*hard.results.colour)[i]);
      continue;
    }
    ++near;
    const float t = std::max(0.f, depth) / 10 + 0.5f;
    CHECK(std::abs(weight - (1 - t * t * (3 - 2 * t))) < 0.002f);
  }
  CHECK(near > 400);
  CHECK(d.results.border->points.size() <= near);
  CHECK(d.results.border->points.size() > near * 9 / 10);
}

TEST_CASE("the terms of a point give its colour again, at borders and in blended gaps") {
  const TestFolder folder;
  for (const Document& d : {halves(folder, 8), thirds(folder, 8)}) {
    CHECK(worstRebuilt(d) < 0.002f);
    const BorderMix& border = *d.results.border;
    for (std::size_t b = 0; b < border.points.size(); ++b) {
      const RegionId own = (*d.labels)[border.points[b]];
      for (const BorderTerm& term : border.termsOf(b)) {
        CHECK(d.results.sources[term.source]->region != own);
        CHECK(std::abs(glm::length(term.up) - 1) < 1e-4f);
        CHECK(std::abs(glm::dot(term.up, d.points().normals[border.points[b]])) < 1e-4f);
      }
    }
  }
}

TEST_CASE("a pattern runs on over its border as it would have run on inside") {
  // Both sides have the same stripes, upright: across the border the other side's stripes are those
  // that its own points show, so that mixing them with themselves changes little.
  const TestFolder folder;
  const Document d = halves(folder, 12, 6000, "stripes", "stripes");
  const Results& r = d.results;
  // Neighbouring terms of one source lie as far apart in the swatch as on the surface.
  const BorderMix& border = *r.border;
  const float unit = r.sources[0]->unit;
  std::size_t pairs = 0, alike = 0;
  for (std::size_t b = 0; b < border.points.size(); ++b) {
    const Index i = border.points[b];
    const BorderTerm& term = border.termsOf(b)[0];
    for (const Index j : d.scan->prepared.neighborhoods.of(i).first(6)) {
      const auto other = border.find(j);
      if (!other || border.termsOf(*other)[0].source != term.source) continue;
      const vec3 way = d.points().positions[j] - d.points().positions[i];
      const vec3 right = glm::cross(term.up, d.points().normals[i]);
      const vec2 expected = vec2(glm::dot(way, right), -glm::dot(way, term.up)) / unit;
      vec2 step = border.termsOf(*other)[0].texel - term.texel;
      step -= 48.f * glm::round((step - expected) / 48.f);
      ++pairs;
      alike += glm::length(step - expected) < 0.6f ? 1 : 0;
    }
  }
  CHECK(pairs > 1000);
  CHECK(alike > pairs * 85 / 100);
}

TEST_CASE("where three regions meet the weights of all sum to one") {
  const TestFolder folder;
  const Document d = thirds(folder, 10);
  std::set<std::size_t> counts;
  for (std::size_t b = 0; b < d.results.border->points.size(); ++b) {
    float sum = 0;
    for (const BorderTerm& term : d.results.border->termsOf(b)) sum += term.weight;
    CHECK(sum > 0);
    CHECK(sum < 0.7f);
    counts.insert(d.results.border->termsOf(b).size());
  }
  CHECK(counts == std::set<std::size_t>{1, 2});
}

TEST_CASE("the points of a locked region stay, and its pattern runs out in the neighbour") {
  const TestFolder folder;
  Document d = halves(folder, 0);
  const std::vector<vec3> before = *d.results.colour;
  d = applied(d, SetRegion{.region = 1, .locked = true});
  d = applied(d, SetRegion{.region = 0, .borderWidth = 8});
  d = applied(d, BlendBorders{});
  const std::vector<float> distance = distanceToOther(d);
  float most = 0;
  for (Index i = 0; i < d.size(); ++i) {
    if ((*d.labels)[i] == 1) CHECK((*d.results.colour)[i] == before[i]);
    if ((*d.labels)[i] == 1) CHECK(otherWeight(d, i) == 0);
    if ((*d.labels)[i] == 0 && distance[i] > 8.5f) CHECK(otherWeight(d, i) == 0);
    most = std::max(most, otherWeight(d, i));
  }
  CHECK(most > 0.95f);
  // Mixed colours of a region that is locked later stay as well.
  Document mixed = halves(folder, 8);
  const std::vector<vec3> shown = *mixed.results.colour;
  mixed = applied(mixed, SetRegion{.region = 1, .locked = true});
  TextureOptions options;
  options.seed = 9;
  mixed = applied(mixed, SetRegion{.region = 0, .options = options});
  mixed = applied(mixed, Synthesize{.region = 0});
  std::size_t changed = 0;
  for (Index i = 0; i < d.size(); ++i)
    if ((*mixed.labels)[i] == 1)
      CHECK((*mixed.results.colour)[i] == shown[i]);
    else
      changed += (*mixed.results.colour)[i] != shown[i] ? 1 : 0;
  CHECK(changed > 1000);
  CHECK(worstRebuilt(mixed) < 0.002f);
  CHECK(mixed.results.sources.size() == 3);  // the old one still colours the locked border
}

TEST_CASE("synthesizing one region brings the borders of its neighbours up to date") {
  const TestFolder folder;
  Document d = halves(folder, 8);
  TextureOptions options;
  options.seed = 5;
  d = applied(d, SetRegion{.region = 0, .options = options});
  const Document one = applied(d, Synthesize{.region = 0}), all = applied(d, Synthesize{});
  CHECK(*one.results.colour == *all.results.colour);
  CHECK(one.results.border->points == all.results.border->points);
  CHECK(one.results.sources.size() == 2);
}

TEST_CASE("cleared and stopped regions give nothing to borders") {
  const TestFolder folder;
  const Document d = halves(folder, 8);
  const Document cleared = applied(d, ClearResult{.region = 1});
  const Document hard = undone(d);
  CHECK(!cleared.results.border);
  CHECK(cleared.results.sources.size() == 1);
  for (const Index i : pointsOf(d, 0))
    CHECK((*cleared.results.colour)[i] == (*hard.results.colour)[i]);
  const Document three = thirds(folder, 8);
  const Document two = applied(three, ClearResult{.region = 2});
  const Document made = applied(two, BlendBorders{});
  REQUIRE(two.results.border);
  CHECK(two.results.border->points == made.results.border->points);
  float worst = 0;
  for (Index i = 0; i < two.size(); ++i) {
    const vec3 by = glm::abs((*two.results.colour)[i] - (*made.results.colour)[i]);
    worst = std::max({worst, by.x, by.y, by.z});
  }
  CHECK(worst < 0.03f);
  CHECK(!applied(d, ClearResult{}).results.border);
}

TEST_CASE("regions of few points and of every method blend with their neighbours") {
  const TestFolder folder;
  for (const Method method :
       {Method::Hybrid, Method::Patches, Method::Match, Method::Grid, Method::Mapping,
        Method::Coordinates, Method::Triplanar, Method::Random}) {
    Document d = sphereDocument(folder, 2000);
    d = applied(d, Select{.points = {0, 1, 2, 3, 4}});
    d = applied(d, AddRegion{});
    d = applied(d, Select{.points = half(d, true)});
    d = applied(d, AddRegion{});
    TextureOptions options;
    options.method = method;
    for (const RegionId r : {0, 1, 2}) {
      d = applied(d, SetSwatch{.region = r, .reference = {.path = r == 0 ? "noise" : "bricks"}});
      d = applied(d, SetRegion{.region = r, .borderWidth = 4, .options = options});
    }
    d = applied(d, Synthesize{});
    REQUIRE(d.results.border);
    CHECK(d.results.border->points.size() > 100);
    for (const vec3& c : *d.results.colour)
      CHECK((c.x >= -1e-4f && c.x <= 1.0001f && std::isfinite(c.x + c.y + c.z)));
  }
}

TEST_CASE("borders are the same at any number of threads, and are stopped by a monitor") {
  const TestFolder folder;
  const Document d = halves(folder, 8);
  for (const unsigned threads : {1u, 2u, 3u}) {
    Workers workers(threads);
    Monitor monitor(workers);
    Document again = d;
    again.results = blendBorders(d, monitor);
    CHECK(sameContent(again, d));
  }
  std::stop_source stop;
  stop.request_stop();
  Workers workers;
  Monitor stopped(workers, stop.get_token());
  CHECK_THROWS_AS(blendBorders(d, stopped), Cancelled);
}

TEST_CASE("a stop that keeps what is done blends it with its neighbours") {
  const TestFolder folder;
  Document d = halves(folder, 8);
  TextureOptions options;
  options.seed = 3;
  d = applied(d, SetRegion{.region = 0, .options = options});
  std::stop_source stop;
  CommandContext context = testContext();
  context.watch.keepsDone = [] { return true; };
  context.watch.ends = [&](const SourceMap&) { stop.request_stop(); };  // done, borders not
  Workers workers;
  Monitor monitor(workers, stop.get_token());
  const Document kept = apply(d, Synthesize{.region = 0}, context, monitor);
  CHECK(*kept.results.colour == *applied(d, Synthesize{.region = 0}).results.colour);
  context.watch.keepsDone = [] { return false; };
  Monitor again(workers, stop.get_token());
  CHECK_THROWS_AS(apply(d, Synthesize{.region = 0}, context, again), Cancelled);
}

TEST_CASE("a region that is locked while its neighbour is synthesized keeps its colours") {
  const TestFolder folder;
  Document d = halves(folder, 8);
  TextureOptions options;
  options.seed = 3;
  d = applied(d, SetRegion{.region = 0, .options = options});
  Workers workers;
  Monitor monitor(workers);
  const Change change = compute(d, Synthesize{.region = 0}, testContext(), monitor);
  const Document locked = applied(d, SetRegion{.region = 1, .locked = true});
  const Document after = change(locked), free = change(d);
  std::size_t changed = 0;
  for (const Index i : pointsOf(d, 1)) {
    CHECK((*after.results.colour)[i] == (*d.results.colour)[i]);
    changed += (*free.results.colour)[i] != (*d.results.colour)[i] ? 1 : 0;
  }
  CHECK(changed > 50);
}

TEST_CASE("a project keeps its borders, and one without any is read as before") {
  const TestFolder folder;
  for (const Document& d : {thirds(folder, 8), halves(folder, 0)}) {
    applied(d, SaveProject{.path = folder / "a.dapple"});
    const Document again = applied(emptyDocument(), OpenProject{.path = folder / "a.dapple"});
    CHECK(sameContent(again, d));
    CHECK(!again.results.border == !d.results.border);
    CHECK(*applied(again, BlendBorders{}).results.colour == *d.results.colour);
  }
}

TEST_CASE("borders of regions whose swatch is not at hand stay as they are") {
  const TestFolder folder;
  const Document d = halves(folder, 8);
  applied(d, SaveProject{.path = folder / "a.dapple"});
  CommandContext context = testContext();
  context.readImage = [](const std::filesystem::path& path) {
    if (path.stem() == "bricks") throw IoError(path.string(), "", "gone", "Put it back.");
    return imageNamed(path);
  };
  const Document again =
      applied(emptyDocument(), OpenProject{.path = folder / "a.dapple"}, context);
  CHECK(!findRegion(again, 1)->swatch);
  const Document blended = applied(again, BlendBorders{});
  CHECK(*blended.results.colour == *d.results.colour);
  CHECK(blended.results.border->points == d.results.border->points);
}
