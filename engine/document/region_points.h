// A region taken out of its scan.
//
// synthesize() colours all points that it is given. A region that is not the whole scan is
// therefore a point set of its own, with neighbourhoods of its own: points across the border would
// pull its pattern towards theirs.
#pragma once

#include "document/document.h"

namespace dapple {

// The least that the option table's 8 neighbours need.
inline constexpr std::size_t kFewestPoints = 9;

template <class T>
std::vector<T> gathered(const std::vector<T>& column, std::span<const Index> points) {
  std::vector<T> out(points.size());
  for (std::size_t r = 0; r < points.size(); ++r) out[r] = column[points[r]];
  return out;
}

// Positions and normals of some points.
PointSet takenOut(const PointSet& points, std::span<const Index> ids);

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

// Turns s and t in their plane, counter-clockwise seen from outside.
void rotate(std::vector<TangentFrame>& frames, double degrees);

// The directions and scales that the region's synthesis follows, with its rotation. Throws
// InvalidInput, Cancelled.
OrientationField fieldOf(const RegionPoints& part, const Region& region,
                         std::span<const Stroke> strokes, Monitor& monitor);

}  // namespace dapple
