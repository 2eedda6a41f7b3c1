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
#include "synthesis/chart_fit.h"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

constexpr float kPositionWeight = 2, kOrientationWeight = 3;  // of D
constexpr float kSteepest =
    0.01f;  // cosine to the neighbour's plane below which nothing is carried
constexpr float kShortest = 1e-3f;  // of a unit: nearer neighbours weigh no more

}  // namespace

ChartFit::ChartFit(std::size_t capacity, float unit) : unit_(unit) {
  patch_.resize(capacity);
  for (auto* column : {&dx_, &dy_, &dz_, &nx_, &ny_, &nz_, &tx_, &ty_, &tz_, &qx_, &qy_, &weight_,
                       &apart_, &turned_})
    column->resize(capacity);
}

void ChartFit::begin(const vec3& position) {
  position_ = position;
  count_ = 0;
}

void ChartFit::add(const ChartSite& neighbour) {
  const std::size_t c = count_++;
  const vec3 step = position_ - neighbour.position;
  dx_[c] = step.x, dy_[c] = step.y, dz_[c] = step.z;
  nx_[c] = neighbour.n.x, ny_[c] = neighbour.n.y, nz_[c] = neighbour.n.z;
  tx_[c] = neighbour.t.x, ty_[c] = neighbour.t.y, tz_[c] = neighbour.t.z;
  qx_[c] = neighbour.q.x, qy_[c] = neighbour.q.y;
  patch_[c] = neighbour.patch;
}

void ChartFit::finish() {
  const float shortest = unit_ * kShortest, perUnit = 1 / unit_;
  float *dx = dx_.data(), *dy = dy_.data(), *dz = dz_.data(), *nx = nx_.data(), *ny = ny_.data(),
        *nz = nz_.data(), *tx = tx_.data(), *ty = ty_.data(), *tz = tz_.data(), *qx = qx_.data(),
        *qy = qy_.data(), *weight = weight_.data();
  const std::size_t count = count_;
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
    const float stretch = length * perUnit * perC;
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
    weight[i] = perC > 0.f ? unit_ / (length > shortest ? length : shortest) : 0.f;
  }
  filter([&](std::size_t i) { return weight_[i] > 0; });
}

void ChartFit::moveTo(std::size_t from, std::size_t to) {
  patch_[to] = patch_[from];
  for (auto* column : {&nx_, &ny_, &nz_, &tx_, &ty_, &tz_, &qx_, &qy_, &weight_})
    (*column)[to] = (*column)[from];
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
}

Index ChartFit::dominantPatch() const {
  Index best = kNone;
  float most = -1;
  for (std::size_t c = 0; c < count_; ++c) {
    float sum = 0;
    for (std::size_t other = 0; other < count_; ++other)
      if (patch_[other] == patch_[c]) sum += weight_[other];
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
  vec2 q(0);
  vec3 n(0), t(0);
  float weights = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const float w = weight_[i];
    q.x += w * qx_[i], q.y += w * qy_[i];
    n.x += w * nx_[i], n.y += w * ny_[i], n.z += w * nz_[i];
    t.x += w * tx_[i], t.y += w * ty_[i], t.z += w * tz_[i];
    weights += w;
  }
  ChartPoint out{.q = q / weights, .frame = orthonormalFrame(n, t)};
  const vec3 S = out.frame.s, T = out.frame.t;
  const float *nx = nx_.data(), *ny = ny_.data(), *nz = nz_.data(), *tx = tx_.data(),
              *ty = ty_.data(), *tz = tz_.data(), *qx = qx_.data(), *qy = qy_.data(),
              *weight = weight_.data();
  float *apart = apart_.data(), *turned = turned_.data();
#pragma GCC ivdep
  for (std::size_t i = 0; i < count_; ++i) {
    const float ex = qx[i] - out.q.x, ey = qy[i] - out.q.y;
    apart[i] = weight[i] * std::sqrt(ex * ex + ey * ey);
    const float sx = ty[i] * nz[i] - tz[i] * ny[i], sy = tz[i] * nx[i] - tx[i] * nz[i],
                sz = tx[i] * ny[i] - ty[i] * nx[i];
    turned[i] = weight[i] *
                (2 - (sx * S.x + sy * S.y + sz * S.z) - (tx[i] * T.x + ty[i] * T.y + tz[i] * T.z));
  }
  float positionSum = 0, positionMost = 0, orientationSum = 0, orientationMost = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    positionSum += apart[i];
    orientationSum += turned[i];
    positionMost = std::max(positionMost, apart[i]);
    orientationMost = std::max(orientationMost, turned[i]);
  }
  out.distortion = kOrientationWeight * (orientationSum / weights + orientationMost) +
                   kPositionWeight * (positionSum / weights + positionMost);
  return out;
}

}  // namespace dapple
