// What the analysis makes of real swatches, and the options that follow from it.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "document/automatic_options.h"
#include "io/image_io.h"

using namespace dapple;

namespace {

struct Expected {
  const char* file;
  PatternKind kind;
  int folds;
  double leastFeature, mostFeature;  // pixels, as measured on the picture by eye
};

using enum PatternKind;

// Text, scales, knit and roofs have an up; grain has none; what is bedded, not laid, has no
// direction at all. Of the roof tiles only the rows show through the dust. No two of the letters
// are alike, so that nothing tells that they have an up.
constexpr Expected kShared[] = {
    {"acg_bricks102.png", Isotropic, 0, 12, 50},  {"acg_fabric015.png", Regular, 2, 4, 16},
    {"acg_rocks023.png", Isotropic, 0, 4, 14},    {"acg_roofingtiles002.png", Regular, 2, 6, 26},
    {"acg_terrazzo009.png", Isotropic, 0, 4, 20}, {"acg_wood004.png", Directional, 2, 5, 40},
    {"acg_woodfloor020.png", Regular, 2, 4, 16},  {"efros_basketweave.png", Regular, 2, 8, 60},
    {"efros_berries.png", Isotropic, 0, 10, 44},  {"efros_olives.png", Isotropic, 0, 8, 32},
    {"embark_water.jpg", Isotropic, 0, 10, 80},   {"gimp_burlap.png", Regular, 2, 4, 14},
    {"gimp_leopard.png", Isotropic, 0, 4, 12},    {"ph_aerial_rocks.png", Isotropic, 0, 14, 80},
    {"ph_coast_sand.png", Isotropic, 0, 5, 80},   {"ph_rock_cracked.png", Isotropic, 0, 5, 50},
    {"ps_reptil_skin.png", Regular, 1, 4, 16},    {"ps_text.png", Regular, 1, 5, 24},
    {"sk_brick.png", Regular, 2, 14, 60},         {"sk_grass.png", Isotropic, 0, 5, 40},
    {"sk_gravel.png", Isotropic, 0, 8, 32},       {"wl_161.jpg", Regular, 2, 5, 14},
};
constexpr Expected kOwn[] = {
    {"bricks.png", Regular, 1, 8, 24},     {"knit.png", Regular, 1, 4, 16},
    {"leaves.png", Isotropic, 0, 8, 36},   {"leopard.png", Isotropic, 0, 7, 22},
    {"letters.png", Regular, 2, 7, 30},    {"lichen.png", Isotropic, 0, 10, 45},
    {"pebbles.png", Isotropic, 0, 8, 26},  {"ripples.png", Regular, 1, 4, 12},
    {"scales.png", Regular, 1, 6, 18},     {"stripes.png", Regular, 1, 7, 12},
    {"terrazzo.png", Isotropic, 0, 8, 40}, {"wood.png", Directional, 1, 5, 24},
};

void check(const std::filesystem::path& folder, std::span<const Expected> table) {
  if (!std::filesystem::exists(folder)) {
    MESSAGE("skipped: no swatches at ", folder.string());
    return;
  }
  Workers workers(2);
  Monitor monitor(workers);
  for (const Expected& expected : table) {
    CAPTURE(std::string(expected.file));
    const Swatch swatch =
        makeSwatch(readImage(folder / expected.file), Tileable::Auto, 1, expected.file);
    const SwatchAnalysis a = analyse(swatch, monitor);
    CHECK(patternName(a.kind()) == patternName(expected.kind));
    CHECK(a.folds() == expected.folds);
    CHECK(a.feature >= expected.leastFeature);
    CHECK(a.feature <= expected.mostFeature);
    const AutomaticOptions chosen =
        chosenOptions({}, {.swatch = a, .points = 1'000'000, .strokes = false, .kept = {}});
    CHECK(chosen.options.method == (a.turnShows() ? Method::Coordinates : Method::Hybrid));
    CHECK(chosen.options.follow == (expected.kind != Isotropic));
    CHECK(chosen.options.scale == 1);
  }
}

}  // namespace

TEST_CASE("the shared swatches are told apart") {
  check(std::filesystem::path(DAPPLE_SHARED_DATA) / "textures", kShared);
}

TEST_CASE("the project's own swatches are told apart") {
  check(DAPPLE_OWN_SWATCHES, kOwn);
}
