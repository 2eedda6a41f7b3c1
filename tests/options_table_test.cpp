#include "document/options_table.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "base/errors.h"
#include "document/automatic_options.h"
#include "document/texture_job.h"
#include "fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

// Some other value that the option allows.
std::string anotherValue(const OptionRow& row, const TextureOptions& options) {
  const std::string now = optionText(options, row);
  std::vector<std::string> values{"7,1,2", fmt::format("{}", row.low), fmt::format("{}", row.high)};
  for (std::size_t begin = 0; begin < row.choices.size();) {
    const std::size_t end = std::min(row.choices.find('|', begin), row.choices.size());
    values.emplace_back(row.choices.substr(begin, end - begin));
    begin = end + 1;
  }
  for (const std::string& value : values) {
    TextureOptions other = options;
    try {
      setOption(other, row, value);
    } catch (const InvalidInput&) {
      continue;
    }
    if (optionText(other, row) != now) return value;
  }
  FAIL("no other value for " << row.name);
  return now;
}

PreparedScan bumpyBall() {
  PreparedScan out;
  PointSet& points = out.scan.points;
  points = makeSphere(700, 1);
  for (vec3& p : points.positions) p *= 1 + 0.05f * std::sin(9 * p.x + 5 * p.y);
  Workers workers(1);
  Monitor monitor(workers);
  out.neighborhoods = buildNeighborhoods(points.positions, 25, monitor);
  out.spacing = static_cast<float>(meanSpacing(out.neighborhoods, points.positions));
  return out;
}

}  // namespace

TEST_CASE("an option that is said not to count changes nothing") {
  const PreparedScan ball = bumpyBall();
  const Swatch swatch = swatchOf(blobs(24), Tileable::No), tile = swatchOf(blobs(24));
  Workers workers(1);
  Monitor monitor(workers);
  const SwatchAnalysis analysis = analyse(swatch, monitor);
  const auto textured = [&](const TextureOptions& options) {
    const TextureOptions chosen = chosenOptions(options, {.swatch = analysis,
                                                          .points = ball.scan.points.size(),
                                                          .kept = changedOptions(options)})
                                      .options;
    const bool repeats = options.method == Method::Tiling;
    return texturePoints(ball, repeats ? tile : swatch, {}, chosen, monitor).map;
  };
  std::size_t compared = 0;
  for (int method = 0; method <= static_cast<int>(Method::Random); ++method)
    for (const GapFill gaps : {GapFill::Cut, GapFill::Match}) {
      TextureOptions options;
      options.method = static_cast<Method>(method), options.gaps = gaps, options.grid = 7;
      const SourceMap before = textured(options);
      for (const OptionRow& row : optionsTable()) {
        if (row.countsIn(options)) continue;
        CAPTURE(row.name);
        CAPTURE(optionText(options, *findOption("method")));
        TextureOptions other = options;
        setOption(other, row, anotherValue(row, options));
        const SourceMap after = textured(other);
        CHECK(after.colour == before.colour);
        CHECK(after.texel == before.texel);
        CHECK(after.patch == before.patch);
        ++compared;
      }
    }
  CHECK(compared > 60);
}

TEST_CASE("an option that is said to count by the method changes something") {
  const PreparedScan ball = bumpyBall();
  const Swatch swatch = swatchOf(blobs(24), Tileable::No);
  Workers workers(1);
  Monitor monitor(workers);
  const std::pair<Method, const char*> kCounts[] = {
      {Method::Hybrid, "gaps"},        {Method::Hybrid, "follow"},
      {Method::Patches, "distortion"}, {Method::Patches, "field"},
      {Method::Match, "coherent"},     {Method::Match, "levels"},
      {Method::Match, "symmetry"},     {Method::Grid, "grid"},
      {Method::Grid, "assign"},        {Method::Grid, "grid-seams"},
      {Method::Hybrid, "size-limit"},  {Method::Coordinates, "passes"},
      {Method::Coordinates, "field"},  {Method::Mapping, "follow"},
      {Method::Mapping, "field"}};
  for (const auto& [method, name] : kCounts) {
    CAPTURE(name);
    TextureOptions options;
    options.method = method, options.grid = 7;
    const OptionRow& row = *findOption(name);
    CHECK(row.countsIn(options));
    TextureOptions other = options;
    setOption(other, row, anotherValue(row, options));
    CHECK(texturePoints(ball, swatch, {}, other, monitor).map.texel !=
          texturePoints(ball, swatch, {}, options, monitor).map.texel);
  }
}
