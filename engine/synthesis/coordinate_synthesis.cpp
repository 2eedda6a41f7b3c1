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
#include "synthesis/place_levels.h"
#include "synthesis/surface_sites.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;

class Synthesizer {
 public:
  Synthesizer(const SynthesisInput& input, const CoordinateOptions& options, SourceMap& map,
              Monitor& monitor)
      : in_(input), options_(options), map_(map), monitor_(monitor) {}

  void run() {
    const int wanted = options_.levels > 0 ? options_.levels : appearanceLevels(in_.swatch);
    surface_ = thinSurface(in_, wanted, monitor_);
    monitor_.begin(Stage::Synthesis, in_.points.size());
    planWork();
    std::vector<float> errors(in_.points.size(), 0.0f);
    const std::vector<Place> places = relaxed(errors);
    write(places, errors);
  }

 private:
  // The place of every point. What it takes to find them has gone when it returns.
  std::vector<Place> relaxed(std::vector<float>& errors) {
    PlaceLevels levels(in_, surface_, task());
    for (std::size_t l = surface_.size(); l-- > 0;) {
      levels.enter(l, monitor_);
      const auto afterClass = [&] {
        worked(sizeOf(l) / PlaceRelaxation::kClasses);
        if (monitor_.wantsPreview()) preview(levels, surface_[l].level);
      };
      if (surface_[l].level >= 0)
        levels.relax(passesOf(l), afterClass, l == 0 ? &errors : nullptr, monitor_);
      if (l > 0) surface_[l].near = {};
    }
    return levels.places();
  }

  int passesOf(std::size_t l) const {
    return passesOver(surface_[l].level, l + 1 == surface_.size(), options_.quality);
  }

  std::size_t sizeOf(std::size_t l) const {
    return surface_[l].points.empty() ? in_.points.size() : surface_[l].points.size();
  }

  // Kept points stay where they are, all others begin anywhere.
  PlaceTask task() const {
    const PlaceDomain domain(in_.swatch);
    PlaceTask task{.start = std::vector<Place>(in_.points.size()), .guessed = true};
    if (in_.kept) task.open.assign(in_.points.size(), 1);
    parallelFor(monitor_, task.start.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (in_.isKept(i)) {
          task.start[i] = domain.wrapped(placeOf(in_.kept->texel[i]));
          task.open[i] = domain.contains(task.start[i]) ? 0 : 1;
        }
        // A place that is not of this swatch is found anew.
        if (task.open.empty() || task.open[i]) task.start[i] = domain.random(options_.seed, i, 1);
      }
    });
    return task;
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

  void preview(const PlaceLevels& levels, int level) {
    shown_.resize(in_.points.size());
    shownStates_.resize(in_.points.size(), PointState::Matched);
    const auto read = static_cast<float>(std::max(0, level));
    const auto show = [&](std::size_t first, std::span<const Place> places) {
      for (std::size_t i = 0; i < places.size(); ++i)
        shown_[first + i] = sampleSwatch(in_.swatch, texelOf(places[i]), read);
    };
    levels.visitAll(show, monitor_);
    monitor_.publish({shown_, shownStates_});
  }

  // The other columns. Memory is touched once where nothing is kept: it takes as long as to find
  // what goes there.
  void writeRest(std::vector<float>& errors) {
    const std::size_t n = in_.points.size();
    if (!in_.kept) {
      map_.error = std::move(errors);
      map_.frame.assign(in_.frames.begin(), in_.frames.end());
      map_.state.assign(n, PointState::Matched);
      map_.patch.assign(n, kNone), map_.order.assign(n, kNone);
      return;
    }
    map_.error.resize(n), map_.frame.resize(n), map_.state.resize(n);
    map_.patch.resize(n), map_.order.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      if (in_.isKept(i)) continue;
      map_.error[i] = errors[i];
      map_.frame[i] = in_.frames[i];
      map_.state[i] = PointState::Matched;
      map_.patch[i] = map_.order[i] = kNone;
    }
  }

  void write(const std::vector<Place>& places, std::vector<float>& errors) {
    const std::size_t n = in_.points.size();
    std::vector<vec2> texel = map_.texel;
    std::vector<vec3> colour = map_.colour;
    texel.resize(n), colour.resize(n);
    parallelFor(monitor_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (in_.isKept(i)) continue;
        texel[i] = texelOf(places[i]);
        colour[i] = sampleSwatch(in_.swatch, texel[i], readLevel(in_, i));
      }
    });
    map_.texel = std::move(texel);
    map_.colour = std::move(colour);
    writeRest(errors);
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
  std::vector<SurfaceLevel> surface_;
  std::vector<vec3> shown_;  // by previews; kept from one to the next
  std::vector<PointState> shownStates_;
  std::size_t work_ = 0, done_ = 0, reported_ = 0;
};

}  // namespace

void synthesizeCoordinates(const SynthesisInput& input, const CoordinateOptions& options,
                           SourceMap& map, Monitor& monitor) {
  DAPPLE_CHECK(input.frames.size(), ==, input.points.size());
  if (PlaceDomain(input.swatch).empty()) {
    if (map.texel.empty()) {
      std::vector<float> scale = std::move(map.scale);
      map = emptySourceMap(input.points.size(), input.unit);
      map.scale = std::move(scale);
    }
    return scatterTexels(input, options.seed, map, monitor);
  }
  Synthesizer(input, options, map, monitor).run();
}

}  // namespace dapple
