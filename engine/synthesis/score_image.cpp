#include "synthesis/score_image.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/hash_rng.h"
#include "swatch/gaussian_blur.h"

namespace dapple {
namespace {

// The study allowed 0.7 to 1.4, which makes more of a mirrored shape fit than of a true one.
constexpr float kLeastStretch = 0.8f, kMostStretch = 1.25f;
constexpr float kFirstDamping = 1e-2f;
constexpr float kSettled = 2e-3f;  // steps of a parameter (window nodes) below which it has settled
// A window of the surface may reach a step beyond its border, where nodes see only what is inside;
// so may those of the swatch, which continues its border texels.
constexpr float kOverhang = 1;
constexpr int kTries = 64;

constexpr float kEighth = std::numbers::pi_v<float> / 8;
constexpr float kDiagonal = std::numbers::sqrt2_v<float>;

int wrapInto(int i, int n) {
  const int r = i % n;
  return r < 0 ? r + n : r;
}

// right | up as a sum of a rotation by `turn` scaled by `even` and a reflected part scaled by
// `odd`; the singular values are even +- odd (even >= 0: not mirrored when even > odd).
struct Stretch {
  float evenX, evenY, oddX, oddY;
};

Stretch decompose(const Placement& p) {
  return {0.5f * (p.right.x + p.up.y), 0.5f * (p.right.y - p.up.x), 0.5f * (p.right.x - p.up.y),
          0.5f * (p.right.y + p.up.x)};
}

void compose(const Stretch& s, Placement& p) {
  p.right = {s.evenX + s.oddX, s.evenY + s.oddY};
  p.up = {s.oddY - s.evenY, s.evenX - s.oddX};
}

double contrastOf(const Swatch& swatch, const std::vector<vec3>& colours) {
  dvec3 sum(0), squares(0);
  double count = 0;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    if (!swatch.opaque[i]) continue;
    sum += dvec3(colours[i]);
    squares += dvec3(colours[i]) * dvec3(colours[i]);
    ++count;
  }
  const dvec3 mean = sum / count;
  const dvec3 variance = squares / count - mean * mean;
  return std::sqrt(std::max(0.0, (variance.x + variance.y + variance.z) / 3));
}

// Node coordinates in steps and their products, for the normal equations.
struct NodeTable {
  std::array<float, kWindowNodes> u, v, uu, uv, vv;
};

constexpr NodeTable makeNodeTable() {
  NodeTable table{};
  for (int i = 0; i < kWindowNodes; ++i) {
    const float u = static_cast<float>(i % kWindowSide) - kWindowReach;
    const float v = static_cast<float>(i / kWindowSide) - kWindowReach;
    table.u[i] = u, table.v[i] = v;
    table.uu[i] = u * u, table.uv[i] = u * v, table.vv[i] = v * v;
  }
  return table;
}

constexpr NodeTable kNodes = makeNodeTable();

using Column = std::array<float, kWindowNodes>;

float dot(const Column& a, const Column& b) {
  Float4 sum{};
  for (int i = 0; i < kWindowNodes; i += 4)
    for (int l = 0; l < 4; ++l) sum[l] += a[i + l] * b[i + l];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

float total(const Column& a) {
  Float4 sum{};
  for (int i = 0; i < kWindowNodes; i += 4)
    for (int l = 0; l < 4; ++l) sum[l] += a[i + l];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

using Matrix6 = Eigen::Matrix<float, 6, 6>;
using Vector6 = Eigen::Matrix<float, 6, 1>;

// Moments of one product of gradients: the 3 x 3 block for (1, u, v).
Eigen::Matrix3f momentBlock(const Column& product) {
  const float one = total(product), u = dot(product, kNodes.u), v = dot(product, kNodes.v);
  const float uv = dot(product, kNodes.uv);
  Eigen::Matrix3f block;
  block << one, u, v, u, dot(product, kNodes.uu), uv, v, uv, dot(product, kNodes.vv);
  return block;
}

}  // namespace

// Sum of squared differences and the normal equations of the six parameters (centre x, right x,
// up x, then the same for y; all in pixels, the axes per step).
struct ScoreImage::Fit {
  float squares = 0;
  Matrix6 normal;
  Vector6 gradient;
};

Placement turnedPlacement(vec2 centre, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {centre, {c, s}, {-s, c}};
}

ScoreImage::ScoreImage(const Swatch& swatch, double step)
    : swatch_(swatch), step_(static_cast<float>(step)) {
  const int w = swatch.width, h = swatch.height;
  const std::vector<vec3> blurred = blurSwatch(swatch, 0.5 * step);
  contrast_ = contrastOf(swatch, blurred);
  // A swatch smaller than a turned window has no place for it: its windows wrap round instead.
  const float need = 2 * kWindowReach * step_ * kDiagonal + 1;
  wraps_ = swatch.tileable || static_cast<float>(std::min(w, h)) < need;
  pad_ = static_cast<int>(std::ceil(kWindowReach * step_ * kMostStretch * kDiagonal)) + 2;
  stride_ = w + 2 * pad_;
  texels_.resize(static_cast<std::size_t>(stride_) * (h + 2 * pad_));
  for (int y = -pad_; y < h + pad_; ++y) {
    for (int x = -pad_; x < w + pad_; ++x) {
      const int column = wraps_ ? wrapInto(x, w) : std::clamp(x, 0, w - 1);
      const int row = h - 1 - (wraps_ ? wrapInto(y, h) : std::clamp(y, 0, h - 1));
      const vec3 c = blurred[static_cast<std::size_t>(row) * w + column];
      texels_[static_cast<std::size_t>(y + pad_) * stride_ + x + pad_] = Float4{c.x, c.y, c.z, 0};
    }
  }
  relaxed_ = !wraps_ && swatch.hasHoles && !someWindowFits();
}

bool ScoreImage::someWindowFits() const {
  for (int y = 0; y < height(); ++y)
    for (int x = 0; x < width(); ++x)
      for (int turn = 0; turn < 4; ++turn) {
        const vec2 centre(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        if (holds(turnedPlacement(centre, kEighth * static_cast<float>(turn)))) return true;
      }
  return false;
}

// How far from the border the centre must stay.
vec2 ScoreImage::rimOf(const Placement& p) const {
  return kWindowReach * step_ * (glm::abs(p.right) + glm::abs(p.up)) - kOverhang * step_ + 0.5f;
}

bool ScoreImage::holds(const Placement& p) const {
  if (free()) return true;
  const float w = static_cast<float>(width()), h = static_cast<float>(height());
  const vec2 rim = 0.999f * rimOf(p);
  if (glm::any(glm::lessThan(p.centre, rim)) ||
      glm::any(glm::greaterThan(p.centre, vec2(w, h) - rim)))
    return false;
  if (!swatch_.hasHoles) return true;
  for (int i = 0; i < kWindowNodes; ++i) {
    const vec2 at = p.centre + step_ * (kNodes.u[i] * p.right + kNodes.v[i] * p.up);
    if (!usableTexel(swatch_, glm::clamp(vec2(at.x, h - at.y), vec2(0.5f), vec2(w, h) - 0.5f)))
      return false;
  }
  return true;
}

Placement ScoreImage::randomPlacement(TurnLimit limit, std::uint64_t seed,
                                      std::uint64_t draw) const {
  const float most = std::min(limit.angle, std::numbers::pi_v<float>);
  Placement placement;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const auto uniform = [&](std::uint64_t i) { return hashUniform(seed, draw, attempt, i); };
    placement = turnedPlacement(
        {uniform(0) * static_cast<float>(width()), uniform(1) * static_cast<float>(height())},
        most * (2 * uniform(2) - 1));
    if (holds(placement)) break;
  }
  return restrained(placement, limit);
}

Window ScoreImage::read(const Placement& p) const {
  Window window;
  const float shift = static_cast<float>(pad_) - 0.5f;
  for (int i = 0; i < kWindowNodes; ++i) {
    const vec2 at = p.centre + shift + step_ * (kNodes.u[i] * p.right + kNodes.v[i] * p.up);
    const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
    const float fx = at.x - static_cast<float>(x), fy = at.y - static_cast<float>(y);
    const Float4* t = texels_.data() + static_cast<std::size_t>(y) * stride_ + x;
    const Float4 low = t[0] + fx * (t[1] - t[0]);
    const Float4 high = t[stride_] + fx * (t[stride_ + 1] - t[stride_]);
    window.node[i] = low + fy * (high - low);
  }
  return window;
}

ScoreImage::Fit ScoreImage::compare(const Window& target, const Placement& p) const {
  alignas(16) Column xx, xy, yy, xr, yr;
  Float4 squares{};
  const float shift = static_cast<float>(pad_) - 0.5f;
  for (int i = 0; i < kWindowNodes; ++i) {
    const vec2 at = p.centre + shift + step_ * (kNodes.u[i] * p.right + kNodes.v[i] * p.up);
    const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
    const float fx = at.x - static_cast<float>(x), fy = at.y - static_cast<float>(y);
    const Float4* t = texels_.data() + static_cast<std::size_t>(y) * stride_ + x;
    const Float4 lowStep = t[1] - t[0], highStep = t[stride_ + 1] - t[stride_];
    const Float4 low = t[0] + fx * lowStep, high = t[stride_] + fx * highStep;
    const Float4 gx = lowStep + fy * (highStep - lowStep), gy = high - low;
    const Float4 r = low + fy * gy - target.node[i];
    squares += r * r;
    const auto sum = [](const Float4& f) { return f[0] + f[1] + f[2]; };
    xx[i] = sum(gx * gx), xy[i] = sum(gx * gy), yy[i] = sum(gy * gy);
    xr[i] = sum(gx * r), yr[i] = sum(gy * r);
  }
  Fit fit;
  fit.squares = squares[0] + squares[1] + squares[2];
  fit.normal.topLeftCorner<3, 3>() = momentBlock(xx);
  fit.normal.topRightCorner<3, 3>() = momentBlock(xy);
  fit.normal.bottomLeftCorner<3, 3>() = fit.normal.topRightCorner<3, 3>();
  fit.normal.bottomRightCorner<3, 3>() = momentBlock(yy);
  fit.gradient << total(xr), dot(xr, kNodes.u), dot(xr, kNodes.v), total(yr), dot(yr, kNodes.u),
      dot(yr, kNodes.v);
  return fit;
}

Placement ScoreImage::restrained(Placement p, TurnLimit limit) const {
  Stretch s = decompose(p);
  const float even = std::hypot(s.evenX, s.evenY), odd = std::hypot(s.oddX, s.oddY);
  if (!(even > 1e-6f)) return turnedPlacement(p.centre, 0);
  const float big = std::clamp(even + odd, kLeastStretch, kMostStretch);
  const float small = std::clamp(even - odd, kLeastStretch, kMostStretch);
  const float evenScale = 0.5f * (big + small) / even;
  const float oddScale = odd > 0 ? 0.5f * (big - small) / odd : 0.0f;
  s = {s.evenX * evenScale, s.evenY * evenScale, s.oddX * oddScale, s.oddY * oddScale};
  const float angle = std::atan2(s.evenY, s.evenX);
  if (std::abs(angle) > limit.angle) {
    const float length = 0.5f * (big + small);
    s.evenX = length * std::cos(limit.angle);
    s.evenY = std::copysign(length * std::sin(limit.angle), angle);
  }
  compose(s, p);

  const vec2 size(width(), height());
  if (wraps_) {
    p.centre -= size * glm::floor(p.centre / size);
  } else {
    const vec2 rim = rimOf(p);
    for (int axis = 0; axis < 2; ++axis)
      p.centre[axis] = 2 * rim[axis] < size[axis]
                           ? std::clamp(p.centre[axis], rim[axis], size[axis] - rim[axis])
                           : 0.5f * size[axis];
  }
  return p;
}

float ScoreImage::refine(const Window& target, TurnLimit limit, int iterations,
                         Placement& placement) const {
  placement = restrained(placement, limit);
  Fit best = compare(target, placement);
  float damping = kFirstDamping;
  for (int i = 0; i < iterations; ++i) {
    Matrix6 damped = best.normal;
    damped.diagonal() *= 1 + damping;
    damped.diagonal().array() += 1e-6f;
    const Vector6 move = damped.ldlt().solve(-best.gradient);
    if (!move.allFinite()) break;
    Placement next = placement;
    next.centre += vec2(move[0], move[3]);
    next.right += vec2(move[1], move[4]) / step_;
    next.up += vec2(move[2], move[5]) / step_;
    next = restrained(next, limit);
    const Fit fit = compare(target, next);
    if (fit.squares < best.squares && holds(next)) {
      placement = next;
      best = fit;
      damping *= 0.3f;
      if (move.cwiseAbs().maxCoeff() < kSettled * step_) break;
    } else {
      damping *= 10;
      if (damping > 100) break;
    }
  }
  return std::sqrt(best.squares / kWindowNumbers);
}

}  // namespace dapple
