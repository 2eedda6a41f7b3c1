#include "document/automatic_options.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "document/region_synthesis.h"
#include "document_fixtures.h"

using namespace dapple;

namespace {

SwatchAnalysis swatchTurned(SelfMatch turned) {
  SwatchAnalysis a;
  a.feature = 10, a.turned = turned, a.lattice = 0.5, a.area = 100 * 100;
  return a;
}

const SwatchAnalysis kGravel = swatchTurned({1, 1, 1}), kStripes = swatchTurned({1, 5, 5}),
                     kChecks = swatchTurned({1, 1, 5}), kScales = swatchTurned({3, 5, 5});

AutomaticOptions chosen(const SwatchAnalysis& swatch, const std::vector<std::string>& kept = {},
                        const TextureOptions& given = {}, bool strokes = false) {
  return chosenOptions(given,
                       {.swatch = swatch, .points = 40000, .strokes = strokes, .kept = kept});
}

// On a surface that is less than 7 features wide.
TextureOptions chosenNarrow(const SwatchAnalysis& swatch) {
  return chosenOptions({}, {.swatch = swatch, .points = 8000, .strokes = false, .kept = {}})
      .options;
}

AutomaticOptions chosenAt(double feature, std::size_t points, const TextureOptions& given = {},
                          const std::vector<std::string>& kept = {}) {
  SwatchAnalysis swatch = kGravel;
  swatch.feature = feature;
  return chosenOptions(given, {.swatch = swatch, .points = points, .kept = kept});
}

}  // namespace

TEST_CASE("coordinates where a turn shows, and patches that run straight on where none does") {
  CHECK(chosen(kGravel).options.method == Method::Hybrid);
  CHECK(chosen(kGravel).options.follow == false);
  for (const SwatchAnalysis& swatch : {kStripes, kChecks, kScales})
    CHECK(chosen(swatch).options == TextureOptions{.method = Method::Coordinates});
}

TEST_CASE("without room for coordinates patches follow, with the symmetry of the swatch") {
  for (const auto& [swatch, symmetry] :
       {std::pair(kStripes, FieldSymmetry::Half), std::pair(kChecks, FieldSymmetry::Quarter),
        std::pair(kScales, FieldSymmetry::None)}) {
    const TextureOptions options = chosenNarrow(swatch);
    CHECK(options.method == Method::Hybrid);
    CHECK(options.follow);
    CHECK(options.symmetry == symmetry);
    CHECK(options.distortion == (symmetry == FieldSymmetry::None ? 3.2 : 1.6));
  }
  // Larger pixels, less room.
  TextureOptions large;
  large.scale = 2.5;
  CHECK(chosen(kStripes, {"scale"}, large).options.method == Method::Hybrid);
}

TEST_CASE("rows that no turn shows are followed by patches that may lie upside down") {
  SwatchAnalysis roof = kGravel;
  roof.latticeFit = 0.3;
  const AutomaticOptions out = chosen(roof);
  CHECK(out.options.method == Method::Hybrid);
  CHECK(out.options.follow);
  CHECK(out.options.symmetry == FieldSymmetry::Half);
}

TEST_CASE("a scale that shows nothing of a pattern is changed, unless the user has set it") {
  // A photograph of pebbles that are larger than the scan, and sand finer than its points.
  const AutomaticOptions large = chosenAt(200, 85000), fine = chosenAt(1, 85000);
  CHECK(large.options.scale == 0.25);
  CHECK(fine.options.scale == 4);
  for (const AutomaticOptions& out : {large, fine}) {
    CHECK(out.reasons.front().find("scale ") == 0);
    CHECK(out.warnings.empty());
  }
  for (const double feature : {5.0, 10.0, 30.0, 90.0})
    CHECK(chosenAt(feature, 85000).options.scale == 1);
  // Too few points for both: features stay wide enough to be recognised.
  CHECK(chosenAt(10, 150).options.scale == 0.5);
  for (const double feature : {1.0, 200.0}) {
    const AutomaticOptions kept = chosenAt(feature, 85000, {}, {"scale"});
    CHECK(kept.options.scale == 1);
    CHECK(kept.warnings.size() == 1);
  }
}

TEST_CASE("seams are mended by the size of features, and gaps matched with as many levels") {
  for (const auto& [feature, repair, levels] :
       {std::tuple(2.0, 3.0, 2), std::tuple(7.0, 7.0, 4), std::tuple(40.0, 12.0, 6)}) {
    CHECK(chosenAt(feature, 85000).options.repair == repair);
    CHECK(chosenAt(feature, 85000).options.levels == 1);  // makes no difference
    TextureOptions given{.levels = 3, .gaps = GapFill::Match};
    CHECK(chosenAt(feature, 85000, given).options.levels == levels);
    CHECK(levels <= stackLevels(given));
    given.repair = 1;
    const TextureOptions kept = chosenAt(feature, 85000, given, {"levels", "repair"}).options;
    CHECK(kept.levels == 3);
    CHECK(kept.repair == 1);
  }
}

TEST_CASE("strokes are followed whatever the swatch is") {
  const TextureOptions options = chosen(kGravel, {}, {}, true).options;
  CHECK(options.follow);
  CHECK(options.symmetry == FieldSymmetry::Quarter);
}

TEST_CASE("every choice has a reason, and what the user has set is kept and has none") {
  const AutomaticOptions free = chosen(kGravel, {}, {}, true);
  CHECK(free.reasons.size() == 4);  // method, follow, symmetry, repair
  CHECK(choiceText(free.options, {}) == "hybrid, repair 10, symmetry 90");
  CHECK(choiceText(chosen(kGravel).options, {}) == "hybrid, repair 10, no follow");
  CHECK(choiceText(chosen(kStripes).options, {}) == "coordinates");
  TextureOptions given;
  given.symmetry = FieldSymmetry::Half, given.follow = false;
  const AutomaticOptions kept = chosen(kGravel, changedOptions(given), given, true);
  CHECK(kept.reasons.size() == 2);  // method, repair
  CHECK(kept.options.symmetry == FieldSymmetry::Half);
  CHECK(kept.options.follow == false);
  // Nothing is said of options that make no difference.
  given = {.field = FieldMethod::Up};
  CHECK(chosen(kGravel, {"field"}, given, true).options.symmetry == FieldSymmetry::None);
  // Typed as it is by default anyway.
  CHECK(chosen(kGravel, {"follow"}).options.follow);
}

TEST_CASE("a named method stays, and so does everything with it") {
  for (int method = 1; method <= static_cast<int>(Method::Random); ++method) {
    TextureOptions given;
    given.method = static_cast<Method>(method);
    const AutomaticOptions out = chosen(kGravel, {}, given);
    CHECK(out.options == given);
    CHECK(out.reasons.empty());
    CHECK(out.warnings.empty());
  }
}

TEST_CASE("a result has the options that auto stood for, and the swatch is analysed once") {
  const fixtures::TestFolder folder;
  Document document = fixtures::sphereDocument(folder, 2000);
  document = fixtures::applied(
      document, SetSwatch{.region = kUnassigned, .reference = {.path = "stripes.png"}});
  CHECK(knownAnalysis(document, document.regions->front()) == nullptr);
  document = fixtures::applied(document, Synthesize{});
  CHECK(document.regions->front().options.method == Method::Auto);
  const auto first = document.results.sources.front();
  CHECK(first->options.method == Method::Hybrid);
  CHECK(first->options.symmetry == FieldSymmetry::Half);
  REQUIRE(first->analysis);
  document = fixtures::applied(document, Synthesize{});
  CHECK(document.results.sources.front() != first);
  CHECK(document.results.sources.front()->analysis == first->analysis);
}

TEST_CASE("a scale that shows too little of a feature, or too few, is told with a better one") {
  CHECK(chosen(kGravel).warnings.empty());
  TextureOptions given;
  given.scale = 0.2;
  const AutomaticOptions fine = chosen(kGravel, {"scale"}, given);
  REQUIRE(fine.warnings.size() == 1);
  CHECK(fine.warnings[0].find("--scale 0.4") != std::string::npos);
  CHECK(fine.options.scale == 0.2);
  given.scale = 10;
  const AutomaticOptions coarse = chosen(kGravel, {"scale"}, given);
  REQUIRE(coarse.warnings.size() == 1);
  CHECK(coarse.warnings[0].find("--scale 3.3") != std::string::npos);
}
