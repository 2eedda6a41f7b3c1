#include "synthesis/placement_box.h"

#include <algorithm>

namespace dapple {
namespace {

constexpr float kMargin = 3;  // pixels from the swatch's border, where there is room

vec2 sizeOf(const Swatch& swatch) {
  return vec2(swatch.width, swatch.height);
}

}  // namespace

PlacementBox roomyBox(const Swatch& swatch, const PlacementBox& box) {
  const vec2 slack = sizeOf(swatch) - 2.f - (box.high - box.low);
  const vec2 margin = glm::clamp(slack * 0.5f, vec2(0), vec2(kMargin));
  return {box.low - margin, box.high + margin};
}

void keepInside(const Swatch& swatch, const PlacementBox& box, std::size_t most,
                std::vector<SearchTerm>& terms) {
  const PlacementBox roomy = roomyBox(swatch, box);
  std::erase_if(terms, [&](const SearchTerm& term) {
    return glm::clamp(term.offset, roomy.low, roomy.high) != term.offset;
  });
  const std::size_t count = terms.size();
  if (count == 0) return;
  while (terms.size() < most) terms.push_back(terms[terms.size() % count]);
  glm::vec4 mean(0);
  for (const SearchTerm& term : terms) mean += glm::vec4(term.colour, term.relief);
  mean = mean / static_cast<float>(terms.size());
  for (const vec2 corner : {roomy.low, roomy.high})
    terms.push_back({corner, vec3(mean), 0, mean.w});
}

vec2 clampedPlacement(const Swatch& swatch, const PlacementBox& box, vec2 placement) {
  if (swatch.tileable) return placement;
  const vec2 least = 0.5f - box.low, most = sizeOf(swatch) - 0.5f - box.high;
  return glm::max(least, glm::min(most, placement));
}

}  // namespace dapple
