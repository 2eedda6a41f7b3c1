// The rules come from measured scores: mean F, and F along the directions, of the 22 shared
// swatches on 12 000, 35 000 and 85 000 points of the bunny.
//
// Method. With 85 000 points, of the 9 swatches in which a turn shows: coordinates .69 / .67,
// tiling .70 / .67 (on the armadillo both .59 / .54), patches that follow directions .62 / .58,
// with --symmetry 180 .67 / .57, that do not follow them .68 / .26. Of the 13 others patches that
// do not follow have .72, with --symmetry 180 .69, coordinates .69, tiling .69. With 12 000 and
// 35 000 points, two seeds, those of the 9 of which the surface is 7 to 16 features wide have
// .56 / .51 with coordinates, with patches and --symmetry 180, which may stand on their heads,
// .56 / .48; where it is 5 to 7 wide, .56 / .51 and .58 / .48; where it is 3 to 5, .53 / .49 and
// .60 / .48. On 60 000 points of the armadillo, 6.8 wide, bricks have .68 and .79. Roof tiles of
// which only the rows show have .58 / .34 when patches run on, .56 / .43 with --symmetry 180,
// .56 / .53 with coordinates.
//
// The other options, hybrid with 85 000 points, 6 isotropic swatches. Seams mended by 1.5, 3, 6 and
// 12 pixels: .675, .679, .682 and .683, and the widest is best where features are large. Gaps that
// are matched: .639 with one level, .641 with as many as features are large; widened ones are
// worse (methods: section 4).
// --size-limit .8, its default, is best whatever the swatch: .679, with .5 .600 and with 1 .635. So
// is --distortion 1.6: .8 gains .02 on fine stones, loses .12 on berries; 3.2 gains .03 on berries,
// loses .38 on water. It only helps patches that follow whole turns where they have little room:
// .53 for .52 with 12 000 points.
//
// Scale. Pixels smaller than points alias: 12 000 points, which are 2 to 5 features wide, have .47
// with --scale 1 and .27 with .5. It is only changed where nothing could be seen otherwise.
#include "document/automatic_options.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "document/channels.h"

namespace dapple {
namespace {

constexpr double kFeatureSpacings = 8;    // a feature has at least, or it is not recognised
constexpr double kFeaturesOfSurface = 3;  // the surface is wide, at least
// Beyond these nothing of the pattern could be seen, so that the scale is not left as it is.
constexpr double kVisibleSpacings = 4, kVisibleFeatures = 1.5;
constexpr double kRoomy = 7;  // features that the surface is wide for coordinates, at least
constexpr double kLeastRepair = 3, kMostRepair = 12;  // pixels
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

// Of a feature as one sees it: from its middle to where nothing is like it is half of that.
double featurePixels(const AutomaticInput& input) {
  return 2 * input.swatch.feature;
}

// In spacings: the surface is taken as a square.
double surfaceSide(const AutomaticInput& input) {
  return std::sqrt(static_cast<double>(input.points));
}

// In powers of two, so that a region that grows a little keeps it.
void chooseScale(const AutomaticInput& input, Chooser& chooser) {
  const double pixels = featurePixels(input), side = surfaceSide(input);
  const double given = chooser.out.options.scale, shown = given * pixels;
  const double least = kFeatureSpacings / pixels, most = side / kFeaturesOfSurface / pixels;
  const auto power = [](double scale) {
    return fmt::format("{:g}", std::clamp(std::exp2(std::round(std::log2(scale))), 0.015625, 64.0));
  };
  if (side < kVisibleFeatures * shown && std::max(least, most) < given)
    chooser.choose("scale", power(std::max(least, most)),
                   fmt::format("the surface would be only {:.2g} of the swatch's features wide",
                               side / shown));
  else if (shown < kVisibleSpacings && least <= most)
    chooser.choose("scale", power(least),
                   fmt::format("the swatch's features would be only {:.2g} points wide", shown));
}

std::string patternText(const SwatchAnalysis& swatch) {
  switch (swatch.kind()) {
    case PatternKind::Isotropic:
      return "the swatch looks the same however it is turned";
    case PatternKind::Directional:
      return "the swatch has a direction";
    case PatternKind::Regular:
      return swatch.turnShows() ? "the swatch repeats and has a direction"
                                : "the swatch repeats, and turns hardly show in it";
  }
  return {};
}

void chooseMethod(const AutomaticInput& input, Chooser& chooser) {
  const double wide = surfaceSide(input) / featurePixels(input) / chooser.out.options.scale;
  const bool turns = input.swatch.turnShows();
  const std::string_view method = turns && wide >= kRoomy ? "coordinates" : "hybrid";
  setOption(chooser.out.options, *findOption("method"), method);
  std::string reason = patternText(input.swatch);
  if (turns)
    reason += fmt::format(", and the surface is {} than {:g} of its features wide",
                          wide >= kRoomy ? "more" : "less", kRoomy);
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
    chooser.choose("symmetry", "180", "half a turn hardly shows in it");
  else if (swatch.folds() != 1)
    chooser.choose("symmetry", "90", "a quarter turn does not show in it");
  else
    chooser.choose("distortion", kFollowDistortion,
                   "only a whole turn leaves it as it is, and larger patches have fewer seams");
}

// What is set aside for seams and gaps, by the size of features.
void chooseWidths(const AutomaticInput& input, Chooser& chooser) {
  const double feature = input.swatch.feature;
  const double repair = std::clamp(std::round(feature), kLeastRepair, kMostRepair);
  if (repair > kLeastRepair)
    chooser.choose("repair", fmt::format("{:g}", repair),
                   fmt::format("the swatch's features are {:.0f} pixels wide", 2 * feature));
  const int levels = 1 + static_cast<int>(std::ceil(std::log2(std::max(feature, 1.0))));
  chooser.choose("levels", fmt::format("{}", std::min(levels, kMostAutomaticLevels)),
                 "the coarsest one tells features apart, not their parts");
}

// Of a scale that the user has set, or that shows something at least. Lengths in spacings.
void warnOfScale(const AutomaticInput& input, AutomaticOptions& out) {
  const double pixels = featurePixels(input), side = surfaceSide(input);
  const double feature = pixels * out.options.scale;
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
  chooseScale(input, chooser);
  chooseMethod(input, chooser);
  chooseDirections(input, chooser);
  chooseWidths(input, chooser);
  if (chooser.out.options.scale == given.scale) warnOfScale(input, chooser.out);
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
