// [Zhang] section 4: the neighbourhood of a point, its best place in the swatch.
//
// Departures, each of which was needed for a pattern that a viewer recognises:
// - places are real numbers: a neighbour copied from place s predicts exactly s - offset. Rounding
//   that to a pixel, as a search over pixels does, gives the true continuation an error, so that
//   another place wins and the copy breaks off (9 of 10 neighbours were copied from somewhere
//   else);
// - the winner of the exhaustive search is moved by fractions of a pixel to the nearest minimum and
//   must beat the neighbours' predictions clearly (the bonus of image analogies, Hertzmann et al.
//   2001);
// - offsets are the mean of both points' views, else copies drift where frames turn.
#include "synthesis/matching_level.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/simd.h"
#include "synthesis/place_refinement.h"

namespace dapple {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kGrazing = 1e-4f;        // squared sine below which a direction has no projection
constexpr float kReachShare = 1.0f / 6;  // of a swatch that does not tile: margin on each side
constexpr float kTwin = 1e-30f;          // least squared distance; below it points coincide
constexpr std::size_t kFinePhases = 4, kCoarsePhases = 2;
constexpr std::size_t kLargeSwatch = 256 * 256;  // pixels from which on planes must be fewer

void store(const MatchSite& site, SiteBlock& block, std::size_t a) {
  for (int c = 0; c < 3; ++c) {
    block.position[c][a] = site.position[c];
    block.s[c][a] = site.s[c];
    block.t[c][a] = site.t[c];
  }
  block.placeX[a] = site.place.x, block.placeY[a] = site.place.y;
  block.fineness[a] = site.fineness;
}

// The transfer of [Zhang] section 3, q = L (V.S, V.T) / cos with V of unit length, seen from both
// ends and averaged, so that the way there and back is the same to the last bit.
DAPPLE_CLONES void fillOffsets(const MatchSite& from, float pixelsPerUnit, std::size_t count,
                               SiteBlock& block) {
  const vec3 p = from.position, s = from.s, t = from.t, n = glm::cross(s, t);
  const float half = 0.5f * pixelsPerUnit, halfHere = half * from.fineness;
  for (std::size_t a = 0; a < paddedToLanes(count); ++a) {
    const float vx = block.position[0][a] - p.x, vy = block.position[1][a] - p.y,
                vz = block.position[2][a] - p.z;
    const float sx = block.s[0][a], sy = block.s[1][a], sz = block.s[2][a];
    const float tx = block.t[0][a], ty = block.t[1][a], tz = block.t[2][a];
    const float nx = sy * tz - sz * ty, ny = sz * tx - sx * tz, nz = sx * ty - sy * tx;
    const float facing = n.x * nx + n.y * ny + n.z * nz;
    const float length2 = std::max(vx * vx + vy * vy + vz * vz, kTwin);
    const float here = vx * n.x + vy * n.y + vz * n.z, there = vx * nx + vy * ny + vz * nz;
    const float flatHere = 1 - here * here / length2, flatThere = 1 - there * there / length2;
    const float scaleHere = halfHere / std::sqrt(std::max(flatHere, kGrazing));
    const float scaleThere = half * block.fineness[a] / std::sqrt(std::max(flatThere, kGrazing));
    const float x =
        (vx * s.x + vy * s.y + vz * s.z) * scaleHere + (vx * sx + vy * sy + vz * sz) * scaleThere;
    const float y =
        (vx * t.x + vy * t.y + vz * t.z) * scaleHere + (vx * tx + vy * ty + vz * tz) * scaleThere;
    const float least = std::min(facing, std::min(flatHere, flatThere) - kGrazing);
    block.x[a] = x;
    block.y[a] = -y;  // image rows run down
    block.predictedX[a] = block.placeX[a] - x;
    block.predictedY[a] = block.placeY[a] + y;
    block.seen[a] = (least > 0 ? 1 : 0) & (a < count ? 1 : 0);
  }
}

// How many of the seen predictions lie within `merge` of `place`, pixels, across the borders of an
// image that repeats after `period` (infinite: does not); those are not seen any more.
DAPPLE_CLONES int absorb(SiteBlock& block, std::size_t count, vec2 place, float merge,
                         vec2 period) {
  int votes = 0;
  for (std::size_t a = 0; a < paddedToLanes(count); ++a) {
    const float dx = std::abs(block.predictedX[a] - place.x);
    const float dy = std::abs(block.predictedY[a] - place.y);
    const float aroundX = std::abs(period.x - dx), aroundY = std::abs(period.y - dy);
    const float apartX = dx < aroundX ? dx : aroundX, apartY = dy < aroundY ? dy : aroundY;
    const std::int32_t same = block.seen[a] & (apartX < merge ? 1 : 0) & (apartY < merge ? 1 : 0);
    votes += same;
    block.seen[a] -= same;
  }
  return votes;
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
    if (!in_.scale.empty()) sites_[i].fineness = 1 / in_.scale[i];
  }
  const int layers = in_.coarse != nullptr ? 2 : 1;
  if (layers == 2) coarseReader_ = std::make_unique<TexelReader>(in_.swatch, in_.stackLevel + 1);
  if (!in_.swatch.tileable) {
    reach_ = kReachShare * static_cast<float>(std::min(in_.swatch.width, in_.swatch.height));
  }
  if (!searching) return;
  const bool fine = in_.stackLevel == 0 && in_.swatch.pixels() <= kLargeSwatch;
  search_ = searchOf(in_.swatch, in_.stackLevel, fine ? kFinePhases : kCoarsePhases, layers);
}

bool MatchingLevel::offsetBetween(const MatchSite& a, const MatchSite& b, vec2& offset) const {
  SiteBlock block;
  store(b, block, 0);
  fillOffsets(a, pixelsPerUnit_, 1, block);
  offset = {block.x[0], block.y[0]};
  return block.seen[0] != 0;
}

// The distinct ones among the predictions of a block.
void MatchingLevel::addCandidates(std::size_t count, MatchScratch& scratch) const {
  SiteBlock& block = scratch.block;
  vec2 period(kInfinity);
  if (in_.swatch.tileable) period = vec2(in_.swatch.width, in_.swatch.height);
  for (std::size_t a = 0; a < count; ++a) {
    const vec2 place = reader_.wrap({block.predictedX[a], block.predictedY[a]});
    block.predictedX[a] = place.x, block.predictedY[a] = place.y;
    if (!reader_.inside(place.x, place.y)) block.seen[a] = 0;
  }
  for (MatchCandidate& known : scratch.candidates)
    known.votes += absorb(block, count, known.place, in_.merge, period);
  for (std::size_t a = 0; a < count; ++a) {
    if (block.seen[a] == 0) continue;
    const vec2 place(block.predictedX[a], block.predictedY[a]);
    scratch.candidates.push_back({place, absorb(block, count, place, in_.merge, period)});
    block.seen[a] = 0;  // whatever was rounded
  }
}

// Terms, which `reader` is to read, and predictions of scratch.near.
void MatchingLevel::addTerms(const MatchSite& from, const TexelReader& reader,
                             MatchScratch& scratch) const {
  SiteBlock& block = scratch.block;
  for (std::size_t begin = 0; begin < scratch.near.size(); begin += SiteBlock::kSize) {
    const std::size_t count = std::min(SiteBlock::kSize, scratch.near.size() - begin);
    const MatchSite* const* near = scratch.near.data() + begin;
    for (std::size_t a = 0; a < count; ++a) store(*near[a], block, a);
    fillOffsets(from, pixelsPerUnit_, count, block);
    for (std::size_t a = 0; a < count; ++a) {
      if (block.seen[a] == 0) continue;
      if (!(std::abs(block.x[a]) <= reach_ && std::abs(block.y[a]) <= reach_)) continue;
      scratch.terms.add({block.x[a], block.y[a]},
                        toFloat4(near[a]->colour, reader.relief(near[a]->place)));
    }
    addCandidates(count, scratch);
  }
}

void MatchingLevel::gather(Index i, MatchScratch& scratch) const {
  scratch.terms.clear();
  scratch.candidates.clear();
  scratch.near.clear();
  const auto ids = in_.neighborhoods.of(i);
  // Which ones are known cannot be foreseen: no branch may depend on it.
  scratch.near.resize(ids.size());
  std::size_t known = 0;
  for (Index j : ids) {
    scratch.near[known] = &sites_[j];
    known += sites_[j].known ? 1 : 0;
  }
  scratch.near.resize(known);
  addTerms(sites_[i], reader_, scratch);
  scratch.fineTerms = scratch.terms.size();
  if (in_.coarse == nullptr) return;
  // All distinct parents of the neighbourhood, nearest first; their colours are finished.
  scratch.near.clear();
  const auto addParent = [&](Index parent) {
    const MatchSite* site = &in_.coarse->sites_[parent];
    if (std::find(scratch.near.begin(), scratch.near.end(), site) == scratch.near.end()) {
      scratch.near.push_back(site);
    }
  };
  addParent(in_.parent[i]);
  for (Index j : ids) addParent(in_.parent[j]);
  addTerms(sites_[i], *coarseReader_, scratch);
}

// Sum over terms of squared differences; infinite where a term falls outside, anything above
// `bound` when it exceeds that.
float MatchingLevel::errorAt(vec2 place, float bound, const MatchScratch& scratch) const {
  if (!reader_.inside(place.x, place.y)) return kInfinity;
  const std::size_t fine = scratch.fineTerms, count = scratch.terms.size();
  const float sum = reader_.differences(place, {scratch.terms, 0, fine}, bound);
  if (fine == count || sum > bound) return sum;
  return sum + coarseReader_->differences(place, {scratch.terms, fine, count}, bound - sum);
}

bool MatchingLevel::searchEverywhere(MatchScratch& scratch, vec2& place) const {
  scratch.search.clear();
  for (std::size_t t = 0; t < scratch.terms.size(); ++t) {
    const Float4& c = scratch.terms.colour(t);
    scratch.search.push_back(
        {scratch.terms.offset(t), {c[0], c[1], c[2]}, t < scratch.fineTerms ? 0 : 1, c[3]});
  }
  const SearchResult result = search_->search(scratch.search);
  place = result.texel - 0.5f;
  return result.found;
}

vec2 MatchingLevel::randomPlace(Index i, std::uint64_t salt) const {
  return randomTexel(in_.swatch, in_.seed, i, salt) - 0.5f;
}

MatchChoice MatchingLevel::match(Index i, const MatchRules& rules, MatchScratch& scratch) const {
  gather(i, scratch);
  if ((scratch.terms.size() == 0) && scratch.candidates.empty()) return {randomPlace(i, 0)};
  MatchChoice choice;
  float best = kInfinity;
  if (rules.coherent) {
    // The favourite first: the others then mostly exceed its error after a few terms.
    const auto favourite = std::max_element(
        scratch.candidates.begin(), scratch.candidates.end(),
        [](const MatchCandidate& a, const MatchCandidate& b) { return a.votes < b.votes; });
    if (favourite != scratch.candidates.end()) {
      std::iter_swap(scratch.candidates.begin(), favourite);
    }
    for (const MatchCandidate& candidate : scratch.candidates) {
      const float error = errorAt(candidate.place, best, scratch);
      if (error < best) {
        best = error;
        choice.place = candidate.place;
      }
    }
  }
  if (search_ && (rules.exhaustive || best == kInfinity)) {
    choice.searched = true;
    vec2 place;
    if (searchEverywhere(scratch, place)) {
      float error = errorAt(place, kInfinity, scratch);
      if (rules.subPixel) {
        refinePlace([&](vec2 at, float bound) { return errorAt(at, bound, scratch); }, place,
                    error);
      }
      if (best == kInfinity || error * rules.bonus < best) {
        best = error;
        choice.place = reader_.wrap(place);
      }
    }
  }
  if (best == kInfinity) {
    // No place takes all terms: prefer a prediction that is at least inside.
    choice.place =
        scratch.candidates.empty() ? randomPlace(i, 0) : scratch.candidates.front().place;
    best = 0;
  }
  const std::size_t numbers = in_.swatch.relief.empty() ? 3 : 4;
  const auto samples = static_cast<float>(numbers * std::max<std::size_t>(1, scratch.terms.size()));
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
