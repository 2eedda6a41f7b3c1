#include "swatch/kept_tables.h"

#include <doctest/doctest.h>

#include <thread>

#include "fixtures.h"
#include "swatch/appearance.h"
#include "swatch/similar_places.h"
#include "swatch/swatch_search.h"

using namespace dapple;

namespace {

struct Table {
  int number = 0;
  std::size_t size = 1;
  std::size_t bytes() const { return size; }
};

Swatch swatchOf(Tileable tileable) {
  return makeSwatch(fixtures::bricks(48), tileable, 3, "bricks");
}

bool same(const Appearance& a, const Appearance& b) {
  return std::equal(std::begin(a.number), std::end(a.number), std::begin(b.number));
}

}  // namespace

TEST_CASE("a table is made once, for each number and kind") {
  const KeptTables tables;
  int made = 0;
  const auto get = [&](std::uint64_t number) {
    return tables.get<Table>(number, [&] { return Table{.number = ++made}; });
  };
  CHECK(tables.find<Table>(3) == nullptr);
  CHECK(get(3)->number == 1);
  CHECK(get(4)->number == 2);
  CHECK(get(3)->number == 1);
  CHECK(tables.find<Table>(4)->number == 2);
  CHECK(tables.find<SimilarPlaces>(3) == nullptr);
  CHECK(tables.bytes() == 2);
}

TEST_CASE("tables are kept up to a number of bytes, and none by a copy") {
  KeptTables tables;
  const auto large = [] { return Table{.size = KeptTables::kMostBytes - 1}; };
  const auto first = tables.get<Table>(0, large);
  CHECK(tables.get<Table>(0, large) == first);
  CHECK(tables.get<Table>(1, large) != tables.get<Table>(1, large));
  CHECK(tables.bytes() == KeptTables::kMostBytes - 1);
  CHECK(KeptTables(tables).bytes() == 0);
  tables = KeptTables();
  CHECK(tables.bytes() == 0);
  CHECK(first->size == KeptTables::kMostBytes - 1);
}

TEST_CASE("threads that ask at once get the same table") {
  const KeptTables tables;
  std::vector<std::shared_ptr<const Table>> got(4);
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < got.size(); ++t)
      threads.emplace_back([&, t] {
        for (std::uint64_t number = 0; number < 50; ++number)
          got[t] = tables.get<Table>(number, [] { return Table{}; });
      });
  }
  for (const auto& table : got) CHECK(table == got.front());
  CHECK(tables.bytes() == 50);
}

TEST_CASE("a swatch keeps its appearance, and what is kept is what would be made") {
  Workers workers;
  Monitor monitor(workers);
  const Swatch swatch = swatchOf(Tileable::No);
  const auto turned = appearanceOf(swatch, 1, true, monitor);
  CHECK(appearanceOf(swatch, 1, false, monitor) == turned);  // it has all that is asked for
  const auto plain = appearanceOf(swatch, 2, false, monitor);
  CHECK(appearanceOf(swatch, 2, false, monitor) == plain);
  CHECK(!plain->turned);
  CHECK(appearanceOf(swatch, 2, true, monitor)->turned);
  const AppearanceLevel made = makeAppearance(swatch, 1, false, monitor);
  CHECK(std::equal(made.samples.begin(), made.samples.end(), turned->samples.begin(),
                   turned->samples.end(), same));
  CHECK(made.unit == turned->unit);
  const PlaceDomain domain(swatch);
  CHECK(similarPlacesOf(*plain, domain, monitor) == similarPlacesOf(*plain, domain, monitor));
}

TEST_CASE("a swatch keeps its searches, one that is changed makes its own") {
  Swatch swatch = swatchOf(Tileable::Yes);
  const auto search = searchOf(swatch, 0, 2);
  CHECK(searchOf(swatch, 0, 2) == search);
  CHECK(searchOf(swatch, 0, 4) != search);
  CHECK(searchOf(swatch, 1, 2) != search);
  CHECK(searchOf(swatch, 0, 2, 2) != search);
  CHECK(search->bytes() >= 4 * swatch.pixels() * 4);
  const Swatch copy = swatch;
  CHECK(copy.tables.bytes() == 0);
  CHECK(searchOf(copy, 0, 2) != search);
}
