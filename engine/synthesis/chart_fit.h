// Flattens one point from its flattened neighbours: [Zhang] section 3.2 and Appendix A for all
// contributing neighbours at once. Growth, gap blending and patch expansion all go through here.
#pragma once

#include <vector>

#include "points/tangent_frames.h"
#include "synthesis/synthesis_input.h"

namespace dapple {

// One point of a chart, on one cache line: growth reads about twenty of these for each it writes.
struct alignas(64) ChartSite {
  vec3 position{0};  // as flattened (smoothed or not), local units
  vec3 normal{0};    // the scan's
  vec3 n{0}, t{0};   // the chart's axes, carried along; s = t x n
  vec2 q{0};         // flattened position, swatch pixels, y down
  Index patch = kNone;
  float scale = 1;  // SynthesisInput::scale
};

// A point as its contributors place it.
struct ChartPoint {
  vec2 q{0};
  TangentFrame frame;
  float distortion = 0;  // D = 3 D_ori + 2 D_pos
};

// Contributors to the fit of one point, a column for each number so that the arithmetic is done for
// several at a time; columns are padded to whole lanes.
struct ChartColumns {
  std::vector<float> dx, dy, dz;              // step from the contributor to the point
  std::vector<float> nx, ny, nz, tx, ty, tz;  // its axes, then carried to the point
  std::vector<float> qx, qy;                  // its position, then the point's, pixels
  std::vector<float> unit;                    // local units per pixel between it and the point
  std::vector<float> weight;

  static constexpr std::vector<float> ChartColumns::*kAll[] = {
      &ChartColumns::dx,    &ChartColumns::dy, &ChartColumns::dz, &ChartColumns::nx,
      &ChartColumns::ny,    &ChartColumns::nz, &ChartColumns::tx, &ChartColumns::ty,
      &ChartColumns::tz,    &ChartColumns::qx, &ChartColumns::qy, &ChartColumns::unit,
      &ChartColumns::weight};
};

// What neighbours say about where one point lies.
class ChartFit {
 public:
  // For at most `capacity` contributors; `unit` local units are one swatch pixel.
  ChartFit(std::size_t capacity, float unit);

  // Starts the fit of point i, laid out as if it were at `position`; its axes are to be those of
  // `input` where that says so.
  void begin(const vec3& position, const SynthesisInput& input, Index i);
  void add(const ChartSite& neighbour);  // a contributor
  void finish();                         // computes what every contributor says; drops steep ones

  std::size_t size() const { return count_; }
  // Where contributor c places the point.
  vec2 q(std::size_t c) const { return {columns_.qx[c], columns_.qy[c]}; }
  Index patch(std::size_t c) const { return patch_[c]; }
  float weight(std::size_t c) const { return columns_.weight[c]; }

  Index dominantPatch() const;          // the one of most weight; ties: the smaller id
  void keepPatch(Index patch);          // drops the contributors of other patches
  void keepNear(vec2 q, float pixels);  // drops those that place the point further away
  ChartPoint average() const;           // weighted mean and distortion; size() >= 1

 private:
  void steer();
  void moveTo(std::size_t from, std::size_t to);
  void clearTail();
  template <class Keep>
  void filter(Keep keep);

  float unit_;
  vec3 position_{0};
  float scale_ = 1;
  // That the chart's t should have here and its symmetry; 0: as the neighbours carry it.
  TangentFrame wanted_;
  int symmetry_ = 0;
  std::size_t count_ = 0;
  std::vector<Index> patch_;
  ChartColumns columns_;
};

}  // namespace dapple
