#include "document/border_weights.h"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

// Found by looking at pebbles beside leaves and scales beside lichen: less leaves both patterns to
// be seen at once, more cuts them to crumbs.
constexpr float kDeviation = 1;  // a
constexpr float kPower = 3;      // g

constexpr std::size_t kPixelsLookedAt = 1 << 16;  // of a swatch
constexpr float kLeastContrast = 1.f / 256;       // a flat swatch has none

}  // namespace

const BorderWeights::Look& BorderWeights::lookOf(std::uint16_t source) {
  std::optional<Look>& look = look_[source];
  if (look) return *look;
  const Swatch& swatch = *results_.sources[source]->swatch;
  const std::size_t step = 1 + (swatch.pixels() - 1) / kPixelsLookedAt;
  dvec3 sum(0);
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < swatch.pixels(); i += step) {
    const dvec3 c(swatch.colours()[i]);
    sum += c;
    squares += glm::dot(c, c);
    ++count;
  }
  const dvec3 mean = sum / count;
  const double variance = std::max(0., squares / count - glm::dot(mean, mean));
  look = Look{vec3(mean), std::max(kLeastContrast, static_cast<float>(std::sqrt(variance)))};
  return *look;
}

// The parts with their weights by distance. Where two unlocked regions meet they are what each asks
// for; where more do, all are scaled so that they sum to 1 with the point's own. What is cut counts
// as the point's own where it takes its place.
void BorderWeights::gather(std::uint16_t ownSource, const vec3& own,
                           std::span<const BorderShare> shares) {
  parts_.assign(1, {.colour = own, .source = ownSource});
  float ownWeight = 1, others = 0, fixed = 0;
  for (std::size_t s = 0; s < shares.size();) {
    Part part{.begin = s, .source = shares[s].term.source};
    for (; s < shares.size() && shares[s].term.source == part.source; ++s)
      part.colour += shares[s].term.weight * colourOf(results_, shares[s].term);
    part.end = s;
    const BorderShare& share = shares[part.begin];
    if (share.kind == BorderKind::Cut) {
      if (share.beyond > 0) parts_.front() = part;
      continue;
    }
    part.weight = share.beyond;
    if (share.locked) {
      fixed += share.beyond;
    } else {
      ownWeight = std::min(ownWeight, 1 - share.beyond);
      others += share.beyond;
    }
    parts_.push_back(part);
  }
  const float lockedScale = fixed > 1 ? 1 / fixed : 1;
  const float rest = std::max(0.f, 1 - fixed) / std::max(ownWeight + others, 1e-6f);
  parts_.front().weight = ownWeight * rest;
  for (std::size_t p = 1; p < parts_.size(); ++p)
    parts_[p].weight *= shares[parts_[p].begin].locked ? lockedScale : rest;
}

void BorderWeights::sharpen() {
  float sum = 0;
  for (Part& part : parts_) {
    const Look& look = lookOf(part.source);
    const float deviation = glm::distance(part.colour, look.mean) / look.contrast;
    part.weight = std::pow(part.weight * std::exp(kDeviation * deviation), kPower);
    sum += part.weight;
  }
  for (Part& part : parts_) part.weight /= sum;
}

void BorderWeights::settle(std::uint16_t ownSource, const vec3& own,
                           std::span<BorderShare> shares) {
  gather(ownSource, own, shares);
  if (parts_.size() > 1) sharpen();
  std::vector<float> whole(shares.size(), 0);
  for (const Part& part : parts_)
    for (std::size_t s = part.begin; s < part.end; ++s) whole[s] = part.weight;
  for (std::size_t s = 0; s < shares.size(); ++s) shares[s].term.weight *= whole[s];
}

}  // namespace dapple
