// One level of the point hierarchy while its points are matched with the swatch.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "points/neighborhoods.h"
#include "points/point_set.h"
#include "swatch/swatch_search.h"
#include "swatch/texel_reader.h"

namespace dapple {

// All that a neighbour is asked for, in one cache line: the neighbours of a point lie scattered in
// memory, and this, not arithmetic, decides the speed of coherent matching.
struct alignas(64) MatchSite {
  vec3 position{0}, s{0}, t{0};  // axes as in TangentFrame
  vec2 place{0};                 // texel - 0.5
  vec3 colour{0};                // on the swatch level that belongs to this level
  float fineness = 1;            // 1 / SynthesisInput::scale
  bool known = false;
};

struct MatchRules {
  bool coherent = true;     // try the neighbours' predictions
  bool exhaustive = false;  // try every place, too
  bool subPixel = true;     // move the exhaustive winner by fractions of a pixel
  float bonus = 1;          // an exhaustive winner must be better than coherent ones by this factor
};

struct MatchChoice {
  vec2 place{0};
  float error = 0;  // mean squared difference per term and channel
  bool searched = false;
};

// Sites around a point, a column for each number, so that their offsets are computed eight at a
// time.
struct SiteBlock {
  static constexpr std::size_t kSize = 64;
  float position[3][kSize] = {}, s[3][kSize] = {}, t[3][kSize] = {};
  float placeX[kSize] = {}, placeY[kSize] = {}, fineness[kSize] = {};
  // Offsets, pixels, and the places predicted for the point in the middle.
  float x[kSize] = {}, y[kSize] = {}, predictedX[kSize] = {}, predictedY[kSize] = {};
  std::int32_t seen[kSize] = {};  // 0: faces away or out of sight; after clustering 0 for all
};

// A place that `votes` neighbours predict.
struct MatchCandidate {
  vec2 place;
  int votes;
};

// Working memory of one matching thread.
struct MatchScratch {
  SiteBlock block;
  std::vector<const MatchSite*> near;  // whose terms are wanted
  WantedTexels terms;
  std::size_t fineTerms = 0;  // the first ones are compared with layer 0, the others with 1
  std::vector<MatchCandidate> candidates;  // distinct predictions
  std::vector<SearchTerm> search;          // terms as the exhaustive search takes them
};

class MatchingLevel {
 public:
  struct Input {
    std::span<const vec3> positions;
    std::span<const TangentFrame> frames;
    std::span<const float> scale;  // empty: 1
    const Neighborhoods& neighborhoods;
    std::span<const Index> parent;  // empty at the coarsest level
    const MatchingLevel* coarse;    // null at the coarsest level
    const Swatch& swatch;
    int stackLevel;  // of the swatch
    float unit;      // local units per pixel
    float merge;     // predictions nearer than this are one, pixels
    std::uint64_t seed;
  };
  // `searching`: exhaustive searches may be asked for (else their planes are not built).
  MatchingLevel(const Input& input, bool searching);

  std::size_t size() const { return sites_.size(); }
  std::vector<MatchSite>& sites() { return sites_; }
  const std::vector<MatchSite>& sites() const { return sites_; }
  const Neighborhoods& neighborhoods() const { return in_.neighborhoods; }

  // Where point i should read the swatch, given its known neighbours. Reads known sites only; may
  // run on many threads while nothing is set().
  MatchChoice match(Index i, const MatchRules& rules, MatchScratch& scratch) const;

  // The colour that i has at `place`; i is known from now on.
  void set(Index i, vec2 place);

  // A hashed place on opaque texels.
  vec2 randomPlace(Index i, std::uint64_t salt) const;

  // Pixels from site a to b as the frames of both see it: half of each view, so that there and back
  // is the same. False when they face away from each other or look along the surface's normal.
  bool offsetBetween(const MatchSite& a, const MatchSite& b, vec2& offset) const;

  const TexelReader& reader() const { return reader_; }

 private:
  void gather(Index i, MatchScratch& scratch) const;
  void addTerms(const MatchSite& from, const TexelReader& reader, MatchScratch& scratch) const;
  void addCandidates(std::size_t count, MatchScratch& scratch) const;
  float errorAt(vec2 place, float bound, const MatchScratch& scratch) const;
  bool searchEverywhere(MatchScratch& scratch, vec2& place) const;

  Input in_;
  float pixelsPerUnit_;
  float reach_;  // terms further away than this are left out, pixels
  std::vector<MatchSite> sites_;
  TexelReader reader_;
  std::unique_ptr<TexelReader> coarseReader_;
  std::shared_ptr<const SwatchSearch> search_;
};

}  // namespace dapple
