#include "document/border_shares.h"

#include <algorithm>

#include "points/tangent_frames.h"
#include "synthesis/baselines.h"
#include "synthesis/synthesis.h"
#include "synthesis/texture_extension.h"

namespace dapple {
namespace {

float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.f, 1.f);
  return t * t * (3 - 2 * t);
}

// Triplanar projections lie in space: they are carried on as they were made.
void addProjected(const Document& document, const ResultSource& source,
                  std::span<const Index> beyond, std::vector<BorderShare>& shares,
                  Monitor& monitor) {
  const PointSet& points = document.points();
  PointSet own;
  for (const Index i : beyond) {
    own.positions.push_back(points.positions[i]);
    own.normals.push_back(points.normals[i]);
  }
  const std::vector<TangentFrame> frames = framesTowards(own, source.options.up);
  const Neighborhoods none;
  SourceMap map = emptySourceMap(beyond.size(), source.unit);
  projectTriplanar({own, none, *source.swatch, frames, source.unit}, map, monitor);
  for (std::size_t b = 0; b < beyond.size(); ++b)
    for (std::size_t t = map.blendOffset[b]; t < map.blendOffset[b + 1]; ++t)
      shares.push_back(
          {.point = beyond[b],
           .term = {
               .texel = map.blend[t].texel, .up = frames[b].t, .weight = map.blend[t].weight}});
}

class Shares {
 public:
  Shares(const Document& document, const BorderSides& sides, Monitor& monitor)
      : document_(document),
        sides_(sides),
        monitor_(monitor),
        spacing_(localSpacing(document.scan->prepared.neighborhoods, document.points().positions)) {
  }

  // The pattern of a region over the points beyond its border.
  void add(RegionId region, const BorderSides::Halo& halo) {
    std::size_t s = out_.size(), h = 0;
    carryOn(region, halo.points);
    for (; s < out_.size(); ++s) {
      BorderShare& share = out_[s];
      while (halo.points[h] != share.point) ++h;
      const RegionId into = sides_.of(share.point);
      const float reach = sides_.reach(region, into);
      share.term.source = sides_.source(region);
      share.locked = sides_.locked(region);
      share.kind = sides_.kind(region, into);
      if (share.kind == BorderKind::Blend)
        share.beyond = 1 - smoothstep(share.locked ? 0 : -reach, reach, halo.inside[h]);
    }
  }

  std::vector<BorderShare> take() {
    std::stable_sort(out_.begin(), out_.end(), [](const BorderShare& a, const BorderShare& b) {
      return a.point != b.point ? a.point < b.point : a.term.source < b.term.source;
    });
    return std::move(out_);
  }

 private:
  // A region's texels, carried on.
  void carryOn(RegionId region, std::span<const Index> beyond) {
    const Results& results = document_.results;
    const ResultSource& source = *results.sources[sides_.source(region)];
    if (source.options.method == Method::Triplanar)
      return addProjected(document_, source, beyond, out_, monitor_);
    std::vector<bool> decided(document_.size());
    for (Index i = 0; i < document_.size(); ++i)
      decided[i] = sides_.takesPart(i) && sides_.of(i) == region;
    const Extension extension =
        extendTexture({document_.points(), document_.scan->prepared.neighborhoods, *source.swatch,
                       source.unit, *results.texel, *results.frame, results.scale.get()},
                      decided, beyond, monitor_);
    for (std::size_t b = 0; b < beyond.size(); ++b) {
      if (!extension.reached[b]) continue;
      const float level =
          shownLevel(source.options.method, spacing_[beyond[b]], source.unit * extension.scale[b]);
      out_.push_back(
          {.point = beyond[b],
           .term = {
               .texel = extension.texel[b], .up = extension.up[b], .weight = 1, .level = level}});
    }
  }

  const Document& document_;
  const BorderSides& sides_;
  Monitor& monitor_;
  const std::vector<float> spacing_;  // n
  std::vector<BorderShare> out_;
};

}  // namespace

std::vector<BorderShare> borderShares(const Document& document, const BorderSides& sides,
                                      Monitor& monitor) {
  const auto halos = sides.halos(monitor);
  const auto reaches = [](const BorderSides::Halo& halo) { return !halo.points.empty(); };
  if (std::none_of(halos.begin(), halos.end(), reaches)) return {};
  Shares shares(document, sides, monitor);
  for (std::size_t r = 0; r < halos.size(); ++r)
    if (reaches(halos[r])) shares.add(static_cast<RegionId>(r), halos[r]);
  return shares.take();
}

vec3 colourOf(const Results& results, const BorderTerm& term) {
  return sampleSwatch(*results.sources[term.source]->swatch, term.texel, term.level);
}

}  // namespace dapple
