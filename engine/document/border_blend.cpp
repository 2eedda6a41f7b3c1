#include "document/border_blend.h"

#include <algorithm>
#include <utility>

#include "document/border_shares.h"
#include "document/border_weights.h"
#include "synthesis/pattern_cut.h"

namespace dapple {
namespace {

constexpr float kLeastWeight = 1.f / 1024;  // a quarter of a step of 8 bits
static_assert(kNoSource == kNoPattern);

// The points' colours without borders.
std::vector<vec3> ownColours(const Results& results) {
  std::vector<vec3> colours = *results.colour;
  if (const BorderMix* border = results.border.get())
    for (std::size_t b = 0; b < border->points.size(); ++b)
      colours[border->points[b]] = border->own[b];
  return colours;
}

// The end of the shares of the same source at the same point.
std::size_t endOfSource(std::span<const BorderShare> shares, std::size_t s) {
  std::size_t end = s + 1;
  while (end < shares.size() && shares[end].point == shares[s].point &&
         shares[end].term.source == shares[s].term.source)
    ++end;
  return end;
}

// Decides for all that meets by a cut which points it has: `beyond` is 1 or 0 then.
void cut(const Document& document, const BorderSides& sides, const std::vector<vec3>& colours,
         std::span<BorderShare> shares, Monitor& monitor) {
  std::vector<PatternOption> options;
  std::vector<std::size_t> first;  // share of an option
  for (std::size_t s = 0, end = 0; s < shares.size(); s = end) {
    end = endOfSource(shares, s);
    if (shares[s].kind != BorderKind::Cut) continue;
    PatternOption option{.point = shares[s].point, .pattern = shares[s].term.source};
    for (std::size_t t = s; t < end; ++t)
      option.colour += shares[t].term.weight * colourOf(document.results, shares[t].term);
    options.push_back(option);
    first.push_back(s);
  }
  if (options.empty()) return;
  std::vector<std::uint16_t> own(document.size());
  for (Index i = 0; i < document.size(); ++i) own[i] = sides.sourceAt(i);
  const PatternCut made = cutPatterns(
      {document.points(), document.scan->prepared.neighborhoods, own, colours, options}, monitor);
  for (std::size_t o = 0; o < options.size(); ++o)
    for (std::size_t s = first[o], end = endOfSource(shares, s); s < end; ++s)
      shares[s].beyond = made.taken[o] ? 1 : 0;
}

// An entry whose colour cannot, or must not, be made again.
bool stays(const Document& document, std::size_t b) {
  const BorderMix& border = *document.results.border;
  const Region* region = findRegion(document, (*document.labels)[border.points[b]]);
  if (region && region->locked) return true;
  const Results& results = document.results;
  for (const BorderTerm& term : border.termsOf(b))
    if (!results.sources[term.source]->swatch) return true;
  const std::uint16_t own = (*results.source)[border.points[b]];
  return own != kNoSource && !results.sources[own]->swatch;
}

void append(BorderMix& to, Index point, const vec3& own, std::span<const BorderTerm> terms) {
  to.points.push_back(point);
  to.own.push_back(own);
  to.terms.insert(to.terms.end(), terms.begin(), terms.end());
  to.end.push_back(to.terms.size());
}

vec3 mixed(const Results& results, const vec3& own, std::span<const BorderTerm> terms) {
  vec3 colour(0);
  float weight = 1;
  for (const BorderTerm& term : terms) {
    colour += term.weight * colourOf(results, term);
    weight -= term.weight;
  }
  return colour + weight * own;
}

// The results with another border, of which `made` says which entries are not as they were.
Results withBorder(const Results& results, BorderMix border, const std::vector<bool>& made) {
  Results out = results;
  if (!results.border && border.points.empty()) {
    dropUnusedSources(out);
    return out;
  }
  std::vector<vec3> colour = *results.colour;
  if (results.border)
    for (std::size_t b = 0; b < results.border->points.size(); ++b)
      if (const auto now = border.find(results.border->points[b]); !now || made[*now])
        colour[results.border->points[b]] = results.border->own[b];
  for (std::size_t b = 0; b < border.points.size(); ++b)
    if (made[b]) colour[border.points[b]] = mixed(results, border.own[b], border.termsOf(b));
  if (colour != *results.colour)
    out.colour = std::make_shared<const std::vector<vec3>>(std::move(colour));
  out.border =
      border.points.empty() ? nullptr : std::make_shared<const BorderMix>(std::move(border));
  dropUnusedSources(out);
  return out;
}

// The terms that count, with the weight of those that do not.
void takeTerms(std::span<const BorderShare> shares, std::vector<BorderTerm>& terms) {
  terms.clear();
  float all = 0, taken = 0;
  for (const BorderShare& share : shares) {
    all += share.term.weight;
    if (share.term.weight < kLeastWeight) continue;
    taken += share.term.weight;
    terms.push_back(share.term);
  }
  for (BorderTerm& term : terms) term.weight *= all / taken;
}

// What stays and what was made, in the order of points.
Results merged(const Document& document, const std::vector<vec3>& colours,
               std::span<BorderShare> shares) {
  const Results& results = document.results;
  const BorderMix none;
  const BorderMix& old = results.border ? *results.border : none;
  BorderMix border;
  std::vector<bool> made;
  std::vector<BorderTerm> terms;
  BorderWeights weights(results);
  std::size_t b = 0;
  const auto keepUpTo = [&](Index point) {
    for (; b < old.points.size() && old.points[b] < point; ++b)
      if (stays(document, b))
        append(border, old.points[b], old.own[b], old.termsOf(b)), made.push_back(false);
  };
  for (std::size_t s = 0; s < shares.size();) {
    const Index point = shares[s].point;
    std::size_t end = s;
    while (end < shares.size() && shares[end].point == point) ++end;
    const std::span<BorderShare> here = shares.subspan(s, end - s);
    s = end;
    keepUpTo(point);
    const bool had = b < old.points.size() && old.points[b] == point;
    if (had && stays(document, b)) continue;  // taken with the next
    weights.settle((*results.source)[point], colours[point], here);
    takeTerms(here, terms);
    if (terms.empty()) continue;
    append(border, point, colours[point], terms);
    made.push_back(true);
  }
  keepUpTo(kNone);
  return withBorder(results, std::move(border), made);
}

}  // namespace

bool asksForSameBorder(const Region& a, const Region& b) {
  return a.locked == b.locked && a.borderKind == b.borderKind && a.borderWidth == b.borderWidth;
}

Results blendBorders(const Document& document, Monitor& monitor) {
  if (!document.results.source) return document.results;
  if (document.regions->size() == 1 && !document.results.border) return document.results;
  const BorderSides sides(document);
  std::vector<BorderShare> shares = borderShares(document, sides, monitor);
  const std::vector<vec3> colours =
      shares.empty() ? std::vector<vec3>() : ownColours(document.results);
  cut(document, sides, colours, shares, monitor);
  return merged(document, colours, shares);
}

Results withoutLostTerms(const Document& document) {
  const Results& results = document.results;
  if (!results.border) return results;
  std::vector<bool> owns(results.sources.size(), false);
  for (const std::uint16_t s : *results.source)
    if (s != kNoSource) owns[s] = true;
  const BorderMix& old = *results.border;
  BorderMix border;
  std::vector<bool> made;
  std::vector<BorderTerm> terms;
  for (std::size_t b = 0; b < old.points.size(); ++b) {
    terms.clear();
    float lost = 0;
    for (const BorderTerm& term : old.termsOf(b))
      if (owns[term.source])
        terms.push_back(term);
      else
        lost += term.weight;
    if (lost == 0 || stays(document, b)) {
      append(border, old.points[b], old.own[b], old.termsOf(b));
      made.push_back(false);
      continue;
    }
    for (BorderTerm& term : terms) term.weight /= std::max(1 - lost, kLeastWeight);
    if (terms.empty()) continue;
    append(border, old.points[b], old.own[b], terms);
    made.push_back(true);
  }
  return withBorder(results, std::move(border), made);
}

}  // namespace dapple
