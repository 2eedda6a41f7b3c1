#include "document/results.h"

#include <algorithm>

namespace dapple {
namespace {

constexpr float kLeastWeight = 1e-5f;  // less is a rounding of 0

}  // namespace

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
        terms.push_back({term.source, term.texel, term.up, term.weight, term.level});
        own -= term.weight;
      }
  if (own < kLeastWeight) return;
  const vec3 up = (*results.frame)[point].t;
  const std::span<const BlendTerm> blend = source.termsAt(point);
  for (const BlendTerm& term : blend) terms.push_back({s, term.texel, up, own * term.weight});
  if (!blend.empty()) return;
  const float level = results.level ? (*results.level)[point] : 0;
  terms.push_back({s, (*results.texel)[point], up, own, level});
}

void noteBlends(const SourceMap& map, std::span<const Index> ids, ResultSource& source) {
  if (map.blendOffset.empty()) return;
  source.blend = map.blend;
  for (std::size_t i = 0; i + 1 < map.blendOffset.size(); ++i) {
    if (map.blendOffset[i] == map.blendOffset[i + 1]) continue;
    source.blended.push_back(ids.empty() ? static_cast<Index>(i) : ids[i]);
    source.blendEnd.push_back(map.blendOffset[i + 1]);
  }
}

Results resultsOf(const SourceMap& map, const ResultSource& source) {
  const auto column = [](const auto& values) {
    return std::make_shared<const std::remove_cvref_t<decltype(values)>>(values);
  };
  auto from = std::make_shared<ResultSource>(source);
  from->blended.clear(), from->blendEnd.clear(), from->blend.clear();
  noteBlends(map, {}, *from);
  Results out;
  out.source = column(std::vector<std::uint16_t>(map.texel.size(), 0));
  out.texel = column(map.texel);
  out.frame = column(map.frame);
  if (!map.scale.empty()) out.scale = column(map.scale);
  if (!map.level.empty()) out.level = column(map.level);
  out.colour = column(map.colour);
  out.state = column(map.state);
  out.patch = column(map.patch);
  out.error = column(map.error);
  out.order = column(map.order);
  out.sources.push_back(std::move(from));
  return out;
}

void dropUnusedSources(Results& results) {
  std::vector<std::uint16_t> next(results.sources.size(), kNoSource);
  if (results.source) {
    std::uint16_t last = kNoSource;  // neighbours mostly have the same
    for (const std::uint16_t s : *results.source)
      if (s != last) {
        last = s;
        if (s != kNoSource) next[s] = 0;
      }
  }
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
