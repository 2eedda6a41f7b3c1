// What `--method auto` stands for: the one place that decides it, for command line and editor.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "document/document.h"
#include "document/options_table.h"
#include "swatch/swatch_analysis.h"

namespace dapple {

inline constexpr int kMostAutomaticLevels = 6;  // of the swatch's stack, when gaps are matched

struct AutomaticInput {
  const SwatchAnalysis& swatch;
  std::size_t points = 0;                // that are to be textured
  bool strokes = false;                  // there are some
  const std::vector<std::string>& kept;  // names of options that the user has set
};

struct AutomaticOptions {
  TextureOptions options;             // the method is never Auto
  std::vector<std::string> reasons;   // what was chosen and why, a sentence each
  std::vector<std::string> warnings;  // about a scale that is left as it is
};

// `given` with a method, and with what goes with it of the options that the user has not set. With
// another method than Auto just as given.
AutomaticOptions chosenOptions(const TextureOptions& given, const AutomaticInput& input);

// Names of the options that differ from their defaults: what was set, as far as one can see.
std::vector<std::string> changedOptions(const TextureOptions& options);

// The analysis of the region's swatch, with the heights that count beside its colours, as far as
// one of the document's results has it; null: none.
std::shared_ptr<const SwatchAnalysis> knownAnalysis(const Document& document, const Region& region);

// What Auto stands for in a region of the document: what differs from its default is kept.
AutomaticOptions chosenOptions(const Document& document, const Region& region,
                               const SwatchAnalysis& swatch);

// The options of a region, with what Auto stands for as far as its swatch has been analysed.
TextureOptions knownOptions(const Document& document, const Region& region);

// "hybrid, symmetry 180": the method, and those of its options that differ from their defaults and
// from `given`.
std::string choiceText(const TextureOptions& chosen, const TextureOptions& given);

}  // namespace dapple
