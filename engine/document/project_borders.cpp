#include "document/project_borders.h"

#include <cmath>

#include "document/project_columns.h"

namespace dapple::project {
namespace {

constexpr auto kColour = {"red", "green", "blue"};
constexpr auto kTexel = {"texel_x", "texel_y"};
constexpr auto kUp = {"up_x", "up_y", "up_z"};

}  // namespace

void addBorder(RecordTable& table, const BorderMix* border) {
  if (!border) return;
  std::vector<std::uint32_t> count;
  for (std::size_t b = 0; b < border->points.size(); ++b)
    count.push_back(static_cast<std::uint32_t>(border->termsOf(b).size()));
  Element points{.name = "border"};
  add<std::uint32_t>(points, {"point"}, border->points);
  add<std::uint32_t>(points, {"terms"}, count);
  add<float>(points, kColour, border->own);
  std::vector<std::uint16_t> source;
  std::vector<vec2> texel;
  std::vector<vec3> up;
  std::vector<float> weight, level;
  for (const BorderTerm& term : border->terms) {
    source.push_back(term.source);
    texel.push_back(term.texel);
    up.push_back(term.up);
    weight.push_back(term.weight);
    level.push_back(term.level);
  }
  Element terms{.name = "border_term"};
  add<std::uint16_t>(terms, {"source"}, source);
  add<float>(terms, kTexel, texel);
  add<float>(terms, kUp, up);
  add<float>(terms, {"weight"}, weight);
  add<float>(terms, {"level"}, level);
  table.elements.push_back(std::move(points));
  table.elements.push_back(std::move(terms));
}

std::shared_ptr<const BorderMix> readBorder(const RecordTable& table, std::size_t points,
                                            std::size_t sources, const std::string& file) {
  const Columns entries(file, table, "border"), terms(file, table, "border_term");
  if (entries.count() == 0) return nullptr;
  BorderMix border;
  border.points = *entries.read<std::uint32_t, Index>({"point"});
  border.own = *entries.read<float, vec3>(kColour);
  const auto count = entries.read<std::uint32_t, std::uint32_t>({"terms"});
  std::size_t end = 0;
  for (std::size_t b = 0; b < border.points.size(); ++b) {
    if (border.points[b] >= points || (b > 0 && border.points[b] <= border.points[b - 1]))
      refuse(file, fmt::format("border point {} does not exist or is out of order", b));
    border.end.push_back(end += (*count)[b]);
  }
  if (end != terms.count())
    refuse(file, fmt::format("its borders have {} terms in place of {}", terms.count(), end));
  const auto source = terms.read<std::uint16_t, std::uint16_t>({"source"});
  const auto texel = terms.read<float, vec2>(kTexel);
  const auto up = terms.read<float, vec3>(kUp);
  const auto weight = terms.read<float, float>({"weight"});
  // Older projects read all swatches as they are.
  const auto level = terms.has("level") ? terms.read<float, float>({"level"}) : nullptr;
  for (std::size_t t = 0; t < end; ++t) {
    const BorderTerm term{(*source)[t], (*texel)[t], (*up)[t], (*weight)[t],
                          level ? (*level)[t] : 0};
    const bool finite = std::isfinite(term.texel.x + term.texel.y) &&
                        std::isfinite(term.up.x + term.up.y + term.up.z) &&
                        std::isfinite(term.level);
    if (term.source >= sources || !finite || !(term.weight >= 0 && term.weight <= 1))
      refuse(file, fmt::format("border term {} is of a source or place that does not exist", t));
    border.terms.push_back(term);
  }
  return std::make_shared<const BorderMix>(std::move(border));
}

}  // namespace dapple::project
