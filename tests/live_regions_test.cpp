#include "document/live_regions.h"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "document/edit_history.h"
#include "document/engine.h"
#include "document_fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

using Ids = std::vector<RegionId>;

SetRegion scaled(double scale, unsigned gesture = 0) {
  SetRegion set{.region = 0, .gesture = gesture};
  set.options = TextureOptions{.method = Method::Patches, .scale = scale};
  return set;
}

}  // namespace

TEST_CASE("an edit touches the regions whose input it changes, and no others") {
  const TestFolder folder;
  const Document d = sphereDocument(folder, 400);
  const auto touches = [&](const Document& from, const Command& edit) {
    return touchedRegions(from, applied(from, edit));
  };
  const SetSwatch bricks{.region = 0, .reference = {.path = "bricks.png"}};
  CHECK(touches(d, bricks) == Ids{0});
  CHECK(touches(d, scaled(3)) == Ids{0});
  CHECK(touches(d, SetRegion{.region = 0, .rotation = 20}) == Ids{0});
  CHECK(touches(d, AddStroke{0, meridian(d)}) == Ids{0});
  CHECK(touches(d, SetRegion{.region = 0, .name = "Ball"}).empty());
  CHECK(touches(d, SetRegion{.region = 0, .visible = false}).empty());
  CHECK(touches(d, Select{.points = {1, 2}}).empty());
  // The region that gains points, not the one that loses them.
  const Document chosen = applied(d, Select{half(d, true)});
  CHECK(touches(chosen, AddRegion{}) == Ids{1});
  const Document two = applied(chosen, AddRegion{});
  CHECK(touches(two, RemoveRegion{.region = 1}) == Ids{0});
  CHECK(touchedRegions(two, sphereDocument(folder, 300)).empty());
  CHECK_FALSE(canSynthesize(d, 0));
  CHECK(canSynthesize(applied(d, bricks), 0));
  CHECK_FALSE(
      canSynthesize(applied(applied(d, bricks), SetRegion{.region = 0, .locked = true}), 0));
  CHECK_FALSE(canSynthesize(d, 7));
}

TEST_CASE("live, a result belongs to the edit that asked for it") {
  const TestFolder folder;
  Engine engine({.readImage = imageNamed});
  engine.setLive(true);
  engine.submit(OpenScan{.path = writeSphere(folder, 3000), .neighbours = 16});
  engine.submit(SetSwatch{.region = 0, .reference = {.path = "bricks.png"}});
  engine.finish();
  const auto first = engine.snapshot();
  REQUIRE(first->document.results.colour);
  CHECK(first->history->size() == 3);
  engine.submit(scaled(4));
  engine.finish();
  const auto second = engine.snapshot();
  CHECK(second->history->size() == 4);
  CHECK(*second->document.results.colour != *first->document.results.colour);
  // As if it had been asked for by hand.
  CHECK(*second->document.results.colour ==
        *applied(applied(first->document, scaled(4)), Synthesize{}).results.colour);
  engine.submit(Undo{});
  engine.finish();
  CHECK(sameContent(engine.snapshot()->document, first->document));
  engine.submit(Redo{});
  engine.finish();
  CHECK(sameContent(engine.snapshot()->document, second->document));
  engine.setLive(false);
  engine.submit(scaled(2));
  engine.finish();
  CHECK(engine.snapshot()->document.results.colour == second->document.results.colour);
  CHECK(engine.status().errors == 0);
}

TEST_CASE("live, a border is blended when its width changes, and nothing is synthesized again") {
  const TestFolder folder;
  Engine engine({.readImage = imageNamed});
  engine.setLive(true);
  engine.submit(OpenScan{.path = writeSphere(folder, 6000), .neighbours = 16});
  engine.submit(SetSwatch{.region = 0, .reference = {.path = "bricks.png"}});
  engine.finish();
  engine.submit(Select{half(engine.snapshot()->document, true)});
  engine.submit(AddRegion{});
  engine.submit(SetSwatch{.region = 1, .reference = {.path = "noise.png"}});
  for (const RegionId r : {0, 1})
    engine.submit(SetRegion{.region = r, .borderKind = BorderKind::Hard});
  engine.finish();
  const auto hard = engine.snapshot();
  CHECK_FALSE(hard->document.results.border);
  SetRegion soft{.region = 1};
  soft.borderWidth = 4, soft.borderKind = BorderKind::Blend;
  engine.submit(soft);
  engine.finish();
  const auto blended = engine.snapshot();
  REQUIRE(blended->document.results.border);
  CHECK(blended->document.results.texel == hard->document.results.texel);
  CHECK(*blended->document.results.colour != *hard->document.results.colour);
  CHECK(blended->history->size() == hard->history->size() + 1);
  engine.submit(Undo{});
  engine.finish();
  CHECK(sameContent(engine.snapshot()->document, hard->document));
}

TEST_CASE("live, every edit on the way starts anew and the last one counts") {
  const TestFolder folder;
  Engine engine({.readImage = imageNamed});
  engine.setLive(true);
  engine.submit(OpenScan{.path = writeSphere(folder, 8000), .neighbours = 16});
  engine.submit(SetSwatch{.region = 0, .reference = {.path = "bricks.png"}});
  engine.finish();
  const std::size_t steps = engine.snapshot()->history->size();
  for (int k = 0; k < 12; ++k) {
    engine.submit(scaled(2 + 0.25 * k, 77));
    std::this_thread::sleep_for(std::chrono::milliseconds(10 * (k % 4)));
  }
  engine.finish();
  const auto done = engine.snapshot();
  CHECK(done->history->size() == steps + 1);  // one gesture, one step
  CHECK(done->document.regions->front().options.scale == 4.75);
  CHECK(*done->document.results.colour == *applied(done->document, Synthesize{}).results.colour);
  CHECK(engine.status().errors == 0);
}

TEST_CASE("live, what the user cancels stays cancelled until the next edit") {
  const TestFolder folder;
  Engine engine({.readImage = imageNamed});
  engine.setLive(true);
  engine.submit(OpenScan{.path = writeSphere(folder, 20000), .neighbours = 16});
  SetRegion slow{.region = 0};
  slow.options = TextureOptions{.method = Method::Match, .coherent = false};
  engine.submit(slow);
  engine.submit(SetSwatch{.region = 0, .reference = {.path = "bricks.png"}});
  while (!engine.status().job.starts_with("Synthesize"))
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  engine.cancel();
  engine.finish();
  CHECK_FALSE(engine.snapshot()->document.results.colour);
  engine.submit(scaled(3));  // patches: quick
  engine.finish();
  CHECK(engine.snapshot()->document.results.colour);
}

TEST_CASE("edits of one gesture are one step, whatever comes between begins another") {
  const TestFolder folder;
  const Document d = sphereDocument(folder, 300);
  EditHistory history(d);
  const auto push = [&](double scale, unsigned gesture) {
    history.push("scale", applied(history.document(), scaled(scale, gesture)), gesture);
  };
  for (const double scale : {2., 3., 4.}) push(scale, 5);
  CHECK(history.size() == 2);
  push(5, 6);
  CHECK(history.size() == 3);
  history.undo();
  CHECK(history.document().regions->front().options.scale == 4);
  history.undo();
  push(7, 6);  // what was undone is gone
  CHECK(history.size() == 2);
  history.amend(applied(history.document(), Select{.points = {3}}));
  CHECK(history.size() == 2);
  CHECK(history.document().selection->has(3));
  CHECK(sameContent(history.undo(), d));
}
