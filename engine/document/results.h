// What syntheses have left on a scan: the source map of all its points, and how the maps of
// neighbouring regions pass into one another.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "swatch/material_maps.h"
#include "swatch/swatch_analysis.h"
#include "synthesis/synthesis.h"

namespace dapple {

template <class T>
using Column = std::shared_ptr<const std::vector<T>>;

using RegionId = std::uint8_t;
inline constexpr RegionId kUnassigned = 0;  // the region of all points that belong to no other
inline constexpr std::size_t kMostRegions = 255;

struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const PixelRect&) const = default;
};

// Where a region's swatch comes from.
struct SwatchReference {
  std::string path;               // empty: none
  std::optional<PixelRect> crop;  // of the image and of its channels; all of it when not given
  ChannelPaths channels;          // further images of the same place, of the same size
  bool operator==(const SwatchReference&) const = default;
};
// The same part of the same image, whatever its channels.
inline bool sameImage(const SwatchReference& a, const SwatchReference& b) {
  return a.path == b.path && a.crop == b.crop;
}

// What one synthesis made its points from.
struct ResultSource {
  RegionId region = kUnassigned;
  SwatchReference reference;
  std::shared_ptr<const Swatch> swatch;
  std::shared_ptr<const MaterialMaps> maps;        // of the swatch; null: none
  std::shared_ptr<const SwatchAnalysis> analysis;  // of the swatch; null: none was needed
  float unit = 0;                                  // local units per swatch pixel
  bool partial = false;                            // stopped on the way: colours and states only
  TextureOptions options;  // that it was made with: Auto only when it was stopped
  SynthesisStatistics statistics;
  // Points that mix several texels, and their terms.
  std::vector<Index> blended;         // ascending
  std::vector<std::size_t> blendEnd;  // by blended: where its terms end in `blend`
  std::vector<BlendTerm> blend;

  // None: the point is not blended.
  std::span<const BlendTerm> termsAt(Index point) const;
};

inline constexpr std::uint16_t kNoSource = 0xffff;

// A texel of a neighbour's swatch, where its pattern runs on over a point of another region.
struct BorderTerm {
  std::uint16_t source = 0;  // position in Results::sources
  vec2 texel{0};
  vec3 up{0, 1, 0};  // of the neighbour's swatch, on the surface
  float weight = 0;
  float level = 0;  // of the swatch's stack, that its method reads there
  bool operator==(const BorderTerm&) const = default;
};

// Points near the border of two regions. Their columns in Results are what their own source gives
// them, with 1 - (sum of their terms' weights) as its weight; but their colour is the mix.
struct BorderMix {
  std::vector<Index> points;     // ascending
  std::vector<vec3> own;         // by point: its colour from its own source alone
  std::vector<std::size_t> end;  // by point: where its terms end in `terms`
  std::vector<BorderTerm> terms;

  std::size_t begin(std::size_t b) const { return b == 0 ? 0 : end[b - 1]; }
  std::span<const BorderTerm> termsOf(std::size_t b) const {
    return {terms.data() + begin(b), end[b] - begin(b)};
  }
  // None: the point lies near no border.
  std::optional<std::size_t> find(Index point) const;
};

// The source map of the whole scan: columns of n elements, all null until something is synthesized.
// Patch ids are unique within one source.
struct Results {
  Column<std::uint16_t> source;  // position in sources; kNoSource: never synthesized
  Column<vec2> texel;
  Column<TangentFrame> frame;
  Column<float> scale;  // of the swatch, times its source's unit; null: 1 everywhere
  Column<float> level;  // of the swatch's stack that a colour was read at; null: 0 everywhere
  Column<vec3> colour;  // never synthesized: the scan's own, or kBare
  Column<PointState> state;
  Column<Index> patch;
  Column<float> error;
  Column<Index> order;
  std::shared_ptr<const BorderMix> border;  // null: no border is made
  std::vector<std::shared_ptr<const ResultSource>> sources;
};
inline constexpr vec3 kBare{0.72f};  // points without any colour

// One texel that a point is made of.
struct SourceTerm {
  std::uint16_t source = 0;
  vec2 texel{0};
  vec3 up{0, 1, 0};  // of the source's swatch, on the surface
  float weight = 0;
  float level = 0;  // of the swatch's stack that it is read at
};

// All texels that a point is made of, blended gaps and borders included; the weights sum to 1. None
// where nothing is synthesized, or a synthesis was stopped. Replaces what `terms` held.
void gatherTerms(const Results& results, Index point, std::vector<SourceTerm>& terms);

// Takes over the map's blended points; point i of the map is points[i], or i when there are none.
void noteBlends(const SourceMap& map, std::span<const Index> points, ResultSource& source);

// A map of all points as results, all from `source`, whose blends are taken from the map.
Results resultsOf(const SourceMap& map, const ResultSource& source);

// Takes out the sources that no point and no border comes from any more; with the last of them all
// columns.
void dropUnusedSources(Results& results);

}  // namespace dapple
