// The rules come from measured scores: mean F, and F along the directions, of 22 swatches on the
// bunny. With 40 000 points patches that follow directions without symmetry .52 / .49, with
// --symmetry 180 .59 / .47, that do not follow them .59 / .30: following thus costs quality only
// where there are directions of a whole turn, and not following costs all direction. With 85 000
// points, of the 9 swatches with a direction: the best of these .64 / .56, coordinates .66 / .63;
// of the 13 others .71 and .61. Coordinates with --symmetry 180 gain .09 on a twill and lose as
// much on wood, .16 on bricks. Coordinates want room: of 8 swatches with a direction, which the
// surface holds 0.8, 2.4, 4.2, 5.9 and 10 times (12 000 to 150 000 points), patches that follow
// them have .46, .59, .56, .60 and .68 with seams repaired, coordinates .44, .55, .59, .67 and
// .69.
#include "document/automatic_options.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "document/channels.h"

namespace dapple {
namespace {

constexpr double kFeatureSpacings = 8;    // a feature has at least, or it is not recognised
constexpr double kFeaturesOfSurface = 3;  // the surface is wide, at least
constexpr double kRoomy = 3;  // swatches that the surface holds for coordinates, at least
constexpr std::string_view kFollowDistortion = "3.2";

struct Chooser {
  const std::vector<std::string>& kept;
  AutomaticOptions out;

  void choose(std::string_view name, std::string_view value, const std::string& reason) {
    const OptionRow& row = *findOption(name);
    if (!row.countsIn(out.options)) return;
    if (std::find(kept.begin(), kept.end(), name) != kept.end()) return;
    setOption(out.options, row, value);
    out.reasons.push_back(fmt::format("{} {}: {}.", name, value, reason));
  }
};

std::string patternText(const SwatchAnalysis& swatch) {
  switch (swatch.kind()) {
    case PatternKind::Isotropic:
      return "the swatch looks the same however it is turned";
    case PatternKind::Directional:
      return "the swatch has a direction";
    case PatternKind::Regular:
      return "the swatch repeats and has a direction";
  }
  return {};
}

void chooseMethod(const AutomaticInput& input, Chooser& chooser) {
  const double scale = chooser.out.options.scale;
  const double holds = static_cast<double>(input.points) / (scale * scale * input.swatch.area);
  const bool turns = input.swatch.kind() != PatternKind::Isotropic;
  const std::string_view method = turns && holds >= kRoomy ? "coordinates" : "hybrid";
  setOption(chooser.out.options, *findOption("method"), method);
  std::string reason = patternText(input.swatch);
  if (turns)
    reason += fmt::format(", and the surface {} than {:g} times as large",
                          holds >= kRoomy ? "is more" : "is less", kRoomy);
  chooser.out.reasons.push_back(fmt::format("method {}: {}.", method, reason));
}

// Of patches: coordinates follow directions at no cost.
void chooseDirections(const AutomaticInput& input, Chooser& chooser) {
  const SwatchAnalysis& swatch = input.swatch;
  if (chooser.out.options.method == Method::Coordinates) return;
  if (swatch.kind() == PatternKind::Isotropic && !input.strokes) {
    chooser.choose("follow", "no", "patches may run straight on, with fewer seams");
    return;
  }
  chooser.choose("follow", "yes", input.strokes ? "strokes are drawn" : "turns show in the swatch");
  if (swatch.folds() == 2)
    chooser.choose("symmetry", "180", "half a turn does not show in it");
  else if (swatch.folds() != 1)
    chooser.choose("symmetry", "90", "a quarter turn does not show in it");
  else
    chooser.choose("distortion", kFollowDistortion,
                   "only a whole turn leaves it as it is, and larger patches have fewer seams");
}

// Lengths in spacings; the surface is taken as a square. From the middle of a feature to where
// nothing is like it is half of what one sees as one.
void warnOfScale(const AutomaticInput& input, AutomaticOptions& out) {
  const double pixels = 2 * input.swatch.feature;
  const double feature = pixels * out.options.scale;
  const double side = std::sqrt(static_cast<double>(input.points));
  const double least = kFeatureSpacings / pixels, most = side / kFeaturesOfSurface / pixels;
  if (feature > side / kFeaturesOfSurface)
    out.warnings.push_back(
        fmt::format("the surface is only {:.1f} of the swatch's features wide; --scale {:.2g} "
                    "would make it {:g}",
                    side / feature, most, kFeaturesOfSurface));
  else if (feature < kFeatureSpacings && least <= most)
    out.warnings.push_back(fmt::format(
        "the swatch's features are only {:.1f} points wide; --scale {:.2g} would make them {:g}",
        feature, least, kFeatureSpacings));
}

}  // namespace

AutomaticOptions chosenOptions(const TextureOptions& given, const AutomaticInput& input) {
  Chooser chooser{input.kept, {.options = given}};
  if (given.method != Method::Auto) return chooser.out;
  chooseMethod(input, chooser);
  chooseDirections(input, chooser);
  warnOfScale(input, chooser.out);
  return chooser.out;
}

std::vector<std::string> changedOptions(const TextureOptions& options) {
  std::vector<std::string> names;
  for (const OptionRow& row : optionsTable())
    if (optionText(options, row) != optionText(TextureOptions{}, row)) names.emplace_back(row.name);
  return names;
}

std::shared_ptr<const SwatchAnalysis> knownAnalysis(const Document& document,
                                                    const Region& region) {
  const auto& options = region.options;
  for (const auto& source : document.results.sources)
    if (source->analysis && source->swatch == region.swatch &&
        source->options.heightWeight == options.heightWeight &&
        sameHeights(source->maps.get(), region.maps.get(), options))
      return source->analysis;
  return nullptr;
}

AutomaticOptions chosenOptions(const Document& document, const Region& region,
                               const SwatchAnalysis& swatch) {
  std::size_t points = document.size();
  if (document.labels)
    points = static_cast<std::size_t>(
        std::count(document.labels->begin(), document.labels->end(), region.id));
  return chosenOptions(region.options, {.swatch = swatch,
                                        .points = points,
                                        .strokes = region.strokes && !region.strokes->empty(),
                                        .kept = changedOptions(region.options)});
}

TextureOptions knownOptions(const Document& document, const Region& region) {
  if (region.options.method != Method::Auto || !region.swatch) return region.options;
  const auto analysis = knownAnalysis(document, region);
  return analysis ? chosenOptions(document, region, *analysis).options : region.options;
}

std::string choiceText(const TextureOptions& chosen, const TextureOptions& given) {
  std::string text;
  for (const OptionRow& row : optionsTable()) {
    const std::string value = optionText(chosen, row);
    if (row.name == "method")
      text = value + text;
    else if (value != optionText(TextureOptions{}, row) && value != optionText(given, row))
      text += row.choices == "yes|no" ? fmt::format(", {}{}", value == "no" ? "no " : "", row.name)
                                      : fmt::format(", {} {}", row.name, value);
  }
  return text;
}

}  // namespace dapple
