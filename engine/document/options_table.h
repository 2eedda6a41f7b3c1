// The one table of options: command line, panels, project files, reports and documentation read it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "synthesis/texture_options.h"

namespace dapple {

using OptionField =
    std::variant<bool TextureOptions::*, int TextureOptions::*, double TextureOptions::*,
                 std::uint64_t TextureOptions::*, vec3 TextureOptions::*, Method TextureOptions::*,
                 GapFill TextureOptions::*, GridAssign TextureOptions::*,
                 Tileable TextureOptions::*, FieldMethod TextureOptions::*,
                 FieldSymmetry TextureOptions::*, Creases TextureOptions::*>;

struct OptionRow {
  std::string_view name;     // as on the command line, without the dashes
  OptionField field;         // its default is the one of TextureOptions{}
  double low = 0, high = 0;  // numbers: the closed range
  bool odd = false;          // whole numbers: only odd ones
  std::string_view choices;  // enumerations: names by value, separated by '|'
  std::string_view help;     // one sentence, with the unit
  // Whether the value makes a difference with these others; null: always.
  bool (*counts)(const TextureOptions&) = nullptr;

  bool countsIn(const TextureOptions& options) const { return !counts || counts(options); }
};

std::span<const OptionRow> optionsTable();
const OptionRow* findOption(std::string_view name);

// Parses and checks a value. Throws InvalidInput that names the option, the value and what is
// allowed.
void setOption(TextureOptions& options, const OptionRow& row, std::string_view value);

// The value as setOption() reads it.
std::string optionText(const TextureOptions& options, const OptionRow& row);

// What is allowed, for help and messages: "8 to 128", "3 to 31, odd", "hybrid|patches", "yes|no",
// "x,y,z".
std::string optionRange(const OptionRow& row);

// Throws InvalidInput for the first field that is out of its range.
void validate(const TextureOptions& options);

}  // namespace dapple
