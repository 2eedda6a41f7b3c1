// [Zhang] Fast Hybrid Approach for Texturing Point Models, Appendix A, corrected. The printed
// formulas are wrong in three places:
// 1. q: the neighbour's own position is missing, and the step is not stretched to |FP|, although
// the
//    text says that it is: steps across a bend come out short.
// 2. T_f as printed has length c, so that axes shrink from step to step; here it is built from two
//    unit vectors perpendicular to N_f.
// 3. The weights in the maximum of D_pos are not normalised, so that D depends on the unit of the
//    file. Here w = u / max(L, u/1000): distances in swatch pixels.
// The formulas hold for S x T = N only, which the paper does not say.
//
// Beyond the paper ("one challenge is how to maintain the assigned texture orientation consistency
// in the patch expansion"): charts may follow a field of directions. Steps then turn by half of
// what the field turns from the contributor to the point, and the point's axes are the field's;
// where the field cannot be flattened contributors disagree about q, D grows, and the patch ends.
#include "synthesis/chart_fit.h"

#include <algorithm>
#include <cmath>

#include "base/simd.h"

namespace dapple {
namespace {

constexpr float kPositionWeight = 2, kOrientationWeight = 3;  // of D
constexpr float kSteepest =
    0.01f;                         // cosine to the neighbour's plane below which nothing is carried
constexpr float kOpposed = 1e-4f;  // squared, of the sum of two directions: they cancel out
constexpr float kShortest = 1e-3f;  // of a unit: nearer neighbours weigh no more

// What every contributor says: the transfer of Appendix A.
DAPPLE_CLONES void carryAll(ChartColumns& columns, std::size_t count) {
  float *dx = columns.dx.data(), *dy = columns.dy.data(), *dz = columns.dz.data(),
        *nx = columns.nx.data(), *ny = columns.ny.data(), *nz = columns.nz.data(),
        *tx = columns.tx.data(), *ty = columns.ty.data(), *tz = columns.tz.data(),
        *qx = columns.qx.data(), *qy = columns.qy.data(), *unit = columns.unit.data(),
        *weight = columns.weight.data();
  count = paddedToLanes(count);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    // V0 unit step, h its height over the neighbour's plane, c its cosine to that plane.
    const float length2 = dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i];
    const float length = std::sqrt(length2);
    const float inverse = length > 0 ? 1 / length : 0.f;  // a twin: V0 = 0 copies q, N and T
    const float vx = dx[i] * inverse, vy = dy[i] * inverse, vz = dz[i] * inverse;
    const float h = vx * nx[i] + vy * ny[i] + vz * nz[i];
    const float c2 = 1 - h * h;
    const float c = std::sqrt(c2 > 0.f ? c2 : 0.f);
    const float perC = c > kSteepest ? 1 / c : 0.f;
    // S = T x N
    const float sx = ty[i] * nz[i] - tz[i] * ny[i], sy = tz[i] * nx[i] - tx[i] * nz[i],
                sz = tx[i] * ny[i] - ty[i] * nx[i];
    const float alongS = vx * sx + vy * sy + vz * sz;
    const float alongT = vx * tx[i] + vy * ty[i] + vz * tz[i];
    const float stretch = length / unit[i] * perC;
    qx[i] += stretch * alongS;
    qy[i] -= stretch * alongT;
    const float fx = (nx[i] - h * vx) * perC, fy = (ny[i] - h * vy) * perC,
                fz = (nz[i] - h * vz) * perC;
    // M = N_f x V0
    const float mx = fy * vz - fz * vy, my = fz * vx - fx * vz, mz = fx * vy - fy * vx;
    const bool twin = !(length > 0);
    tx[i] = twin ? tx[i] : (alongT * vx + alongS * mx) * perC;
    ty[i] = twin ? ty[i] : (alongT * vy + alongS * my) * perC;
    tz[i] = twin ? tz[i] : (alongT * vz + alongS * mz) * perC;
    nx[i] = fx, ny[i] = fy, nz[i] = fz;
    const float shortest = unit[i] * kShortest;
    weight[i] = perC > 0.f ? unit[i] / (length > shortest ? length : shortest) : 0.f;
  }
}

inline const Float8* lanesOf(const std::vector<float>& column) {
  return reinterpret_cast<const Float8*>(column.data());
}

// In an order that does not depend on the processor.
[[gnu::always_inline]] inline float sumOfLanes(const Float8& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

[[gnu::always_inline]] inline float mostOfLanes(const Float8& v) {
  float most = v[0];
  for (std::size_t l = 1; l < kLanes; ++l) most = v[l] > most ? v[l] : most;
  return most;
}

// Of the directions that look the same as the frame's t, by whole turns / symmetry, the one that is
// nearest to `t`.
vec3 nearestTurn(const TangentFrame& frame, const vec3& t, int symmetry) {
  const float up = glm::dot(frame.t, t), right = glm::dot(frame.s, t);
  if (symmetry == 4 && std::abs(right) > std::abs(up)) return right < 0 ? -frame.s : frame.s;
  return symmetry > 1 && up < 0 ? -frame.t : frame.t;
}

struct WeightedMean {
  vec2 q;
  vec3 n, t;
  float weights;  // their sum; n and t are sums, too: only their direction matters
};

DAPPLE_CLONES WeightedMean meanOf(const ChartColumns& columns, std::size_t count) {
  const Float8 *inQx = lanesOf(columns.qx), *inQy = lanesOf(columns.qy),
               *inNx = lanesOf(columns.nx), *inNy = lanesOf(columns.ny),
               *inNz = lanesOf(columns.nz), *inTx = lanesOf(columns.tx),
               *inTy = lanesOf(columns.ty), *inTz = lanesOf(columns.tz),
               *weight = lanesOf(columns.weight);
  Float8 qx{}, qy{}, nx{}, ny{}, nz{}, tx{}, ty{}, tz{}, weights{};
  for (std::size_t b = 0; b < paddedToLanes(count) / kLanes; ++b) {
    const Float8 w = weight[b];
    qx += w * inQx[b], qy += w * inQy[b];
    nx += w * inNx[b], ny += w * inNy[b], nz += w * inNz[b];
    tx += w * inTx[b], ty += w * inTy[b], tz += w * inTz[b];
    weights += w;
  }
  const float sum = sumOfLanes(weights);
  return {vec2(sumOfLanes(qx), sumOfLanes(qy)) / sum,
          vec3(sumOfLanes(nx), sumOfLanes(ny), sumOfLanes(nz)),
          vec3(sumOfLanes(tx), sumOfLanes(ty), sumOfLanes(tz)), sum};
}

// D of section 3.2; the columns end in lanes of weight 0.
DAPPLE_CLONES float distortionOf(const ChartColumns& columns, std::size_t count,
                                 const ChartPoint& mean, float weights) {
  const vec3 S = mean.frame.s, T = mean.frame.t;
  const Float8 *qx = lanesOf(columns.qx), *qy = lanesOf(columns.qy), *nx = lanesOf(columns.nx),
               *ny = lanesOf(columns.ny), *nz = lanesOf(columns.nz), *tx = lanesOf(columns.tx),
               *ty = lanesOf(columns.ty), *tz = lanesOf(columns.tz),
               *weight = lanesOf(columns.weight);
  Float8 positionSum{}, positionMost{}, orientationSum{}, orientationMost{};
  for (std::size_t b = 0; b < paddedToLanes(count) / kLanes; ++b) {
    const Float8 ex = qx[b] - mean.q.x, ey = qy[b] - mean.q.y;
    Float8 apart = ex * ex + ey * ey;
    for (std::size_t l = 0; l < kLanes; ++l) apart[l] = std::sqrt(apart[l]);
    apart *= weight[b];
    // S_l = T_l x N_l
    const Float8 sx = ty[b] * nz[b] - tz[b] * ny[b], sy = tz[b] * nx[b] - tx[b] * nz[b],
                 sz = tx[b] * ny[b] - ty[b] * nx[b];
    const Float8 turned = weight[b] * (2 - (sx * S.x + sy * S.y + sz * S.z) -
                                       (tx[b] * T.x + ty[b] * T.y + tz[b] * T.z));
    positionSum += apart, orientationSum += turned;
    positionMost = apart > positionMost ? apart : positionMost;
    orientationMost = turned > orientationMost ? turned : orientationMost;
  }
  return kOrientationWeight *
             (sumOfLanes(orientationSum) / weights + mostOfLanes(orientationMost)) +
         kPositionWeight * (sumOfLanes(positionSum) / weights + mostOfLanes(positionMost));
}

}  // namespace

ChartFit::ChartFit(std::size_t capacity, float unit) : unit_(unit) {
  patch_.resize(capacity);
  for (const auto column : ChartColumns::kAll) (columns_.*column).resize(paddedToLanes(capacity));
}

void ChartFit::begin(const vec3& position, const SynthesisInput& input, Index i) {
  position_ = position;
  scale_ = input.scaleAt(i);
  symmetry_ = 0;
  count_ = 0;
  if (!input.follow) return;
  wanted_ = input.frames[i];
  symmetry_ = input.symmetry;
}

void ChartFit::add(const ChartSite& neighbour) {
  const std::size_t c = count_++;
  const vec3 step = position_ - neighbour.position;
  columns_.dx[c] = step.x, columns_.dy[c] = step.y, columns_.dz[c] = step.z;
  columns_.nx[c] = neighbour.n.x, columns_.ny[c] = neighbour.n.y, columns_.nz[c] = neighbour.n.z;
  columns_.tx[c] = neighbour.t.x, columns_.ty[c] = neighbour.t.y, columns_.tz[c] = neighbour.t.z;
  columns_.qx[c] = neighbour.q.x, columns_.qy[c] = neighbour.q.y;
  columns_.unit[c] = unit_ * 0.5f * (scale_ + neighbour.scale);
  patch_[c] = neighbour.patch;
}

// Every contributor's t becomes what lies half way to the field's at the point.
void ChartFit::steer() {
  for (std::size_t c = 0; c < count_; ++c) {
    const vec3 n(columns_.nx[c], columns_.ny[c], columns_.nz[c]);
    const vec3 t(columns_.tx[c], columns_.ty[c], columns_.tz[c]);
    const vec3 half = t + nearestTurn(wanted_, t, symmetry_);
    const vec3 flat = half - n * glm::dot(n, half);
    const float length2 = glm::dot(flat, flat);
    if (!(length2 > kOpposed)) continue;
    const vec3 turned = flat / std::sqrt(length2);
    columns_.tx[c] = turned.x, columns_.ty[c] = turned.y, columns_.tz[c] = turned.z;
  }
}

void ChartFit::finish() {
  if (symmetry_ > 0) steer();
  carryAll(columns_, count_);
  filter([&](std::size_t i) { return columns_.weight[i] > 0; });
}

void ChartFit::moveTo(std::size_t from, std::size_t to) {
  patch_[to] = patch_[from];
  for (const auto column : ChartColumns::kAll) (columns_.*column)[to] = (columns_.*column)[from];
}

// What is left in the last lanes must not count, nor be NaN.
void ChartFit::clearTail() {
  for (const auto column : ChartColumns::kAll)
    std::fill((columns_.*column).begin() + static_cast<std::ptrdiff_t>(count_),
              (columns_.*column).begin() + static_cast<std::ptrdiff_t>(paddedToLanes(count_)), 0.f);
}

template <class Keep>
void ChartFit::filter(Keep keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (!keep(i)) continue;
    if (kept != i) moveTo(i, kept);
    ++kept;
  }
  count_ = kept;
  clearTail();
}

Index ChartFit::dominantPatch() const {
  const auto end = patch_.begin() + static_cast<std::ptrdiff_t>(count_);
  if (count_ > 0 && std::all_of(patch_.begin(), end, [&](Index p) { return p == patch_[0]; }))
    return patch_[0];  // nearly always
  Index best = kNone;
  float most = -1;
  for (std::size_t c = 0; c < count_; ++c) {
    float sum = 0;
    for (std::size_t other = 0; other < count_; ++other)
      if (patch_[other] == patch_[c]) sum += columns_.weight[other];
    if (sum > most || (sum == most && patch_[c] < best)) most = sum, best = patch_[c];
  }
  return best;
}

void ChartFit::keepPatch(Index patch) {
  filter([&](std::size_t i) { return patch_[i] == patch; });
}

void ChartFit::keepNear(vec2 near, float pixels) {
  filter([&](std::size_t i) { return glm::length(q(i) - near) <= pixels; });
}

ChartPoint ChartFit::average() const {
  const WeightedMean mean = meanOf(columns_, count_);
  const vec3 t = symmetry_ > 0 ? nearestTurn(wanted_, mean.t, symmetry_) : mean.t;
  ChartPoint out{.q = mean.q, .frame = orthonormalFrame(mean.n, t)};
  const float distortion = distortionOf(columns_, count_, out, mean.weights);
  out.distortion = distortion < 0 ? 0 : distortion;  // by rounding; NaN stays
  return out;
}

}  // namespace dapple
