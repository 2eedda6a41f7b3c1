// Synthesis of regions, each as a point set of its own, and its way into the results.
#pragma once

#include "document/apply.h"
#include "document/region_field.h"

namespace dapple {

struct RegionResult {
  std::vector<Index> points;  // ascending; empty: all of the scan
  SourceMap map;              // of these points, or of `changed`
  std::shared_ptr<const ResultSource> source;
  // Of the scan, ascending: those of the points that have new values. None: all of them.
  std::optional<std::vector<Index>> changed = {};
};

struct RegionsAsked {
  const std::vector<RegionId>& regions;
  bool onlyChanged = false;  // Synthesize::onlyChanged
  // With onlyChanged: of the region that was synthesized last; takes this one's. May be null.
  std::unique_ptr<RegionField>* field = nullptr;
};

// Regions one after another. A region of fewer than 9 points is projected along the axes: there is
// nothing to match. When the monitor is stopped and `watch` keeps what is done, what has
// been shown until then is the last result, and partial. Throws InvalidInput when a region is
// locked, has no points or no swatch; Cancelled.
std::vector<RegionResult> synthesizeRegions(const Document& document, const RegionsAsked& asked,
                                            const SynthesisWatch& watch, Monitor& monitor);

// The document with these results in place of what their points had.
Document withResults(const Document& document, const std::vector<RegionResult>& results,
                     Workers& workers);

// The document without the results of the region's points, or of all.
Document withoutResults(const Document& document, std::optional<RegionId> region, Workers& workers);

}  // namespace dapple
