#include "document/results.h"

#include <algorithm>

namespace dapple {

std::span<const BlendTerm> ResultSource::termsAt(Index point) const {
  const auto at = std::lower_bound(blended.begin(), blended.end(), point);
  if (at == blended.end() || *at != point) return {};
  const auto b = static_cast<std::size_t>(at - blended.begin());
  const std::size_t begin = b == 0 ? 0 : blendEnd[b - 1];
  return {blend.data() + begin, blendEnd[b] - begin};
}

std::optional<std::size_t> BorderMix::find(Index point) const {
  const auto at = std::lower_bound(points.begin(), points.end(), point);
  if (at == points.end() || *at != point) return std::nullopt;
  return static_cast<std::size_t>(at - points.begin());
}

void gatherTerms(const Results& results, Index point, std::vector<SourceTerm>& terms) {
  terms.clear();
  if (!results.source || (*results.source)[point] == kNoSource) return;
  const std::uint16_t s = (*results.source)[point];
  const ResultSource& source = *results.sources[s];
  if (source.partial) return;
  float own = 1;
  if (results.border)
    if (const auto b = results.border->find(point))
      for (const BorderTerm& term : results.border->termsOf(*b)) {
        terms.push_back({term.source, term.texel, term.up, term.weight});
        own -= term.weight;
      }
  const vec3 up = (*results.frame)[point].t;
  const std::span<const BlendTerm> blend = source.termsAt(point);
  for (const BlendTerm& term : blend) terms.push_back({s, term.texel, up, own * term.weight});
  if (blend.empty()) terms.push_back({s, (*results.texel)[point], up, own});
}

void dropUnusedSources(Results& results) {
  std::vector<std::uint16_t> next(results.sources.size(), kNoSource);
  if (results.source)
    for (const std::uint16_t s : *results.source)
      if (s != kNoSource) next[s] = 0;
  if (results.border)
    for (const BorderTerm& term : results.border->terms) next[term.source] = 0;
  std::vector<std::shared_ptr<const ResultSource>> kept;
  for (std::size_t s = 0; s < next.size(); ++s) {
    if (next[s] == kNoSource) continue;
    next[s] = static_cast<std::uint16_t>(kept.size());
    kept.push_back(results.sources[s]);
  }
  if (kept.empty()) {
    results = {};
    return;
  }
  if (kept.size() == next.size()) return;
  std::vector<std::uint16_t> source = *results.source;
  for (std::uint16_t& s : source)
    if (s != kNoSource) s = next[s];
  results.source = std::make_shared<const std::vector<std::uint16_t>>(std::move(source));
  if (results.border) {
    BorderMix border = *results.border;
    for (BorderTerm& term : border.terms) term.source = next[term.source];
    results.border = std::make_shared<const BorderMix>(std::move(border));
  }
  results.sources = std::move(kept);
}

}  // namespace dapple
