// Departures from methods 3.4:
// - a site whose neighbours all predict the place that it has keeps it without looking at the
//   swatch; most sites of fine levels do;
// - where predictions lead out of a swatch that does not tile, places that look like those of the
//   neighbours are continued instead; random ones gain nothing;
// - the mean of predictions that nearly agree is tried as well: what the directions stretch or turn
//   is spread over many sites in place of breaks;
// - on a plane, where pieces meet, random places are tried, too, most of them around the best
//   (Barnes et al., "PatchMatch", 2009): regular patterns go on in step.
#include "synthesis/coordinate_kernels.h"

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

#include <algorithm>
#include <cstdlib>

#include "base/hash_rng.h"
#include "base/simd.h"

namespace dapple {
namespace {

constexpr std::int32_t kWorst = std::numeric_limits<std::int32_t>::max();
constexpr int kMostOthers = 4;     // similar places that are tried in place of those that lead out
constexpr std::size_t kAhead = 8;  // members between a row's prefetch and its use
// Of the errors of random places: a piece that goes on is better than a slightly better fit.
constexpr float kProbeFactor = 2, kAroundFactor = 1.5f;
constexpr std::size_t kBoundAt = 8;  // terms after which a sum is compared with the best

// Neighbours of a site in columns; what follows the last one repeats the site itself.
struct alignas(64) NearColumns {
  std::int32_t wayX[kMostNear], wayY[kMostNear];
  std::int32_t placeX[kMostNear], placeY[kMostNear];  // predicted
  std::int32_t predicts[kMostNear];                   // -1 or 0
  std::int32_t open[kMostNear];                       // predictions not yet tried, -1 or 0
  Appearance look[kMostNear];
  std::size_t count;
};

// Of a site whose axes are turned by so many quarters, as a neighbour sees it.
Appearance lookOf(const PlaceUpdate& u, Index site, int quarters) {
  return u.appearance.turned(u.appearance.indexOf(u.places[site]), quarters);
}

[[gnu::always_inline]] inline void gather(const PlaceUpdate& u, Index site, NearColumns& near) {
  const SiteLevel& sites = u.sites;
  const Index* ids = sites.ids.data() + site * sites.stride;
  const Way* ways = sites.ways.data() + site * sites.k;
  const Place own = u.places[site];
  std::size_t count = 0;
  for (std::size_t a = 0; a < sites.k; ++a) {
    const Way way = ways[a];
    if (way.x == kNoWay) continue;
    const Index j = ids[a];
    const Place place = u.places[j], offset = placesOf(way, sites.level);
    near.wayX[count] = offset.x, near.wayY[count] = offset.y;
    near.placeX[count] = place.x - offset.x, near.placeY[count] = place.y - offset.y;
    near.look[count] = u.looks[j];
    near.open[count] = near.predicts[count] = -1;
    if (const int quarters = quartersOf(way); quarters != 0) [[unlikely]] {
      near.open[count] = near.predicts[count] = 0;
      near.placeX[count] = own.x, near.placeY[count] = own.y;
      near.look[count] = lookOf(u, j, quarters);
    }
    ++count;
  }
  near.count = count;
  for (; count < kMostNear; ++count) {
    near.wayX[count] = near.wayY[count] = 0;
    near.placeX[count] = own.x, near.placeY[count] = own.y;
    near.open[count] = near.predicts[count] = 0;
  }
}

[[gnu::always_inline]] inline void wrapAll(const PlaceDomain& domain, NearColumns& near) {
  const std::int32_t w = domain.width(), h = domain.height();
  for (std::size_t a = 0; a < kMostNear; ++a) {
    near.placeX[a] += (near.placeX[a] < 0 ? w : 0) - (near.placeX[a] >= w ? w : 0);
    near.placeY[a] += (near.placeY[a] < 0 ? h : 0) - (near.placeY[a] >= h ? h : 0);
  }
}

// Closes the predictions within `merge` of `place`; whether any is left open.
[[gnu::always_inline]] inline bool absorb(NearColumns& near, Place place, std::int32_t merge) {
  std::int32_t left = 0;
  for (std::size_t a = 0; a < kMostNear; ++a) {
    const std::int32_t dx = near.placeX[a] - place.x, dy = near.placeY[a] - place.y;
    const std::int32_t farX = (dx < 0 ? -dx : dx) > merge ? -1 : 0;
    const std::int32_t farY = (dy < 0 ? -dy : dy) > merge ? -1 : 0;
    near.open[a] &= farX | farY;
    left |= near.open[a];
  }
  return left != 0;
}

// Of the predictions within `nearby` of a place; the place itself when there are none.
[[gnu::always_inline]] inline Place meanAround(const NearColumns& near, Place place,
                                               std::int32_t nearby) {
  std::int32_t sumX = 0, sumY = 0, count = 0;
  for (std::size_t a = 0; a < kMostNear; ++a) {
    const std::int32_t dx = near.placeX[a] - place.x, dy = near.placeY[a] - place.y;
    const std::int32_t nearX = (dx < 0 ? -dx : dx) <= nearby ? near.predicts[a] : 0;
    const std::int32_t both = (dy < 0 ? -dy : dy) <= nearby ? nearX : 0;
    sumX += dx & both, sumY += dy & both, count -= both;
  }
  return count > 0 ? Place{place.x + sumX / count, place.y + sumY / count} : place;
}

// Sum over the terms of the squared differences; anything above `bound` when it exceeds that.
template <bool kPortable>
[[gnu::always_inline]] inline std::int32_t differences(const AppearanceLevel& appearance,
                                                       const NearColumns& near, Place place,
                                                       std::int32_t bound) {
  alignas(64) std::int32_t index[kMostNear];
  for (std::size_t a = 0; a < kMostNear; ++a)
    index[a] = ((place.y + near.wayY[a]) >> appearance.shift) * appearance.stride +
               ((place.x + near.wayX[a]) >> appearance.shift);
  const Appearance* origin =
      appearance.samples.data() + appearance.margin * appearance.stride + appearance.margin;
#if defined(__x86_64__)
  if constexpr (!kPortable) {
    __m128i sums = _mm_setzero_si128();
    const auto add = [&](std::size_t a) __attribute__((always_inline)) {
      const __m128i there = _mm_load_si128(reinterpret_cast<const __m128i*>(origin + index[a]));
      const __m128i wanted = _mm_load_si128(reinterpret_cast<const __m128i*>(&near.look[a]));
      const __m128i difference = _mm_sub_epi16(there, wanted);
      sums = _mm_add_epi32(sums, _mm_madd_epi16(difference, difference));
    };
    const auto total = [&]() __attribute__((always_inline)) {
      const __m128i pairs = _mm_add_epi32(sums, _mm_shuffle_epi32(sums, 0x4e));
      return _mm_cvtsi128_si32(_mm_add_epi32(pairs, _mm_shuffle_epi32(pairs, 0xb1)));
    };
    std::size_t a = 0;
    for (const std::size_t first = std::min(near.count, kBoundAt); a < first; ++a) add(a);
    if (a < near.count) {
      const std::int32_t half = total();
      if (half > bound) return half;
      for (; a < near.count; ++a) add(a);
    }
    return total();
  }
#endif
  std::int32_t sum = 0;
  for (std::size_t a = 0; a < near.count; ++a) {
    if (a == kBoundAt && sum > bound) return sum;
    sum += appearanceDistance(origin[index[a]], near.look[a]);
  }
  return sum;
}

// A factor of the error that a site has at a place.
[[gnu::always_inline]] inline float useOf(const PlaceUpdate& u, Index site, Place place) {
  const float use = u.usage.at(place);
  return u.displacements == nullptr ? use : use * u.displacements->at(site, place);
}

// Up to u.around pixels along each axis: one of 32 bits each.
Place randomWay(const PlaceUpdate& u, std::uint64_t bits) {
  const auto sides = static_cast<std::uint64_t>(2 * u.around + 1);
  const auto along = [&](std::uint64_t half) {
    return (static_cast<std::int32_t>(half * sides >> 32) - u.around) * (1 << kPlaceBits);
  };
  return {along(bits >> 32), along(bits & 0xffffffffu)};
}

template <bool kPortable>
[[gnu::always_inline]] inline Place choose(const PlaceUpdate& u, Index site, NearColumns& near) {
  const Place own = u.places[site];
  gather(u, site, near);
  if (u.domain.tileable()) wrapAll(u.domain, near);
  if (!absorb(near, own, u.merge)) return own;
  Place best = own;
  const float ownUse = useOf(u, site, own);
  float least =
      ownUse * static_cast<float>(differences<kPortable>(u.appearance, near, own, kWorst));
  const auto attempt = [&](Place place, float factor = 1) __attribute__((always_inline)) {
    const float use = factor * useOf(u, site, place), most = least / use;
    const std::int32_t bound = most < 2e9f ? static_cast<std::int32_t>(most) : kWorst;
    const float error =
        use * static_cast<float>(differences<kPortable>(u.appearance, near, place, bound));
    if (error < least) least = error, best = place;
  };
  int others = 0;
  for (std::size_t a = 0; a < near.count; ++a) {
    if (near.open[a] == 0) continue;
    Place place{near.placeX[a], near.placeY[a]};
    if (!u.domain.contains(place)) [[unlikely]] {
      if (u.similar != nullptr) {
        if (++others > kMostOthers) continue;
        const Place from = u.similar->of({place.x + near.wayX[a], place.y + near.wayY[a]});
        place = {from.x - near.wayX[a], from.y - near.wayY[a]};
      } else {
        place = u.domain.continued(place);
      }
      if (u.domain.contains(place)) attempt(place);
      continue;
    }
    attempt(place);
    if (!absorb(near, place, u.merge)) break;
  }
  for (int probe = 0; probe < u.probes; ++probe)
    attempt(u.domain.random(u.round, site, static_cast<std::uint64_t>(probe)), kProbeFactor);
  if (u.probesAround > 0) {
    const Place centre = best;
    const std::uint64_t drawn = hashBits(u.round, site);  // once: it costs as much as a probe
    for (int probe = 0; probe < u.probesAround; ++probe)
      attempt(
          u.domain.moved(centre, randomWay(u, mixBits(drawn + static_cast<std::uint64_t>(probe)))),
          kAroundFactor);
  }
  if (u.nearby == 0) return best;
  const Place mean = u.domain.continued(meanAround(near, best, u.nearby));
  if (u.domain.contains(mean)) attempt(mean);
  return best;
}

// Per term, of the place that a site has. Each neighbour counts as soon as it is seen: where one
// place alone is compared, columns would only be written to be read once.
[[gnu::always_inline]] inline float meanDifference(const PlaceUpdate& u, Index site) {
  const SiteLevel& sites = u.sites;
  const Index* ids = sites.ids.data() + site * sites.stride;
  const Way* ways = sites.ways.data() + site * sites.k;
  const Place own = u.places[site];
  std::int32_t sum = 0, terms = 0;
  for (std::size_t a = 0; a < sites.k; ++a) {
    const Way way = ways[a];
    if (way.x == kNoWay) continue;
    const Place offset = placesOf(way, sites.level);
    const Appearance& there = u.appearance.at({own.x + offset.x, own.y + offset.y});
    const int quarters = quartersOf(way);
    sum += quarters == 0 ? appearanceDistance(there, u.looks[ids[a]])
                         : appearanceDistance(there, lookOf(u, ids[a], quarters));
    ++terms;
  }
  return static_cast<float>(sum) / static_cast<float>(std::max(1, terms));
}

void prefetchRow(const SiteLevel& sites, Index site) {
  __builtin_prefetch(sites.ids.data() + site * sites.stride);
  __builtin_prefetch(sites.ways.data() + site * sites.k);
}

DAPPLE_CLONES void chooseAll(const PlaceUpdate& update, std::span<const Index> members,
                             Place* chosen) {
  NearColumns near;
  for (std::size_t m = 0; m < members.size(); ++m) {
    prefetchRow(update.sites, members[std::min(m + kAhead, members.size() - 1)]);
    chosen[m] = choose<false>(update, members[m], near);
  }
}

}  // namespace

void choosePlaces(const PlaceUpdate& update, std::span<const Index> members, Place* chosen,
                  bool portable) {
  if (!portable) return chooseAll(update, members, chosen);
  NearColumns near;
  for (std::size_t m = 0; m < members.size(); ++m)
    chosen[m] = choose<true>(update, members[m], near);
}

DAPPLE_CLONES void placeErrors(const PlaceUpdate& update, Index first, std::span<float> errors) {
  for (std::size_t e = 0; e < errors.size(); ++e) {
    const Index site = first + static_cast<Index>(e);
    prefetchRow(update.sites, first + static_cast<Index>(std::min(e + kAhead, errors.size() - 1)));
    errors[e] = meanDifference(update, site);
  }
}

}  // namespace dapple
