#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "base/errors.h"
#include "document/region_synthesis.h"
#include "document_fixtures.h"
#include "fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

// The left half bricks, the rest noise.
Document twoRegions(const TestFolder& folder, std::size_t count) {
  Document d = sphereDocument(folder, count);
  d = applied(d, Select{.points = half(d, true)});
  d = applied(d, AddRegion{.name = "Left"});
  for (const RegionId r : {0, 1})
    d = applied(d, SetRegion{.region = r, .borderKind = BorderKind::Hard});
  d = applied(d, SetSwatch{.region = 1, .reference = {.path = "bricks.png"}});
  return applied(d, SetSwatch{.region = 0, .reference = {.path = "noise.png"}});
}

std::size_t labelled(const Document& d, RegionId id) {
  return static_cast<std::size_t>(std::count(d.labels->begin(), d.labels->end(), id));
}

}  // namespace

TEST_CASE("an opened scan is one region that nobody has touched") {
  const TestFolder folder;
  const Document d = sphereDocument(folder, 500);
  CHECK(d.size() == 500);
  CHECK(d.regions->size() == 1);
  CHECK(labelled(d, kUnassigned) == 500);
  CHECK(!d.selection);
  CHECK(!d.results.source);
  CHECK(d.scan->hash != 0);
}

TEST_CASE("selections add, subtract and intersect") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 300);
  d = applied(d, Select{.points = {1, 2, 3}});
  CHECK(d.selection->points() == std::vector<Index>{1, 2, 3});
  d = applied(d, Select{.points = {3, 4}, .mode = SelectMode::Add});
  CHECK(d.selection->points() == std::vector<Index>{1, 2, 3, 4});
  d = applied(d, Select{.points = {2}, .mode = SelectMode::Subtract});
  CHECK(d.selection->points() == std::vector<Index>{1, 3, 4});
  d = applied(d, Select{.points = {0, 4, 299}, .mode = SelectMode::Intersect});
  CHECK(d.selection->points() == std::vector<Index>{4});
  d = applied(d, InvertSelection{});
  CHECK(d.selection->count() == 299);
  CHECK(!d.selection->has(4));
  d = applied(d, Select{});
  CHECK(!d.selection);
  CHECK_THROWS_AS(applied(d, Select{.points = {300}}), InvalidInput);
}

TEST_CASE("regions take selected points, keep them when locked, and give them back when removed") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 400);
  d = applied(d, Select{.points = half(d, true)});
  d = applied(d, AddRegion{.name = "Left"});
  const std::size_t left = half(d, true).size();
  CHECK(labelled(d, 1) == left);
  d = applied(d, SetRegion{.region = 1, .locked = true});
  d = applied(d, SelectAll{});
  d = applied(d, AddRegion{});
  CHECK(labelled(d, 1) == left);
  CHECK(labelled(d, 2) == 400 - left);
  CHECK(findRegion(d, 2)->name == "Region 2");
  CHECK(findRegion(d, 2)->colour != findRegion(d, 1)->colour);
  CHECK_THROWS_AS(applied(d, AssignSelection{.region = 1}), InvalidInput);
  CHECK_THROWS_AS(applied(d, RemoveRegion{.region = 1}), InvalidInput);
  d = applied(d, RemoveRegion{.region = 2});
  CHECK(labelled(d, kUnassigned) == 400 - left);
  CHECK_THROWS_AS(applied(d, RemoveRegion{.region = kUnassigned}), InvalidInput);
  CHECK_THROWS_AS(applied(d, SetRegion{.region = 9, .name = "x"}), InvalidInput);
}

TEST_CASE("a command that fails names the reason and leaves the document as it was") {
  const TestFolder folder;
  const Document d = sphereDocument(folder, 300);
  const Document before = d;
  CHECK_THROWS_WITH_AS(applied(d, Synthesize{.region = kUnassigned}),
                       "region 'Whole scan' has no swatch; choose one first", InvalidInput);
  CHECK_THROWS_AS(applied(d, SetSwatch{.region = 0, .reference = {.path = "none.png"}}), IoError);
  CHECK_THROWS_AS(
      applied(d, SetSwatch{.region = 0,
                           .reference = {.path = "noise.png", .crop = PixelRect{40, 0, 20, 20}}}),
      InvalidInput);
  CHECK_THROWS_AS(applied(d, AddStroke{.region = 0, .stroke = {}}), InvalidInput);
  TextureOptions bad;
  bad.scale = -1;
  CHECK_THROWS_AS(applied(d, SetRegion{.region = 0, .options = bad}), InvalidInput);
  CHECK_THROWS_AS(applied(emptyDocument(), SelectAll{}), InvalidInput);
  CHECK(sameContent(d, before));
}

TEST_CASE("a cropped swatch is a part of its image") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 300);
  const PixelRect crop{5, 7, 20, 11};
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = "noise.png", .crop = crop}});
  const Region& region = *findRegion(d, 0);
  CHECK(region.swatch->width == 20);
  CHECK(region.swatch->height == 11);
  CHECK(region.image->at(3, 2, 1) == imageNamed("noise.png").at(8, 9, 1));
}

TEST_CASE("a whole scan is synthesized byte for byte as the command line does it, with strokes") {
  const TestFolder folder;
  const Document start = sphereDocument(folder, 3000);
  const std::vector<vec3>& positions = start.points().positions;
  const Stroke stroke{.positions = {positions[700], positions[720]}, .points = {700, 720}};
  Workers workers;
  Monitor monitor(workers);
  for (const Method method : {Method::Hybrid, Method::Grid}) {
    TextureOptions options;
    options.neighbours = 16, options.method = method, options.grid = 11;
    Document d = applied(start, SetRegion{.region = 0, .options = options});
    d = applied(d, SetSwatch{.region = 0, .reference = {.path = "bricks.png"}});
    d = applied(d, AddStroke{.region = 0, .stroke = stroke});
    d = applied(d, Synthesize{});
    const TexturedPoints alone =
        texturePoints(d.scan->prepared, *findRegion(d, 0)->swatch, {&stroke, 1}, options, monitor);
    const SourceMap map = wholeMap(d);
    CHECK(map.colour == alone.map.colour);
    CHECK(map.texel == alone.map.texel);
    CHECK(map.state == alone.map.state);
    CHECK(map.unit == alone.map.unit);
    // The grid begins where the stroke does.
    if (method == Method::Grid) CHECK(map.order[700] == 0);
  }
}

TEST_CASE("fewer neighbours than the scan has give what a scan with fewer would") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 1500);
  TextureOptions options;
  options.neighbours = 10;
  d = applied(d, SetRegion{.region = 0, .options = options});
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = "bricks.png"}});
  Document fewer = applied(emptyDocument(), OpenScan{.path = d.scan->path, .neighbours = 10});
  CHECK(pointsOf(applied(d, Synthesize{}), 0).size() == 1500);
  fewer = applied(fewer, SetRegion{.region = 0, .options = options});
  fewer = applied(fewer, SetSwatch{.region = 0, .reference = {.path = "bricks.png"}});
  // The same up to the scale, which is the scan's spacing as measured by its neighbours.
  const Results a = applied(d, Synthesize{}).results, b = applied(fewer, Synthesize{}).results;
  CHECK(a.sources[0]->unit == doctest::Approx(b.sources[0]->unit).epsilon(0.03));
}

TEST_CASE("a synthesis changes the points of its region and no others") {
  const TestFolder folder;
  Document d = twoRegions(folder, 3000);
  const Document one = applied(d, Synthesize{.region = 1});
  REQUIRE(one.results.source);
  for (Index i = 0; i < one.size(); ++i) {
    const bool left = (*one.labels)[i] == 1;
    REQUIRE(((*one.results.source)[i] == kNoSource) == !left);
    if (!left) REQUIRE((*one.results.colour)[i] == d.points().colours[i]);
  }
  const Document both = applied(one, Synthesize{.region = 0});
  CHECK(both.results.sources.size() == 2);
  for (Index i = 0; i < one.size(); ++i)
    if ((*one.labels)[i] == 1) {
      REQUIRE((*both.results.colour)[i] == (*one.results.colour)[i]);
      REQUIRE((*both.results.texel)[i] == (*one.results.texel)[i]);
    }
  // In one go or one by one, in any order: the same.
  const Document all = applied(d, Synthesize{});
  CHECK(*all.results.colour == *both.results.colour);
  CHECK(*applied(applied(d, Synthesize{.region = 0}), Synthesize{.region = 1}).results.texel ==
        *all.results.texel);
}

TEST_CASE("every point of a region takes a colour that its own swatch has") {
  const TestFolder folder;
  Document d = twoRegions(folder, 2500);
  for (const Method method : {Method::Hybrid, Method::Patches, Method::Match, Method::Grid,
                              Method::Mapping, Method::Coordinates, Method::Tiling}) {
    TextureOptions options;
    options.method = method;
    d = applied(d, SetRegion{.region = 1, .options = options});
    const Document done = applied(d, Synthesize{.region = 1});
    const ResultSource& source = *done.results.sources.at(0);
    std::size_t far = 0, count = 0;
    for (const Index i : pointsOf(done, 1)) {
      const vec3 seen = sampleSwatch(*source.swatch, (*done.results.texel)[i]);
      far += glm::length(seen - (*done.results.colour)[i]) > 0.25f ? 1 : 0;
      ++count;
    }
    CHECK(static_cast<double>(far) < 0.1 * static_cast<double>(count));
  }
}

TEST_CASE("a second synthesis of a region replaces the first, and nothing unused is kept") {
  const TestFolder folder;
  Document d = applied(twoRegions(folder, 1500), Synthesize{});
  CHECK(d.results.sources.size() == 2);
  d = applied(d, SetSwatch{.region = 1, .reference = {.path = "stripes.png"}});
  d = applied(d, Synthesize{.region = 1});
  CHECK(d.results.sources.size() == 2);
  std::set<std::string> used;
  for (const auto& source : d.results.sources) used.insert(source->reference.path);
  CHECK(used == std::set<std::string>{"noise.png", "stripes.png"});
  d = applied(d, ClearResult{.region = 1});
  CHECK(d.results.sources.size() == 1);
  const Index i = pointsOf(d, 1).front();
  CHECK((*d.results.colour)[i] == d.points().colours[i]);
  CHECK(!applied(d, ClearResult{}).results.source);
}

TEST_CASE("regions of one point, or of fewer than the neighbours asked for, are filled") {
  const TestFolder folder;
  const Document open = sphereDocument(folder, 1500);
  for (const Index count : {1u, 2u, 8u, 9u, 12u, 26u})
    for (const Method method : {Method::Hybrid, Method::Patches, Method::Match, Method::Grid,
                                Method::Mapping, Method::Coordinates, Method::Tiling}) {
      Document d = open;
      std::vector<Index> few(count);
      for (Index i = 0; i < count; ++i) few[i] = 100 + i;
      d = applied(d, Select{.points = few});
      d = applied(d, AddRegion{});
      TextureOptions options;
      options.method = method;
      d = applied(d, SetRegion{.region = 1, .options = options});
      d = applied(d, SetSwatch{.region = 1, .reference = {.path = "noise.png"}});
      d = applied(d, Synthesize{.region = 1});
      for (const Index i : few) {
        CAPTURE(count);
        REQUIRE((*d.results.source)[i] == 0);
        REQUIRE((*d.results.colour)[i] != vec3(0));
      }
    }
}

TEST_CASE("the rotation of a region turns the swatch on the surface") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 1500);
  TextureOptions options;
  options.method = Method::Match;
  d = applied(d, SetRegion{.region = 0, .options = options});
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = "stripes.png"}});
  const Document plain = applied(d, Synthesize{});
  d = applied(d, SetRegion{.region = 0, .rotation = 90});
  const Document turned = applied(d, Synthesize{});
  for (Index i = 0; i < d.size(); ++i) {
    const TangentFrame &a = (*plain.results.frame)[i], &b = (*turned.results.frame)[i];
    REQUIRE(glm::length(b.t + a.s) < 1e-4f);  // counter-clockwise: up to the left
    REQUIRE(glm::length(glm::cross(b.s, b.t) - b.n) < 1e-4f);
  }
}

TEST_CASE("the swatch follows the strokes of its region") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 2000);
  TextureOptions options;
  options.method = Method::Match;
  options.up = vec3(0, 1, 0);
  d = applied(d, SetRegion{.region = 0, .options = options});
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = "stripes.png"}});
  const Stroke stroke = meridian(d);
  d = applied(d, AddStroke{.region = 0, .stroke = stroke});
  const Document done = applied(d, Synthesize{});
  for (const Index i : stroke.points) CHECK((*done.results.frame)[i].t.z > 0.5f);
  // Over the whole sphere directions differ little from neighbour to neighbour.
  std::size_t kinks = 0;
  for (Index i = 0; i < d.size(); ++i)
    for (const Index j : d.scan->prepared.neighborhoods.of(i).first(6))
      kinks += glm::dot((*done.results.frame)[i].t, (*done.results.frame)[j].t) < 0.8f ? 1 : 0;
  CHECK(kinks < 6 * d.size() / 12);
  d = applied(d, RemoveStroke{.region = 0, .stroke = 0});
  CHECK(!findRegion(d, 0)->strokes);
  CHECK_THROWS_AS(applied(d, RemoveStroke{.region = 0, .stroke = 0}), InvalidInput);
}

TEST_CASE("an edit shares every column that it does not change") {
  const TestFolder folder;
  const Document d = applied(twoRegions(folder, 5000), Synthesize{});
  const Document renamed = applied(d, SetRegion{.region = 1, .name = "Other"});
  CHECK(ownBytes(renamed, d) < 5000);
  CHECK(renamed.labels == d.labels);
  const Document selected = applied(d, Select{.points = {1, 2}});
  CHECK(ownBytes(selected, d) <= 5000 / 8 + 16);
  const Document again = applied(d, Synthesize{.region = 1});
  CHECK(ownBytes(again, d) / 5000 < 80);  // bytes a point
  CHECK(ownBytes(d, d) == 0);
}

TEST_CASE("automatic segmentation makes the parts asked for and leaves locked regions alone") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 2000);
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = "noise.png"}});
  d = applied(d, Select{.points = {0, 1, 2, 3, 4}});
  d = applied(d, AddRegion{.name = "Mine"});
  d = applied(d, SetRegion{.region = 1, .locked = true});
  d = applied(d, SegmentAutomatically{.parts = 2});
  CHECK(d.regions->size() == 4);
  CHECK(labelled(d, 1) == 5);
  CHECK(labelled(d, 0) == 0);
  CHECK(labelled(d, 2) + labelled(d, 3) == 1995);
  CHECK(findRegion(d, 2)->swatch == findRegion(d, 0)->swatch);
  CHECK_THROWS_AS(applied(d, SegmentAutomatically{.parts = 0}), InvalidInput);
}
