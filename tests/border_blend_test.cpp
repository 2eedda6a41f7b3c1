#include "document/border_blend.h"

#include <doctest/doctest.h>

#include <fstream>
#include <set>

#include "base/errors.h"
#include "document/border_sides.h"
#include "document/edit_history.h"
#include "document/options_table.h"
#include "document_fixtures.h"
#include "regions/segmentation.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

// Of both regions; what is not given is a blend.
Document withBorders(Document d, double width, BorderKind kind = BorderKind::Blend) {
  for (const Region& region : std::vector<Region>(*d.regions))
    d = applied(d, SetRegion{.region = region.id, .borderWidth = width, .borderKind = kind});
  return d;
}

// A sphere in two halves of different swatches, synthesized; the borders are `width` wide.
Document halves(const TestFolder& folder, double width, std::size_t count = 6000,
                const char* left = "bricks", const char* right = "noise") {
  Document d = sphereDocument(folder, count);
  d = applied(d, Select{.points = half(d, true)});
  d = applied(d, AddRegion{});
  d = applied(d, SetSwatch{.region = 1, .reference = {.path = "/swatches/" + std::string(left)}});
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = "/swatches/" + std::string(right)}});
  return applied(withBorders(d, width), Synthesize{});
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
  }
  return applied(withBorders(d, width), Synthesize{});
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

vec3 colourOf(const Document& d, const BorderTerm& term) {
  return sampleSwatch(*d.results.sources[term.source]->swatch, term.texel, term.level);
}

// The largest difference of a colour channel between the colours shown and the mix of the terms and
// the own colours that are kept, over points near borders.
float worstRebuilt(const Document& d) {
  const Results& r = d.results;
  float worst = 0;
  std::vector<SourceTerm> terms;
  for (std::size_t b = 0; b < r.border->points.size(); ++b) {
    const Index i = r.border->points[b];
    gatherTerms(r, i, terms);
    float sum = 0;
    for (const SourceTerm& term : terms) sum += term.weight;
    CHECK(std::abs(sum - 1) < 1e-4f);
    vec3 colour = (1 - otherWeight(d, i)) * r.border->own[b];
    for (const BorderTerm& term : r.border->termsOf(b)) colour += term.weight * colourOf(d, term);
    const vec3 d3 = glm::abs(colour - (*r.colour)[i]);
    worst = std::max({worst, d3.x, d3.y, d3.z});
  }
  return worst;
}

bool sameColumns(const Results& a, const Results& b) {
  return *a.colour == *b.colour && a.border->points == b.border->points &&
         a.border->terms == b.border->terms;
}

Document undone(const Document& d) {
  return applied(withBorders(d, 8, BorderKind::Hard), BlendBorders{});
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
  double sum[6] = {}, count[6] = {};  // by whole spacings from the border
  for (Index i = 0; i < d.size(); ++i) {
    const float weight = otherWeight(d, i), depth = distance[i] - 0.5f;
    if (depth > 5) {
      CHECK(weight == 0);
      CHECK((*d.results.colour)[i] == (*hard.results.colour)[i]);
      continue;
    }
    ++near;
    const auto at = static_cast<std::size_t>(std::max(0.f, depth));
    sum[at] += weight, ++count[at];
  }
  CHECK(near > 400);
  CHECK(d.results.border->points.size() <= near);
  CHECK(sum[0] / count[0] < 0.55);
  CHECK(sum[0] / count[0] > 0.3);
  for (std::size_t at = 1; at < 5; ++at) CHECK(sum[at] / count[at] < sum[at - 1] / count[at - 1]);
  CHECK(sum[4] / count[4] < 0.02);
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
  CHECK(alike > pairs * 80 / 100);
}

TEST_CASE("where three regions meet the weights of all sum to one") {
  const TestFolder folder;
  const Document d = thirds(folder, 10);
  std::set<std::size_t> counts;
  for (std::size_t b = 0; b < d.results.border->points.size(); ++b) {
    float sum = 0;
    for (const BorderTerm& term : d.results.border->termsOf(b)) sum += term.weight;
    CHECK(sum > 0);
    CHECK(sum < 1.0001f);
    counts.insert(d.results.border->termsOf(b).size());
  }
  CHECK(counts == std::set<std::size_t>{1, 2});
}

TEST_CASE("the points of a locked region stay, and its pattern runs out in the neighbour") {
  const TestFolder folder;
  Document d = halves(folder, 0);
  const std::vector<vec3> before = *d.results.colour;
  d = applied(d, SetRegion{.region = 1, .locked = true});
  d = applied(withBorders(d, 8), BlendBorders{});
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
  // Where all three met, weights were found with the third one and are not found anew.
  std::size_t apart = 0;
  for (Index i = 0; i < two.size(); ++i) {
    const vec3 by = glm::abs((*two.results.colour)[i] - (*made.results.colour)[i]);
    apart += std::max({by.x, by.y, by.z}) > 0.02f;
  }
  CHECK(apart <= 4);
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
      d = applied(d, SetRegion{.region = r, .options = options});
    }
    d = applied(withBorders(d, 4), Synthesize{});
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

TEST_CASE("a blend keeps the contrast of what it mixes") {
  const TestFolder folder;
  for (const double width : {8.0, 24.0}) {
    const Document d = halves(folder, width);
    const BorderMix& border = *d.results.border;
    std::vector<vec3> mean;
    for (const auto& source : d.results.sources) {
      vec3 sum(0);
      for (const vec3& c : source->swatch->colours()) sum += c;
      mean.push_back(sum / static_cast<float>(source->swatch->pixels()));
    }
    // Squares of the deviation from the mix of the means; without borders, from the own mean.
    double mixed = 0, apart = 0;
    for (std::size_t b = 0; b < border.points.size(); ++b) {
      const Index i = border.points[b];
      const std::uint16_t own = (*d.results.source)[i];
      const float left = 1 - otherWeight(d, i);
      const vec3 alone = border.own[b] - mean[own];
      vec3 deviation = (*d.results.colour)[i] - left * mean[own];
      for (const BorderTerm& term : border.termsOf(b)) deviation -= term.weight * mean[term.source];
      mixed += glm::dot(deviation, deviation);
      apart += glm::dot(alone, alone);
    }
    MESSAGE("width " << width << ": " << mixed / apart << " of the variance");
    CHECK(mixed > 0.9 * apart);
  }
}

TEST_CASE("sparse points read a neighbour's swatch as its own method does") {
  const TestFolder folder;
  for (const Method method : {Method::Hybrid, Method::Coordinates, Method::Match}) {
    Document d = halves(folder, 8, 3000);
    TextureOptions options{.method = method, .levels = 3, .scale = 0.25};
    for (const RegionId r : {0, 1}) d = applied(d, SetRegion{.region = r, .options = options});
    d = applied(d, Synthesize{});
    const BorderMix& border = *d.results.border;
    double level = 0, own = 0, beyond = 0;
    for (const BorderTerm& term : border.terms) level += term.level;
    level /= static_cast<double>(border.terms.size());
    if (method == Method::Hybrid)
      CHECK(level == 0);  // patches are not filtered
    else
      CHECK(level == doctest::Approx(method == Method::Match ? 2 : 1.68).epsilon(0.1));
    // Terms of the noise have the contrast that the noise has on its own points.
    const auto square = [&](const vec3& c) { return glm::dot(c - vec3(0.5f), c - vec3(0.5f)); };
    double owns = 0, beyonds = 0;
    for (std::size_t b = 0; b < border.points.size(); ++b)
      if ((*d.labels)[border.points[b]] == 0)
        own += square(border.own[b]), ++owns;
      else
        beyond += square(colourOf(d, border.termsOf(b)[0])), ++beyonds;
    CHECK(beyond / beyonds == doctest::Approx(own / owns).epsilon(0.25));
  }
}

TEST_CASE("in a cut border each point shows one of both patterns, at the rims its own") {
  const TestFolder folder;
  for (const char* method : {"hybrid", "coordinates", "triplanar"}) {
    Document d = halves(folder, 12);
    TextureOptions options;
    setOption(options, *findOption("method"), method);
    for (const RegionId r : {0, 1}) d = applied(d, SetRegion{.region = r, .options = options});
    d = applied(withBorders(d, 12, BorderKind::Cut), Synthesize{});
    const Document hard = undone(d);
    REQUIRE(d.results.border);
    const std::vector<float> distance = distanceToOther(d);
    CHECK(worstRebuilt(d) < 1e-4f);
    for (Index i = 0; i < d.size(); ++i) {
      const float weight = otherWeight(d, i);
      CHECK((weight == 0 || std::abs(weight - 1) < 1e-4f));
      if (distance[i] > 6.6f) CHECK(weight == 0);
      if (weight == 0) CHECK((*d.results.colour)[i] == (*hard.results.colour)[i]);
    }
    CHECK(d.results.border->points.size() > 50);
    CHECK(*d.results.texel == *hard.results.texel);
  }
}

TEST_CASE("a cut does not do away with a narrow region") {
  const TestFolder folder;
  Document d = halves(folder, 0);
  const std::vector<float> distance = distanceToOther(d);
  std::vector<Index> far;  // all of region 1 but a strip of some seven spacings
  for (Index i = 0; i < d.size(); ++i)
    if ((*d.labels)[i] == 1 && distance[i] > 7) far.push_back(i);
  std::size_t strip = 0;
  for (Index i = 0; i < d.size(); ++i) strip += (*d.labels)[i] == 1 && distance[i] <= 7;
  REQUIRE(far.size() > 50);
  REQUIRE(strip > 50);
  d = applied(applied(d, Select{.points = far}), AssignSelection{.region = 0});
  d = applied(withBorders(d, 32, BorderKind::Cut), Synthesize{});
  std::size_t own = 0;
  for (Index i = 0; i < d.size(); ++i) own += (*d.labels)[i] == 1 && otherWeight(d, i) == 0;
  CHECK(own > strip / 4);
}

TEST_CASE("a cut keeps the inner half of an arm of a thick region") {
  const TestFolder folder;
  constexpr float kHead = 0.85f, kArmEnd = 2;  // of the angle from the pole; 0.85: 18 spacings
  std::vector<Index> region, arm;
  Document d = sphereDocument(folder, 6000);
  const float halfWidth = 3 * d.scan->prepared.spacing;
  for (Index i = 0; i < d.size(); ++i) {
    const vec3 p = d.points().positions[i];
    const float angle = std::acos(std::clamp(p.z, -1.f, 1.f));
    const bool onArm = angle > kHead && angle < kArmEnd && p.x > 0 && std::abs(p.y) < halfWidth;
    if (onArm) arm.push_back(i);
    if (onArm || angle <= kHead) region.push_back(i);
  }
  REQUIRE(arm.size() > 100);
  d = applied(applied(d, Select{.points = region}), AddRegion{});
  for (const bool swapped : {false, true}) {
    for (const RegionId r : {0, 1}) {
      const std::string name = (r == 0) == swapped ? "noise" : "bricks";
      d = applied(d, SetSwatch{.region = r, .reference = {.path = "/swatches/" + name}});
    }
    d = applied(withBorders(d, 16, BorderKind::Cut), Synthesize{});
    std::size_t own = 0, taken = 0;
    for (const Index i : arm) own += otherWeight(d, i) == 0;
    for (const Index i : region) taken += otherWeight(d, i) > 0;
    CHECK(own >= arm.size() / 2);
    CHECK(taken > 50);  // around the head it is cut
    MESSAGE("of " << arm.size() << " points of the arm " << own << " stay");
  }
}

TEST_CASE("a cut between wide regions may run anywhere in its band") {
  const TestFolder folder;
  const Document d = withBorders(halves(folder, 0), 24, BorderKind::Cut);
  Workers workers;
  Monitor monitor(workers);
  const auto halos = BorderSides(d).halos(monitor);
  const std::vector<float> distance = distanceToOther(d);  // from all points, so no less
  std::size_t band = 0;
  for (const float spacings : distance) band += spacings < 12;
  CHECK(band > 600);
  CHECK(halos[0].points.size() + halos[1].points.size() >= band);
}

TEST_CASE("a new region's border is cut, and a blend or a hard one of its neighbour counts first") {
  const TestFolder folder;
  const Document d = applied(withBorders(halves(folder, 0), 8, BorderKind::Cut), BlendBorders{});
  CHECK(Region{}.borderKind == BorderKind::Cut);
  const auto with = [&](BorderKind kind, double width) {
    const SetRegion set{.region = 1, .borderWidth = width, .borderKind = kind};
    return applied(applied(d, set), BlendBorders{});
  };
  CHECK(!with(BorderKind::Hard, 20).results.border);
  CHECK(!with(BorderKind::Blend, 0).results.border);  // the width of a cut is not that of a blend
  const Document both = applied(withBorders(d, 4), BlendBorders{});
  CHECK(sameColumns(with(BorderKind::Blend, 4).results, both.results));
  const Document blendAndHard =
      applied(with(BorderKind::Blend, 4), SetRegion{.region = 0, .borderKind = BorderKind::Hard});
  CHECK(sameColumns(applied(blendAndHard, BlendBorders{}).results, both.results));
}

TEST_CASE("a cut beside a locked region leaves its points, and runs in the neighbour") {
  const TestFolder folder;
  const Document hard = halves(folder, 0);
  Document d = applied(hard, SetRegion{.region = 1, .locked = true});
  d = applied(withBorders(d, 8, BorderKind::Cut), BlendBorders{});
  const std::vector<float> distance = distanceToOther(d);
  REQUIRE(d.results.border);
  for (const Index i : d.results.border->points) {
    CHECK((*d.labels)[i] == 0);
    CHECK(distance[i] < 8.6f);
  }
}

TEST_CASE("a cut at one border and a blend at another share a point") {
  const TestFolder folder;
  Document d = withBorders(thirds(folder, 12), 12, BorderKind::Cut);
  d = applied(d, SetRegion{.region = 2, .borderKind = BorderKind::Blend});
  d = applied(d, BlendBorders{});
  CHECK(worstRebuilt(d) < 1e-4f);
  std::size_t cut = 0, mixed = 0;
  for (std::size_t b = 0; b < d.results.border->points.size(); ++b) {
    const float weight = otherWeight(d, d.results.border->points[b]);
    CHECK(weight < 1.0001f);
    (weight > 0.9999f ? cut : mixed) += 1;
  }
  CHECK(cut > 20);
  CHECK(mixed > 20);
}

TEST_CASE("cut borders are the same at any number of threads, and an undo takes them back") {
  const TestFolder folder;
  const Document d = applied(withBorders(thirds(folder, 0), 12, BorderKind::Cut), BlendBorders{});
  REQUIRE(d.results.border);
  for (const unsigned threads : {1u, 2u, 3u}) {
    Workers workers(threads);
    Monitor monitor(workers);
    Document again = d;
    again.results = blendBorders(undone(d), monitor);
    CHECK(!again.results.border);
    again.results = blendBorders(d, monitor);
    CHECK(sameContent(again, d));
  }
  EditHistory history(thirds(folder, 0));
  const Document before = history.document();
  history.push("Border", d);
  history.undo();
  CHECK(sameContent(history.document(), before));
}

TEST_CASE("a project keeps the kinds of its borders, and one from before reads as it was") {
  const TestFolder folder;
  Document d = applied(withBorders(halves(folder, 0), 12, BorderKind::Cut), BlendBorders{});
  d = applied(d, SetRegion{.region = 1, .borderWidth = 0});
  applied(d, SaveProject{.path = folder / "a.dapple"});
  const auto opened = [&](const std::string& name) {
    return applied(emptyDocument(), OpenProject{.path = folder / name});
  };
  CHECK(sameContent(opened("a.dapple"), d));
  std::ifstream in(folder / "a.dapple", std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string kind = "\"border\": \"cut\",";
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(kind)) != std::string::npos; ++found)
    text.erase(at, kind.size());
  CHECK(found == 2);
  std::ofstream(folder / "old.dapple", std::ios::binary) << text;
  const Document old = opened("old.dapple");
  CHECK(findRegion(old, 0)->borderKind == BorderKind::Blend);
  CHECK(findRegion(old, 0)->borderWidth == 12);
  CHECK(findRegion(old, 1)->borderKind == BorderKind::Hard);
}
