// [Zhang] section 4: the neighbourhood of a point, its best place in the swatch.
//
// Departures, each of which was needed for a pattern that a viewer recognises:
// - places are real numbers: a neighbour copied from place s predicts exactly s - offset. Rounding
//   that to a pixel, as a search over pixels does, gives the true continuation an error, so that
//   another place wins and the copy breaks off (9 of 10 neighbours were copied from somewhere else);
// - the winner of the exhaustive search is moved by fractions of a pixel to the nearest minimum and
//   must beat the neighbours' predictions clearly (the bonus of image analogies, Hertzmann et al.
//   2001);
// - offsets are the mean of both points' views, else copies drift where frames turn.
#include "synthesis/matching_level.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hash_rng.h"

namespace dapple {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kGrazing = 1e-4f;       // squared sine below which a direction has no projection
constexpr float kReachShare = 1.0f / 6;  // of a swatch that does not tile: margin on each side
constexpr int kPlacesTried = 64;
constexpr std::size_t kFinePhases = 4, kCoarsePhases = 2;
constexpr std::size_t kLargeSwatch = 256 * 256;  // pixels from which on planes must be fewer

float distanceAround(float a, float b, float period) {
  const float d = std::abs(a - b);
  return period > 0 ? std::min(d, std::abs(period - d)) : d;
}

}  // namespace

MatchingLevel::MatchingLevel(const Input& input, bool searching)
    : in_(input),
      pixelsPerUnit_(1 / input.unit),
      reach_(kInfinity),
      sites_(input.positions.size()),
      reader_(input.swatch, input.stackLevel) {
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    sites_[i].position = in_.positions[i];
    sites_[i].s = in_.frames[i].s;
    sites_[i].t = in_.frames[i].t;
  }
  const int layers = in_.coarse != nullptr ? 2 : 1;
  if (layers == 2) coarseReader_ = std::make_unique<TexelReader>(in_.swatch, in_.stackLevel + 1);
  if (!in_.swatch.tileable) {
    reach_ = kReachShare * static_cast<float>(std::min(in_.swatch.width, in_.swatch.height));
  }
  if (!searching) return;
  const bool fine = in_.stackLevel == 0 && in_.swatch.pixels() <= kLargeSwatch;
  search_ = std::make_unique<SwatchSearch>(in_.swatch, in_.stackLevel,
                                           fine ? kFinePhases : kCoarsePhases, layers);
}

bool MatchingLevel::offsetBetween(const MatchSite& a, const MatchSite& b, vec2& offset) const {
  const vec3 normalA = glm::cross(a.s, a.t), normalB = glm::cross(b.s, b.t);
  if (!(glm::dot(normalA, normalB) > 0)) return false;
  const vec3 way = b.position - a.position;
  const float length2 = glm::dot(way, way);
  offset = vec2(0);
  if (length2 <= 0) return true;  // twins
  // The transfer of [Zhang] section 3, q = L (V.S, V.T) / cos, V of unit length, seen from each end.
  const float heightA = glm::dot(way, normalA), heightB = glm::dot(way, normalB);
  const float flatA = 1 - heightA * heightA / length2, flatB = 1 - heightB * heightB / length2;
  if (!(flatA > kGrazing && flatB > kGrazing)) return false;
  const float scaleA = 0.5f * pixelsPerUnit_ / std::sqrt(flatA);
  const float scaleB = 0.5f * pixelsPerUnit_ / std::sqrt(flatB);
  offset.x = glm::dot(way, a.s) * scaleA + glm::dot(way, b.s) * scaleB;
  offset.y = -(glm::dot(way, a.t) * scaleA + glm::dot(way, b.t) * scaleB);  // image rows run down
  return true;
}

void MatchingLevel::addCandidate(vec2 place, MatchScratch& scratch) const {
  place = reader_.wrap(place);
  if (!reader_.inside(place.x, place.y)) return;
  const float w = in_.swatch.tileable ? static_cast<float>(in_.swatch.width) : 0;
  const float h = in_.swatch.tileable ? static_cast<float>(in_.swatch.height) : 0;
  for (const vec2& other : scratch.candidates) {
    if (distanceAround(place.x, other.x, w) < in_.merge &&
        distanceAround(place.y, other.y, h) < in_.merge) {
      return;
    }
  }
  scratch.candidates.push_back(place);
}

void MatchingLevel::addTerm(const MatchSite& site, const MatchSite& from,
                            MatchScratch& scratch) const {
  vec2 offset;
  if (!offsetBetween(from, site, offset)) return;
  addCandidate(site.place - offset, scratch);
  if (!(std::abs(offset.x) <= reach_ && std::abs(offset.y) <= reach_)) return;
  scratch.offsets.push_back(offset);
  scratch.colours.push_back(toFloat4(site.colour));
}

void MatchingLevel::gather(Index i, MatchScratch& scratch) const {
  scratch.offsets.clear();
  scratch.colours.clear();
  scratch.candidates.clear();
  scratch.parents.clear();
  const MatchSite& from = sites_[i];
  const auto near = in_.neighborhoods.of(i);
  for (Index j : near) {
    if (sites_[j].known) addTerm(sites_[j], from, scratch);
  }
  scratch.fineTerms = scratch.offsets.size();
  if (in_.coarse == nullptr) return;
  // All distinct parents of the neighbourhood, nearest first; their colours are finished.
  const auto addParent = [&](Index parent) {
    const auto seen = std::find(scratch.parents.begin(), scratch.parents.end(), parent);
    if (seen != scratch.parents.end()) return;
    scratch.parents.push_back(parent);
    addTerm(in_.coarse->sites_[parent], from, scratch);
  };
  addParent(in_.parent[i]);
  for (Index j : near) addParent(in_.parent[j]);
}

// Sum over terms of squared differences; infinite where a term falls outside, anything above
// `bound` when it exceeds that.
float MatchingLevel::errorAt(vec2 place, float bound, const MatchScratch& scratch) const {
  constexpr std::size_t kStride = 8;  // terms between two looks at the bound
  if (!reader_.inside(place.x, place.y)) return kInfinity;
  const bool bounded = !in_.swatch.tileable;
  float sum = 0;
  const std::size_t count = scratch.offsets.size();
  for (std::size_t begin = 0; begin < count; begin += kStride) {
    Float4 squares{0, 0, 0, 0};
    for (std::size_t t = begin; t < std::min(count, begin + kStride); ++t) {
      const float x = place.x + scratch.offsets[t].x, y = place.y + scratch.offsets[t].y;
      const TexelReader& reader = t < scratch.fineTerms ? reader_ : *coarseReader_;
      if (bounded && !reader.inside(x, y)) return kInfinity;
      const Float4 d = reader.read(x, y) - scratch.colours[t];
      squares += d * d;
    }
    sum += sumOf(squares);
    if (sum > bound) return sum;
  }
  return sum;
}

// Downhill from a whole pixel in steps of 1/2, 1/4 and 1/8.
void MatchingLevel::refine(vec2& place, float& error, const MatchScratch& scratch) const {
  constexpr vec2 kWays[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  for (float step = 0.5f; step >= 0.125f; step *= 0.5f) {
    const vec2 centre = place;
    for (const vec2& way : kWays) {
      const vec2 moved = centre + way * step;
      const float there = errorAt(moved, error, scratch);
      if (there < error) {
        error = there;
        place = moved;
      }
    }
  }
}

bool MatchingLevel::searchEverywhere(MatchScratch& scratch, vec2& place) const {
  scratch.search.clear();
  for (std::size_t t = 0; t < scratch.offsets.size(); ++t) {
    const Float4 c = scratch.colours[t];
    scratch.search.push_back(
        {scratch.offsets[t], {c[0], c[1], c[2]}, t < scratch.fineTerms ? 0 : 1});
  }
  const SearchResult result = search_->search(scratch.search);
  place = result.texel - 0.5f;
  return result.found;
}

vec2 MatchingLevel::randomPlace(Index i, std::uint64_t salt) const {
  const auto w = static_cast<std::uint64_t>(in_.swatch.width);
  const std::size_t pixels = in_.swatch.pixels();
  std::uint64_t pixel = 0;
  for (int attempt = 0; attempt < kPlacesTried; ++attempt) {
    pixel = hashBelow(pixels, in_.seed, i, salt, static_cast<std::uint64_t>(attempt));
    if (in_.swatch.opaque[pixel]) break;
  }
  while (!in_.swatch.opaque[pixel]) pixel = (pixel + 1) % pixels;
  return {static_cast<float>(pixel % w), static_cast<float>(pixel / w)};
}

MatchChoice MatchingLevel::match(Index i, const MatchRules& rules, MatchScratch& scratch) const {
  gather(i, scratch);
  if (scratch.offsets.empty() && scratch.candidates.empty()) return {randomPlace(i, 0)};
  MatchChoice choice;
  float best = kInfinity;
  if (rules.coherent) {
    for (const vec2& candidate : scratch.candidates) {
      const float error = errorAt(candidate, best, scratch);
      if (error < best) {
        best = error;
        choice.place = candidate;
      }
    }
  }
  if (search_ && (rules.exhaustive || best == kInfinity)) {
    choice.searched = true;
    vec2 place;
    if (searchEverywhere(scratch, place)) {
      float error = errorAt(place, kInfinity, scratch);
      if (rules.subPixel) refine(place, error, scratch);
      if (best == kInfinity || error * rules.bonus < best) {
        best = error;
        choice.place = reader_.wrap(place);
      }
    }
  }
  if (best == kInfinity) {
    // No place takes all terms: prefer a prediction that is at least inside.
    choice.place = scratch.candidates.empty() ? randomPlace(i, 0) : scratch.candidates.front();
    best = 0;
  }
  const auto samples = static_cast<float>(3 * std::max<std::size_t>(1, scratch.offsets.size()));
  choice.error = best / samples;
  return choice;
}

void MatchingLevel::set(Index i, vec2 place) {
  MatchSite& site = sites_[i];
  const Float4 colour = reader_.read(place.x, place.y);
  site.place = place;
  site.colour = {colour[0], colour[1], colour[2]};
  site.known = true;
}

}  // namespace dapple
