#include "document/region_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dapple {
namespace {

// The first `k` of each point's.
Neighborhoods nearest(const Neighborhoods& all, std::size_t k) {
  Neighborhoods out{.k = k};
  out.ids.reserve(all.size() * k);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto ids = all.of(i).first(k);
    out.ids.insert(out.ids.end(), ids.begin(), ids.end());
  }
  return out;
}

// Strokes over the points that were taken out: what runs outside is cut off.
std::vector<Stroke> strokesWithin(const Column<Stroke>& strokes, std::span<const Index> ids) {
  std::vector<Stroke> out;
  if (!strokes) return out;
  for (const Stroke& stroke : *strokes) {
    if (ids.empty()) {
      out.push_back(stroke);
      continue;
    }
    Stroke piece{.weight = stroke.weight, .scale = stroke.scale};
    const auto endPiece = [&] {
      if (piece.points.size() >= 2) out.push_back(piece);
      piece.points.clear();
      piece.positions.clear();
    };
    for (std::size_t p = 0; p < stroke.points.size(); ++p) {
      const auto at = std::lower_bound(ids.begin(), ids.end(), stroke.points[p]);
      if (at == ids.end() || *at != stroke.points[p]) {
        endPiece();
        continue;
      }
      piece.points.push_back(static_cast<Index>(at - ids.begin()));
      piece.positions.push_back(stroke.positions[p]);
    }
    endPiece();
  }
  return out;
}

}  // namespace

void rotate(std::vector<TangentFrame>& frames, double degrees) {
  if (degrees == 0) return;
  const double angle = degrees * std::numbers::pi / 180;
  const float c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  for (TangentFrame& frame : frames) {
    const vec3 right = frame.s, up = frame.t;
    frame.s = c * right + s * up;
    frame.t = c * up - s * right;
  }
}

PointSet takenOut(const PointSet& points, std::span<const Index> ids) {
  PointSet out{.positions = gathered(points.positions, ids),
               .normals = gathered(points.normals, ids),
               .origin = points.origin,
               .modelUnits = points.modelUnits};
  return out;
}

RegionPoints::RegionPoints(const Document& document, const Region& region, Monitor& monitor)
    : scan_(document.scan), ids_(pointsOf(document, region.id)), count_(ids_.size()) {
  if (count_ == 0) return;
  const Neighborhoods& scans = scan_->prepared.neighborhoods;
  const std::size_t k = std::min(static_cast<std::size_t>(region.options.neighbours), count_ - 1);
  whole_ = count_ == document.size();
  if (whole_)
    ids_.clear();
  else
    points_ = takenOut(document.points(), ids_);
  scansLinks_ = whole_ && k == scans.k;
  if (scansLinks_ || count_ < kFewestPoints) return;
  links_ = whole_ && k < scans.k ? nearest(scans, k)
                                 : buildNeighborhoods(points().positions, k, monitor);
}

std::vector<Stroke> RegionPoints::strokes(const Region& region) const {
  return strokesWithin(region.strokes, ids_);
}

OrientationField fieldOf(const RegionPoints& part, const Region& region,
                         std::span<const Stroke> strokes, Monitor& monitor) {
  OrientationField field =
      directionsOf(part.points(), part.neighborhoods(), strokes, region.options, monitor);
  rotate(field.frames, region.rotation);
  return field;
}

}  // namespace dapple
