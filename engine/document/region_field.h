// A region's points and the directions that its swatch follows, kept from one synthesis to the
// next: after an edit most of both is what it was.
#pragma once

#include <memory>
#include <utility>

#include "document/region_points.h"

namespace dapple {

class SmoothField;

class RegionField {
 public:
  // Throws Cancelled.
  RegionField(const Document& document, const Region& region, Monitor& monitor);
  ~RegionField();

  // The points are this region's now, and its field is found by the same options.
  bool fits(const Document& document, const Region& region) const;

  const RegionPoints& part() const { return part_; }

  enum class Bytes {
    Exact,  // as fieldOf()
    Near    // up to a degree beside them where strokes have changed since the last call
  };
  // Valid until the next call. Throws InvalidInput, Cancelled.
  const OrientationField& field(const Region& region, Bytes bytes, Monitor& monitor);

 private:
  void find(std::span<const Stroke> strokes, Bytes bytes, Monitor& monitor);

  std::shared_ptr<const OpenedScan> scan_;
  Column<RegionId> labels_;
  RegionId id_;
  int neighbours_;
  FieldOptions options_;
  RegionPoints part_;
  std::unique_ptr<SmoothField> smooth_;  // null: not known, or of another method
  OrientationField plain_;               // of another method
  OrientationField turned_;              // the last by the region's rotation
  std::vector<Stroke> strokes_;          // that the field is of
  bool known_ = false, exact_ = false;   // it is, and exactly
};

}  // namespace dapple
