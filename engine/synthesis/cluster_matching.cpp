// [Soler] finds the best place by fast Fourier transforms, one for each of the swatch's angles and
// each channel. Departures: the exhaustive search of methods 3.2 over some of the border's points
// takes no longer and turns these instead of the swatch, which is not resampled; the best place is
// refined between pixels.
#include "synthesis/cluster_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "synthesis/place_refinement.h"

namespace dapple {
namespace {

constexpr int kPhases = 2;           // of the search: its places are refined
constexpr std::size_t kTerms = 100;  // of a search
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

DomainTurn::DomainTurn(float radians) : cosine_(std::cos(radians)), sine_(std::sin(radians)) {}

// What the domain's turn takes to (1, 0) and (0, -1), the swatch's right and up.
TangentFrame DomainTurn::of(const TangentFrame& frame) const {
  return {cosine_ * frame.s + sine_ * frame.t, cosine_ * frame.t - sine_ * frame.s, frame.n};
}

PlacementBox boxOf(std::span<const vec2> places, const DomainTurn& turn) {
  PlacementBox box{vec2(kInfinity), vec2(-kInfinity)};
  for (const vec2& place : places) {
    const vec2 turned = turn(place);
    box.low = glm::min(box.low, turned), box.high = glm::max(box.high, turned);
  }
  return box;
}

ClusterMatcher::ClusterMatcher(const Swatch& swatch, int level)
    : swatch_(swatch), search_(searchOf(swatch, level, kPhases)), reader_(swatch, level) {}

bool ClusterMatcher::matchTurned(const ClusterBorder& border, float angle,
                                 ClusterMatch& out) const {
  out.turn = DomainTurn(angle);
  const PlacementBox box = boxOf(border.inside, out.turn);
  const std::size_t count = std::min(kTerms, border.samples.size());
  std::vector<SearchTerm> terms;
  terms.reserve(count + 2);
  for (std::size_t c = 0; c < count; ++c) {
    const BorderSample& sample = border.samples[c * border.samples.size() / count];
    const Float4 colour = reader_.read(sample.texel.x - 0.5f, sample.texel.y - 0.5f);
    terms.push_back({out.turn(sample.place), {colour[0], colour[1], colour[2]}, 0, colour[3]});
  }
  if (!swatch_.tileable) keepInside(swatch_, box, count, terms);
  if (terms.empty()) return false;
  const SearchResult found = search_->search(terms);
  if (!found.found) return false;
  WantedTexels wanted;
  for (std::size_t t = 0; t < std::min(count, terms.size()); ++t)
    wanted.add(terms[t].offset, toFloat4(terms[t].colour, terms[t].relief));
  const auto errorAt = [&](vec2 place, float bound) {
    if (clampedPlacement(swatch_, box, place + 0.5f) != place + 0.5f) return kInfinity;
    return reader_.differences(place, {wanted, 0, wanted.size()}, bound);
  };
  vec2 place = clampedPlacement(swatch_, box, found.texel) - 0.5f;
  float error = errorAt(place, kInfinity);
  if (error == kInfinity) return false;
  refinePlace(errorAt, place, error);
  out.placement = place + 0.5f;
  out.error = std::sqrt(error / (3 * static_cast<float>(wanted.size())));
  return true;
}

std::vector<ClusterMatch> ClusterMatcher::matches(const ClusterBorder& border,
                                                  std::span<const float> angles,
                                                  Monitor& monitor) const {
  std::vector<ClusterMatch> out;
  if (border.samples.empty()) return out;
  std::vector<ClusterMatch> found(angles.size());
  std::vector<std::uint8_t> any(angles.size(), 0);
  monitor.workers().run(angles.size(), [&](std::size_t a) {
    monitor.checkpoint();
    any[a] = matchTurned(border, angles[a], found[a]) ? 1 : 0;
  });
  for (std::size_t a = 0; a < angles.size(); ++a)
    if (any[a]) out.push_back(found[a]);
  std::stable_sort(out.begin(), out.end(),
                   [](const ClusterMatch& a, const ClusterMatch& b) { return a.error < b.error; });
  return out;
}

}  // namespace dapple
