// Synthesis of one region and its way into the results.
//
// synthesize() colours all points that it is given. A region that is not the whole scan is
// therefore taken out as a point set of its own, with neighbourhoods of its own (points across the
// border would pull its pattern towards theirs), and its map is scattered back.
#pragma once

#include "document/apply.h"

namespace dapple {

// A region's points with what a synthesis, or the field that it follows, needs of them.
class RegionPoints {
 public:
  // Throws Cancelled.
  RegionPoints(const Document& document, const Region& region, Monitor& monitor);

  std::size_t size() const { return count_; }
  const std::vector<Index>& ids() const { return ids_; }  // ascending; empty: all of the scan
  Index idOf(Index point) const { return whole_ ? point : ids_[point]; }  // in the scan
  const PointSet& points() const { return whole_ ? scan_->prepared.scan.points : points_; }
  // By the region's options; of fewer than 9 points there may be none (k = 0).
  const Neighborhoods& neighborhoods() const {
    return scansLinks_ ? scan_->prepared.neighborhoods : links_;
  }
  // The region's over these points: what runs outside is cut off.
  std::vector<Stroke> strokes(const Region& region) const;

 private:
  std::shared_ptr<const OpenedScan> scan_;
  std::vector<Index> ids_;
  std::size_t count_ = 0;
  bool whole_ = false, scansLinks_ = false;
  PointSet points_;      // unless whole
  Neighborhoods links_;  // unless the scan's
};

// The directions that the region's synthesis follows, with its rotation; a frame for each point.
// Throws InvalidInput, Cancelled.
std::vector<TangentFrame> framesOf(const RegionPoints& part, const Region& region,
                                   std::span<const Stroke> strokes, Monitor& monitor);

struct RegionResult {
  std::vector<Index> points;  // ascending; empty: all of the scan
  SourceMap map;              // of these points
  std::shared_ptr<const ResultSource> source;
};

// A region of fewer than 9 points is projected along the axes: there is nothing to match. Throws
// InvalidInput when the region is locked, has no points or no swatch; Cancelled.
RegionResult synthesizeRegion(const Document& document, const Region& region,
                              const SynthesisWatch& watch, Monitor& monitor);

// Regions one after another. When the monitor is stopped and `watch` keeps what is done, what has
// been shown until then is the last result, and partial.
std::vector<RegionResult> synthesizeRegions(const Document& document,
                                            const std::vector<RegionId>& regions,
                                            const SynthesisWatch& watch, Monitor& monitor);

// The document with these results in place of what their points had.
Document withResults(const Document& document, const std::vector<RegionResult>& results);

// The document without the results of the region's points, or of all.
Document withoutResults(const Document& document, std::optional<RegionId> region);

}  // namespace dapple
