#include "document/region_field.h"

#include "regions/smooth_field.h"

namespace dapple {
namespace {

constexpr float kNear = 1;  // degrees

}  // namespace

RegionField::RegionField(const Document& document, const Region& region, Monitor& monitor)
    : scan_(document.scan),
      labels_(document.labels),
      id_(region.id),
      neighbours_(region.options.neighbours),
      options_(fieldOptionsOf(region.options)),
      part_(document, region, monitor) {}

RegionField::~RegionField() = default;

bool RegionField::fits(const Document& document, const Region& region) const {
  return scan_ == document.scan && labels_ == document.labels && id_ == region.id &&
         neighbours_ == region.options.neighbours && options_ == fieldOptionsOf(region.options);
}

void RegionField::find(std::span<const Stroke> strokes, Bytes bytes, Monitor& monitor) {
  // Until all is done there is nothing to go on from.
  const bool goesOn = std::exchange(known_, false) && bytes == Bytes::Near;
  exact_ = true;
  const PointSet& points = part_.points();
  const Neighborhoods& neighborhoods = part_.neighborhoods();
  if (options_.method != FieldMethod::Smooth || neighborhoods.k == 0) {
    plain_ = orientPoints(points, neighborhoods, strokes, options_, monitor);
  } else {
    if (!smooth_) smooth_ = std::make_unique<SmoothField>(points, neighborhoods, options_, monitor);
    const std::vector<StrokeMark> marks = strokeMarks(points, neighborhoods, strokes);
    if (goesOn)
      smooth_->update(marks, kNear, monitor), exact_ = false;
    else
      smooth_->solve(marks, monitor);
  }
  strokes_.assign(strokes.begin(), strokes.end());
  known_ = true;
}

const OrientationField& RegionField::field(const Region& region, Bytes bytes, Monitor& monitor) {
  const std::vector<Stroke> strokes = part_.strokes(region);
  const bool found = known_ && strokes == strokes_ && (exact_ || bytes == Bytes::Near);
  if (!found) find(strokes, bytes, monitor);
  const OrientationField& straight = smooth_ ? smooth_->field() : plain_;
  if (region.rotation == 0) return straight;
  turned_ = straight;
  rotate(turned_.frames, region.rotation);
  return turned_;
}

}  // namespace dapple
