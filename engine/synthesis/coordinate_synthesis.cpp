// Methods, section 3.4, after Lefebvre and Hoppe 2005 and 2006.
#include "synthesis/coordinate_synthesis.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "synthesis/baselines.h"
#include "synthesis/coordinate_relaxation.h"
#include "synthesis/surface_sites.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;

class Synthesizer {
 public:
  Synthesizer(const SynthesisInput& input, const CoordinateOptions& options, SourceMap& map,
              Monitor& monitor)
      : in_(input),
        options_(options),
        map_(map),
        monitor_(monitor),
        domain_(input.swatch),
        ways_(input) {}

  void run() {
    const int wanted = options_.levels > 0 ? options_.levels : appearanceLevels(in_.swatch);
    surface_ = thinSurface(in_, wanted, monitor_);
    monitor_.begin(Stage::Synthesis, in_.points.size());
    planWork();
    for (std::size_t l = surface_.size(); l-- > 0;) {
      start(l);
      if (surface_[l].level >= 0) relax(l);
      if (l > 0) surface_[l].near = {};
    }
    write();
  }

 private:
  int passesOf(std::size_t l) const {
    return passesOver(surface_[l].level, l + 1 == surface_.size(), options_.quality);
  }

  std::size_t sizeOf(std::size_t l) const {
    return surface_[l].points.empty() ? in_.points.size() : surface_[l].points.size();
  }

  void planWork() {
    for (std::size_t l = 0; l < surface_.size(); ++l)
      if (surface_[l].level >= 0) work_ += static_cast<std::size_t>(passesOf(l)) * sizeOf(l);
  }

  // Turns updates of sites on all levels into points done.
  void worked(std::size_t updates) {
    done_ += updates;
    const std::size_t target = std::min<std::size_t>(
        in_.points.size(),
        static_cast<std::size_t>(static_cast<double>(in_.points.size()) *
                                 static_cast<double>(done_) / static_cast<double>(work_)));
    if (target <= reported_) return;
    monitor_.advance(target - reported_);
    reported_ = target;
  }

  // Nothing: it is to be found. A place that is not of this swatch is found anew.
  std::optional<Place> keptPlace(Index point) const {
    if (!in_.isKept(point)) return std::nullopt;
    const vec2 scaled = kPlaceScale * in_.kept->texel[point];
    const Place place = domain_.wrapped({static_cast<std::int32_t>(std::lround(scaled.x)),
                                         static_cast<std::int32_t>(std::lround(scaled.y))});
    return domain_.contains(place) ? std::optional(place) : std::nullopt;
  }

  // Places of level l from those of the next one.
  std::vector<Place> extended(std::size_t l, const std::vector<Place>& coarse) {
    const SurfaceLevel &fine = surface_[l], &above = surface_[l + 1];
    std::vector<Place> out(sizeOf(l));
    parallelFor(monitor_, out.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Index parent = fine.parent[i];
        const Index from = pointAt(above, parent), to = pointAt(fine, i);
        if (const auto kept = keptPlace(to)) {
          out[i] = *kept;
          continue;
        }
        Place way{0, 0};
        if (from != to) {
          const vec2 pixels = ways_.between(from, to).pixels * kPlaceScale;
          way = {static_cast<std::int32_t>(pixels.x), static_cast<std::int32_t>(pixels.y)};
        }
        out[i] = domain_.moved(coarse[parent], way);
      }
    });
    return out;
  }

  void start(std::size_t l) {
    if (l + 1 < surface_.size()) {
      places_ = extended(l, places_);
      return;
    }
    places_.resize(sizeOf(l));
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Index point = pointAt(surface_[l], i);
      const auto kept = keptPlace(point);
      places_[i] = kept ? *kept : domain_.random(options_.seed, point, 1);
    }
  }

  void relax(std::size_t l) {
    const int level = surface_[l].level;
    const SiteLevel sites =
        ways_.sitesOf(surface_[l], appearanceReach(in_.swatch, level), monitor_);
    const AppearanceLevel appearance = makeAppearance(in_.swatch, level, sites.turned, monitor_);
    PlaceRelaxation relaxation(sites, appearance, domain_, places_, monitor_);
    const int passes = passesOf(l);
    for (int pass = 0; pass < passes; ++pass)
      for (std::size_t c = 0; c < PlaceRelaxation::kClasses; ++c) {
        relaxation.updateClass(c, monitor_);
        worked(sizeOf(l) / PlaceRelaxation::kClasses);
        if (monitor_.wantsPreview()) preview(l);
      }
    if (l == 0) errors_ = relaxation.errors(monitor_);
  }

  // Every point as its ancestor has it.
  void preview(std::size_t l) {
    std::vector<Place> places = places_;
    for (std::size_t m = l; m-- > 0;) places = extended(m, places);
    std::vector<vec3> colours(places.size());
    const float level = static_cast<float>(std::max(0, surface_[l].level));
    parallelFor(monitor_, places.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        colours[i] = sampleSwatch(in_.swatch, texelOf(places[i]), level);
    });
    const std::vector<PointState> states(places.size(), PointState::Matched);
    monitor_.publish({colours, states});
  }

  void write() {
    const std::size_t n = in_.points.size();
    if (errors_.empty()) errors_.assign(n, 0.0f);
    std::vector<vec2> texel = map_.texel;
    std::vector<vec3> colour = map_.colour;
    parallelFor(monitor_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (in_.isKept(i)) continue;
        texel[i] = texelOf(places_[i]);
        colour[i] = sampleSwatch(in_.swatch, texel[i], readLevel(in_, i));
      }
    });
    map_.texel = std::move(texel);
    map_.colour = std::move(colour);
    for (std::size_t i = 0; i < n; ++i) {
      if (in_.isKept(i)) continue;
      map_.error[i] = errors_[i];
      map_.frame[i] = in_.frames[i];
      map_.state[i] = PointState::Matched;
      map_.patch[i] = map_.order[i] = kNone;
    }
    for (std::size_t l = surface_.size(); l-- > 0;)
      for (std::size_t i = 0; i < sizeOf(l); ++i) {
        Index& order = map_.order[pointAt(surface_[l], i)];
        if (order == kNone) order = static_cast<Index>(surface_.size() - 1 - l);
      }
  }

  const SynthesisInput& in_;
  const CoordinateOptions& options_;
  SourceMap& map_;
  Monitor& monitor_;
  PlaceDomain domain_;
  SurfaceWays ways_;
  std::vector<SurfaceLevel> surface_;
  std::vector<Place> places_;
  std::vector<float> errors_;
  std::size_t work_ = 0, done_ = 0, reported_ = 0;
};

}  // namespace

void synthesizeCoordinates(const SynthesisInput& input, const CoordinateOptions& options,
                           SourceMap& map, Monitor& monitor) {
  DAPPLE_CHECK(input.frames.size(), ==, input.points.size());
  if (PlaceDomain(input.swatch).empty()) return scatterTexels(input, options.seed, map, monitor);
  Synthesizer(input, options, map, monitor).run();
}

}  // namespace dapple
