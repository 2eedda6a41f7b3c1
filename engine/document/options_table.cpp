#include "document/options_table.h"

#include <array>
#include <charconv>
#include <cmath>
#include <type_traits>
#include <vector>

#include "base/errors.h"

namespace dapple {
namespace {

using T = TextureOptions;
constexpr double kMostSeed = 9007199254740992.0;  // 2^53: exact in every JSON reader

// Auto may choose it.
constexpr bool isHybrid(const T& o) {
  return o.method == Method::Auto || o.method == Method::Hybrid;
}
constexpr bool growsPatches(const T& o) {
  return isHybrid(o) || o.method == Method::Patches;
}
constexpr bool fillsByMatching(const T& o) {
  return isHybrid(o) && o.gaps == GapFill::Match;
}
constexpr bool matches(const T& o) {
  return o.method == Method::Match || fillsByMatching(o);
}
constexpr bool matchesOrGrid(const T& o) {
  return matches(o) || o.method == Method::Grid;
}
constexpr bool isGrid(const T& o) {
  return o.method == Method::Grid;
}
constexpr bool pastesSquares(const T& o) {
  return isGrid(o) && o.assign == GridAssign::Multi;
}
constexpr bool isCoordinates(const T& o) {
  return o.method == Method::Coordinates;
}
constexpr bool isMapping(const T& o) {
  return o.method == Method::Mapping;
}
constexpr bool hasSeams(const T& o) {
  return growsPatches(o) || matchesOrGrid(o) || isMapping(o) || o.method == Method::Tiling;
}
constexpr bool isDirected(const T& o) {
  return hasSeams(o) || isCoordinates(o);
}
constexpr bool isSpread(const T& o) {
  return isDirected(o) && o.field != FieldMethod::Up && o.field != FieldMethod::Random;
}
constexpr bool isFolded(const T& o) {
  return isSpread(o) && o.field != FieldMethod::Spread;
}
constexpr bool mayFollow(const T& o) {
  return (growsPatches(o) || isMapping(o)) && o.field != FieldMethod::Random;
}

constexpr std::array kTable = {
    OptionRow{.name = "method",
              .field = &T::method,
              .choices = "auto|hybrid|coordinates|tiling|patches|match|grid|mapping|triplanar|"
                         "random",
              .help = "how points get their colour; auto chooses by the swatch, triplanar and "
                      "random are baselines"},
    OptionRow{.name = "neighbours",
              .field = &T::neighbours,
              .low = 8,
              .high = 128,
              .help = "nearest neighbours of a point that every stage looks at"},
    OptionRow{.name = "levels",
              .field = &T::levels,
              .low = 1,
              .high = 8,
              .help = "match: levels of the point hierarchy, coarse to fine",
              .counts = matches},
    OptionRow{.name = "coherent",
              .field = &T::coherent,
              .choices = "yes|no",
              .help = "match: continue the neighbours' texels instead of searching everywhere; "
                      "grid: prefer to",
              .counts = matchesOrGrid},
    OptionRow{.name = "scale",
              .field = &T::scale,
              .low = 0.01,
              .high = 100,
              .help = "size of a swatch pixel on the surface, in mean point spacings"},
    OptionRow{.name = "gaps",
              .field = &T::gaps,
              .choices = "cut|match",
              .help = "hybrid: align patches and cut along the best seam, or match the gaps only",
              .counts = isHybrid},
    OptionRow{.name = "expand",
              .field = &T::expand,
              .choices = "yes|no",
              .help = "hybrid with --gaps match: widen the gaps by one neighbourhood first",
              .counts = fillsByMatching},
    OptionRow{.name = "grid",
              .field = &T::grid,
              .low = 3,
              .high = 31,
              .odd = true,
              .help = "grid: swatch pixels along each side of the square that is matched",
              .counts = isGrid},
    OptionRow{.name = "assign",
              .field = &T::assign,
              .choices = "single|multi",
              .help = "grid: a match colours its own point, or all open points of its square",
              .counts = isGrid},
    OptionRow{.name = "grid-seams",
              .field = &T::gridSeams,
              .choices = "yes|no",
              .help = "grid with --assign multi: cut the squares where they differ least",
              .counts = pastesSquares},
    OptionRow{.name = "grid-neighbours",
              .field = &T::gridNeighbours,
              .low = 0,
              .high = 4096,
              .help = "grid: most points that one square is filled from, 0 for all it covers",
              .counts = isGrid},
    OptionRow{
        .name = "passes",
        .field = &T::passes,
        .low = 1,
        .high = 32,
        .help = "coordinates: visits of every point on the finest level; coarser ones get more",
        .counts = isCoordinates},
    OptionRow{.name = "repair",
              .field = &T::repair,
              .low = 0,
              .high = 64,
              .help = "all but coordinates: swatch pixels on both sides of a seam within which "
                      "coordinates mend it, 0 to leave seams as they are",
              .counts = hasSeams},
    OptionRow{.name = "height-weight",
              .field = &T::heightWeight,
              .low = 0,
              .high = 10,
              .help = "how much a swatch's height map counts where its places are compared, 1 for "
                      "as much as the colours",
              .counts = isDirected},
    OptionRow{.name = "tileable",
              .field = &T::tileable,
              .choices = "auto|yes|no",
              .help = "whether the swatch repeats seamlessly"},
    OptionRow{.name = "up",
              .field = &T::up,
              .help = "where the swatch's top points on the surface, as a model direction"},
    OptionRow{.name = "field",
              .field = &T::field,
              .choices = "smooth|spread|diffuse|up|random",
              .help = "directions between strokes: smooth everywhere, spread from the nearest, or "
                      "diffuse (slow); up and random ignore strokes",
              .counts = isDirected},
    OptionRow{.name = "symmetry",
              .field = &T::symmetry,
              .choices = "none|180|90",
              .help = "turn in degrees after which a direction counts as the same",
              .counts = isFolded},
    OptionRow{.name = "creases",
              .field = &T::creases,
              .choices = "carry|break",
              .help = "directions go on across sharp edges, or end there",
              .counts = isSpread},
    OptionRow{.name = "follow",
              .field = &T::follow,
              .choices = "yes|no",
              .help =
                  "patches turn with the directions everywhere, in place of running straight on "
                  "from where they start",
              .counts = mayFollow},
    OptionRow{.name = "distortion",
              .field = &T::distortion,
              .low = 0,
              .high = 1e9,
              .help = "patches: largest distortion before a gap; 1.6 is about 15 % of stretch",
              .counts = growsPatches},
    OptionRow{.name = "size-limit",
              .field = &T::sizeLimit,
              .low = 0.05,
              .high = 1,
              .help = "patches: largest share of a swatch that does not tile, along each side",
              .counts = growsPatches},
    OptionRow{.name = "seed",
              .field = &T::seed,
              .low = 0,
              .high = kMostSeed,
              .help = "the same seed gives the same bytes"},
    OptionRow{.name = "threads",
              .field = &T::threads,
              .low = 0,
              .high = 256,
              .help = "threads to work with, 0 for one a processor; the result is the same"},
};

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

[[noreturn]] void refuse(const OptionRow& row, std::string_view value) {
  throw InvalidInput(
      fmt::format("--{}: '{}' is not allowed; give {}", row.name, value, optionRange(row)));
}

template <class Number>
bool parseNumber(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

template <class Number>
void setNumber(const OptionRow& row, std::string_view text, Number& field) {
  Number value{};
  if (!parseNumber(text, value)) refuse(row, text);
  const double wide = static_cast<double>(value);
  if (!(wide >= row.low && wide <= row.high)) refuse(row, text);
  if constexpr (std::is_same_v<Number, int>)
    if (row.odd && value % 2 == 0) refuse(row, text);
  field = value;
}

void setVector(const OptionRow& row, std::string_view text, vec3& field) {
  const auto parts = split(text, ',');
  vec3 value(0);
  if (parts.size() != 3) refuse(row, text);
  for (int axis = 0; axis < 3; ++axis)
    if (!parseNumber(parts[static_cast<std::size_t>(axis)], value[axis])) refuse(row, text);
  const float length = glm::length(value);
  if (!(length > 1e-20f && std::isfinite(length))) refuse(row, text);
  field = value;
}

int choiceNumber(const OptionRow& row, std::string_view text) {
  const auto names = split(row.choices, '|');
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == text) return static_cast<int>(i);
  refuse(row, text);
}

}  // namespace

std::span<const OptionRow> optionsTable() {
  return kTable;
}

const OptionRow* findOption(std::string_view name) {
  for (const OptionRow& row : kTable)
    if (row.name == name) return &row;
  return nullptr;
}

void setOption(TextureOptions& options, const OptionRow& row, std::string_view value) {
  std::visit(
      [&](auto member) {
        auto& field = options.*member;
        using Field = std::remove_reference_t<decltype(field)>;
        if constexpr (std::is_same_v<Field, bool>)
          field = choiceNumber(row, value) == 0;
        else if constexpr (std::is_same_v<Field, vec3>)
          setVector(row, value, field);
        else if constexpr (std::is_enum_v<Field>)
          field = static_cast<Field>(choiceNumber(row, value));
        else
          setNumber(row, value, field);
      },
      row.field);
}

std::string optionText(const TextureOptions& options, const OptionRow& row) {
  return std::visit(
      [&](auto member) -> std::string {
        const auto& field = options.*member;
        using Field = std::remove_cvref_t<decltype(field)>;
        if constexpr (std::is_same_v<Field, bool>)
          return field ? "yes" : "no";
        else if constexpr (std::is_same_v<Field, vec3>)
          return fmt::format("{},{},{}", field.x, field.y, field.z);
        else if constexpr (std::is_enum_v<Field>)
          return std::string(split(row.choices, '|')[static_cast<std::size_t>(field)]);
        else
          return fmt::format("{}", field);
      },
      row.field);
}

std::string optionRange(const OptionRow& row) {
  if (std::holds_alternative<vec3 TextureOptions::*>(row.field)) return "x,y,z (not all 0)";
  if (!row.choices.empty()) return std::string(row.choices);
  if (std::holds_alternative<double TextureOptions::*>(row.field))
    return fmt::format("{:g} to {:g}", row.low, row.high);
  return fmt::format("{:.0f} to {:.0f}{}", row.low, row.high, row.odd ? ", odd" : "");
}

void validate(const TextureOptions& options) {
  TextureOptions copy = options;
  for (const OptionRow& row : kTable) setOption(copy, row, optionText(options, row));
}

}  // namespace dapple
