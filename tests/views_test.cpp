#include "app/render/views.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/render/legend.h"
#include "base/errors.h"

using namespace dapple;

namespace {

float luminance(const vec3& c) {
  const auto linear = [](float v) { return std::pow(v, 2.2f); };
  return 0.2126f * linear(c.r) + 0.7152f * linear(c.g) + 0.0722f * linear(c.b);
}

bool isGrey(const vec3& c) {
  return c.r == c.g && c.g == c.b;
}

}  // namespace

TEST_CASE("every view has its name and unknown names are refused") {
  CHECK(viewNamed("colour") == View::Colour);
  CHECK(viewNamed("normals") == View::Normals);
  CHECK(viewNamed("state") == View::State);
  CHECK(viewNamed("patch") == View::Patch);
  CHECK(viewNamed("distortion") == View::Distortion);
  CHECK(viewNamed("order") == View::Order);
  CHECK(viewNamed("regions") == View::Regions);
  CHECK(viewNamed("coordinates") == View::Coordinates);
  CHECK(viewNamed("mapped-normals") == View::MappedNormals);
  CHECK(viewNames("|") ==
        "colour|normals|state|patch|distortion|order|regions|coordinates|roughness|height|metallic|"
        "ao|mapped-normals");
  for (const NamedView& v : allViews()) {
    CHECK(viewNamed(v.name) == v.view);
    CHECK(!v.shows.empty());
  }
  CHECK_THROWS_AS(viewNamed("color"), InvalidInput);
}

TEST_CASE("colours are shown as they are and normals as half of themselves around grey") {
  const std::vector<vec3> column{{0, 0, 1}, {-1, 0, 0}};
  CHECK(viewColours(View::Colour, {.colours = column}).colours == column);
  const ViewColours normals = viewColours(View::Normals, {.normals = column});
  CHECK(normals.colours[0] == vec3(0.5f, 0.5f, 1));
  CHECK(normals.colours[1] == vec3(0, 0.5f, 0.5f));
  CHECK(!normals.legend);
}

TEST_CASE("a column that is not known is refused by the view's name") {
  for (const NamedView& v : allViews()) CHECK_THROWS_AS(viewColours(v.view, {}), InvalidInput);
}

TEST_CASE("the four states differ in hue and, but for patch and matched, in more than red-green") {
  const std::vector<PointState> column{PointState::Free, PointState::Patch, PointState::Gap,
                                       PointState::Matched};
  const std::vector<vec3> c = viewColours(View::State, {.state = column}).colours;
  CHECK(isGrey(c[0]));
  CHECK((c[1].b > c[1].r && c[1].b > c[1].g));
  CHECK((c[2].r > c[2].g && c[2].g > c[2].b));
  CHECK((c[3].g > c[3].r && c[3].g > c[3].b));
  // What remains to an eye without red-green difference: lightness, and yellow against blue.
  for (std::size_t i = 0; i < c.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const float yellow = (c[i].r + c[i].g) / 2 - c[i].b - ((c[j].r + c[j].g) / 2 - c[j].b);
      CHECK(std::abs(luminance(c[i]) - luminance(c[j])) + std::abs(yellow) > 0.15f);
    }
}

TEST_CASE("neighbouring patches get clearly different colours and no patch is grey") {
  std::vector<Index> column;
  for (Index i = 0; i < 200; ++i) column.push_back(i);
  column.push_back(kNone);
  const std::vector<vec3> c = viewColours(View::Patch, {.patch = column}).colours;
  for (Index i = 0; i + 2 < 200; ++i) {
    CHECK(glm::distance(c[i], c[i + 1]) > 0.25f);
    CHECK(glm::distance(c[i], c[i + 2]) > 0.15f);
  }
  CHECK(isGrey(c[200]));
  for (std::size_t i = 0; i < 200; ++i) CHECK(!isGrey(c[i]));
}

TEST_CASE("regions that follow each other have colours apart, calmer than those of patches") {
  std::vector<Index> column;
  for (Index i = 0; i < 36; ++i) column.push_back(i);
  column.push_back(kNone);
  const std::vector<vec3> c = viewColours(View::Regions, {.region = column}).colours;
  const auto saturation = [](const vec3& v) {
    return std::max({v.r, v.g, v.b}) - std::min({v.r, v.g, v.b});
  };
  for (Index i = 0; i < 36; ++i)
    for (Index j = 0; j < i; ++j) {
      CAPTURE(i);
      CAPTURE(j);
      // Neighbours by a lot, and no two of three dozen the same.
      CHECK(glm::distance(c[i], c[j]) > (i - j <= 2 ? 0.15f : 0.05f));
    }
  for (Index i = 0; i < 36; ++i) {
    CHECK(saturation(c[i]) > 0.1f);
    CHECK(saturation(c[i]) < 0.65f);
    CHECK(luminance(c[i]) > 0.2f);
  }
  CHECK(isGrey(c[36]));
}

TEST_CASE("coordinates are red to the right and green downwards, of the swatch or the largest") {
  const float nan = std::nanf("");
  const std::vector<vec2> texel{{0, 0}, {100, 0}, {50, 40}, {nan, 1}, {200, 80}, {3, 3}};
  std::vector<PointState> state(6, PointState::Patch);
  state[5] = PointState::Free;
  const auto known =
      viewColours(View::Coordinates, {.state = state, .texel = texel, .swatchSize = {400, 160}});
  CHECK(glm::distance(vec2(known.colours[0]), vec2(0)) < 1e-6f);
  CHECK(glm::distance(vec2(known.colours[1]), vec2(0.25f, 0)) < 1e-6f);
  CHECK(glm::distance(vec2(known.colours[2]), vec2(0.125f, 0.25f)) < 1e-6f);
  CHECK(glm::distance(vec2(known.colours[4]), vec2(0.5f)) < 1e-6f);
  CHECK(known.colours[0].b == known.colours[4].b);
  CHECK(isGrey(known.colours[3]));
  CHECK(isGrey(known.colours[5]));
  const auto guessed = viewColours(View::Coordinates, {.texel = texel});
  CHECK(glm::distance(vec2(guessed.colours[4]), vec2(1)) < 1e-6f);
  CHECK(glm::distance(vec2(guessed.colours[2]), vec2(0.25f, 0.5f)) < 1e-6f);
  CHECK(!isGrey(guessed.colours[5]));
}

TEST_CASE("a few values far above the others do not take the heat map's colours") {
  std::vector<float> error(100);
  for (std::size_t i = 0; i < 100; ++i) error[i] = i < 95 ? 0.01f * static_cast<float>(i) : 300;
  const ViewColours v = viewColours(View::Distortion, {.error = error});
  REQUIRE(v.legend);
  CHECK(v.legend->low == 0);
  CHECK(v.legend->high == doctest::Approx(1.8));
  CHECK(glm::distance(v.colours[90], heatColour(0.5f)) < 0.02f);
  CHECK(v.colours[99] == heatColour(1));
}

TEST_CASE("the heat map grows lighter all the way in even steps") {
  float last = std::cbrt(luminance(heatColour(0)));
  const float whole = std::cbrt(luminance(heatColour(1))) - last;
  CHECK(whole > 0.6f);
  for (int i = 1; i <= 32; ++i) {
    const float now = std::cbrt(luminance(heatColour(i / 32.0f)));
    CHECK(now - last > 0.4f * whole / 32);
    CHECK(now - last < 2.0f * whole / 32);
    last = now;
  }
  CHECK(heatColour(-1) == heatColour(0));
  CHECK(heatColour(2) == heatColour(1));
  CHECK(heatColour(std::numeric_limits<float>::quiet_NaN()) == heatColour(0));
}

TEST_CASE("the error's range goes from its smallest to its largest finite value") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> column{2, nan, 0.5f, std::numeric_limits<float>::infinity(), 3};
  const ViewColours v = viewColours(View::Distortion, {.error = column});
  REQUIRE(v.legend);
  CHECK(v.legend->low == 0.5f);
  CHECK(v.legend->high == 3.0f);
  CHECK(v.colours[2] == heatColour(0));
  CHECK(v.colours[4] == heatColour(1));
  CHECK(glm::distance(v.colours[0], heatColour(0.6f)) < 0.02f);
  CHECK(isGrey(v.colours[1]));
  CHECK(isGrey(v.colours[3]));
}

TEST_CASE("points that were never decided are grey in the order, and a constant has a colour") {
  const std::vector<Index> column{0, kNone, 10};
  const ViewColours v = viewColours(View::Order, {.order = column});
  CHECK(v.colours[0] == heatColour(0));
  CHECK(isGrey(v.colours[1]));
  CHECK(v.colours[2] == heatColour(1));
  CHECK(v.legend->high == 10);

  const std::vector<float> constant{7, 7};
  CHECK(viewColours(View::Distortion, {.error = constant}).colours[1] == heatColour(0));
  const std::vector<Index> never{kNone};
  CHECK(!viewColours(View::Order, {.order = never}).legend);
}

TEST_CASE("the legend shows its bar from low to high and leaves the rest of the picture alone") {
  Image picture{640, 480, 4, std::vector<float>(std::size_t{640} * 480 * 4, 0.25f)};
  const Image before = picture;
  drawLegend(picture, {0, 1});
  // Two pixels a dot: margin 4 and gap 2 dots to the left, the panel is 17 dots high.
  const int row = 480 - 2 * (4 + 17) + 2 * 3;
  const auto pixel = [&](int x) {
    return vec3(picture.at(x, row, 0), picture.at(x, row, 1), picture.at(x, row, 2));
  };
  CHECK(pixel(12) == heatColour(0));
  CHECK(pixel(12 + 191) == heatColour(1));
  CHECK(luminance(pixel(60)) < luminance(pixel(150)));
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 640; ++x)
      if (x >= 220 || y < 430) REQUIRE(picture.at(x, y, 0) == before.at(x, y, 0));
}

TEST_CASE("different numbers make different legends") {
  const Image blank{320, 240, 3, std::vector<float>(std::size_t{320} * 240 * 3, 1.0f)};
  Image a = blank, b = blank, c = blank;
  drawLegend(a, {0, 1});
  drawLegend(b, {-1.5e-7f, 1});
  drawLegend(c, {0, 2});
  CHECK(a.pixels != b.pixels);
  CHECK(a.pixels != c.pixels);
}

TEST_CASE("a picture too small for a legend stays as it is") {
  Image picture{64, 64, 3, std::vector<float>(std::size_t{64} * 64 * 3, 0.5f)};
  const std::vector<float> before = picture.pixels;
  drawLegend(picture, {0, 1});
  CHECK(picture.pixels == before);
}

TEST_CASE("material channels are grey from 0 to 1, or as wide as they reach") {
  const std::vector<float> usual{0, 0.25f, 1, std::nanf("")}, wide{-1, 0, 3};
  const auto grey = viewColours(View::Roughness, {.roughness = usual});
  CHECK_FALSE(grey.legend);
  CHECK(grey.colours[0] == vec3(0));
  CHECK(grey.colours[1] == vec3(0.25f));
  CHECK(grey.colours[2] == vec3(1));
  CHECK(grey.colours[3].r > 0);
  const auto stretched = viewColours(View::Height, {.height = wide});
  CHECK(stretched.colours[0] == vec3(0));
  CHECK(stretched.colours[1] == vec3(0.25f));
  CHECK(stretched.colours[2] == vec3(1));
}
