#include "document/edit_history.h"

#include <doctest/doctest.h>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "document_fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

// Some edit that makes sense for the document: the `step`-th of a random walk.
Command randomEdit(const Document& d, std::uint64_t step) {
  const auto below = [&](std::uint64_t count, std::uint64_t stream) {
    return hashBelow(count, 77, step, stream);
  };
  const RegionId region = (*d.regions)[below(d.regions->size(), 1)].id;
  const Index seed = static_cast<Index>(below(d.size(), 2));
  switch (below(10, 0)) {
    case 0:
      return SelectWand{.seed = seed, .wand = {.by = WandBy::Normal, .threshold = 25}};
    case 1:
      return GrowSelection{};
    case 2:
      return InvertSelection{};
    case 3:
      if (d.regions->size() < 9) return AddRegion{};
      return RemoveRegion{.region = d.regions->back().id == kUnassigned ? d.regions->front().id
                                                                        : d.regions->back().id};
    case 4:
      return SetRegion{.region = region, .name = fmt::format("Name {}", step)};
    case 5:
      return SetSwatch{.region = region,
                       .reference = {.path = step % 2 == 0 ? "noise.png" : "bricks.png"}};
    case 6:
      if (d.selection) return AssignSelection{.region = region};
      return SelectAll{};
    case 7:
      return AddStroke{.region = region, .stroke = meridian(d, 3)};
    case 8: {
      TextureOptions options;
      options.method = Method::Random;
      options.seed = step;
      return SetRegion{.region = region, .options = options};
    }
    default:
      return Select{.points = {seed, (seed + 1) % static_cast<Index>(d.size())},
                    .mode = SelectMode::Add};
  }
}

}  // namespace

TEST_CASE("after 1000 random edits undo leads back to the first byte and redo to the last") {
  const TestFolder folder;
  const Document first = sphereDocument(folder, 600);
  EditHistory history(first);
  std::vector<Document> every{first};
  for (std::uint64_t step = 0; step < 1000; ++step) {
    const Command edit = randomEdit(history.document(), step);
    Document next = applied(history.document(), edit);
    if (step % 100 == 50 && findRegion(next, 0)->swatch) {
      next = applied(next,
                     SetRegion{.region = 0, .options = TextureOptions{.method = Method::Random}});
      if (!pointsOf(next, 0).empty()) next = applied(next, Synthesize{.region = 0});
    }
    history.push(label(edit, history.document()), next);
    every.push_back(history.document());
  }
  CHECK(history.size() == 1001);
  const Document last = history.document();
  for (std::size_t step = 1000; step > 0; --step)
    REQUIRE(sameContent(history.undo(), every[step - 1]));
  CHECK(sameContent(history.document(), first));
  CHECK_THROWS_AS(history.undo(), InvalidInput);
  while (history.cursor() + 1 < history.size()) history.redo();
  CHECK(sameContent(history.document(), last));
  CHECK(!sameContent(last, first));
  CHECK_THROWS_AS(history.redo(), InvalidInput);
}

TEST_CASE("a new edit drops what was undone") {
  const TestFolder folder;
  const Document d = sphereDocument(folder, 300);
  EditHistory history(d);
  for (const Index i : {1u, 2u, 3u}) history.push("step", applied(d, Select{.points = {i}}));
  history.goTo(1);
  CHECK(history.document().selection->points() == std::vector<Index>{1});
  history.push("other", applied(d, Select{.points = {9}}));
  CHECK(history.size() == 3);
  CHECK(history.label(2) == "other");
  CHECK_THROWS_AS(history.goTo(3), InvalidInput);
}

TEST_CASE("the oldest steps go when the memory for undo is used up, the present one never") {
  const TestFolder folder;
  const Document d = sphereDocument(folder, 6400);
  const std::size_t step = 6400 / 8;  // bytes of a selection
  EditHistory history(d, "Open", 10 * step + step / 2);
  for (Index i = 0; i < 100; ++i) history.push("Select", applied(d, Select{.points = {i}}));
  CHECK(history.document().selection->points() == std::vector<Index>{99});
  CHECK(history.size() == 11);  // the present and ten before it
  CHECK(history.dropped() == 90);
  CHECK(history.cursor() == 10);
  for (int back = 0; back < 10; ++back) history.undo();
  CHECK(history.document().selection->points() == std::vector<Index>{89});
  CHECK_THROWS_AS(history.undo(), InvalidInput);
  EditHistory poor(d, "Open", 0);
  for (const Index i : {4u, 5u}) poor.push("Select", applied(d, Select{.points = {i}}));
  CHECK(poor.size() == 1);
  CHECK(poor.document().selection->has(5));
}
