// Zwicker et al. 2001, Botsch et al. 2005, as in splat_renderer.cpp, with the disc's image taken to
// be an ellipse: its perspective is that of its centre. Departure: the kernel is a polynomial.
#include "app/render/splat_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/simd.h"

namespace dapple {
namespace {

constexpr float kDepthOffset = 1;  // radii
constexpr float kSteepest = 4;     // slope up to which a pixel's own depth is allowed for
constexpr float kAmbient = 0.25f;
constexpr float kLeast = 1e-3f;    // so that a disc alone is seen to its rim
constexpr float kEdgeOn = 1e-4f;   // least cosine between the disc's plane and the ray
constexpr float kSlack = 0.0625f;  // samples

// exp(-2.5 d) - exp(-2.5) within 0.0013 for d in 0..1.
constexpr float kKernel[] = {0.91664182f, -1.54443346f, 1.29660787f, -0.47839974f};

const Float8& lanes(const float* from) {
  return *reinterpret_cast<const Float8*>(from);
}
Float8& lanes(float* from) {
  return *reinterpret_cast<Float8*>(from);
}
Int8& lanes(int* from) {
  return *reinterpret_cast<Int8*>(from);
}

[[gnu::always_inline]] inline void squareRoot(Float8& v) {
  for (std::size_t l = 0; l < kLanes; ++l) v[l] = std::sqrt(v[l]);
}
[[gnu::always_inline]] inline void limitTo(Float8& v, const Float8& low, const Float8& high) {
  v = v < low ? low : v;
  v = v > high ? high : v;
}

// A block of points in the camera's axes.
struct Seen {
  Float8 x, y, depth;
};
[[gnu::always_inline]] inline void rotate(const SplatView& view, const Float8& x, const Float8& y,
                                          const Float8& z, Seen& out) {
  const auto& r = view.rows;
  out.x = r[0][0] * x + r[0][1] * y + r[0][2] * z;
  out.y = r[1][0] * x + r[1][1] * y + r[1][2] * z;
  out.depth = r[2][0] * x + r[2][1] * y + r[2][2] * z;
}

}  // namespace

DAPPLE_CLONES void findTiles(const SplatScene& scene, const SplatView& view, const TileGrid& grid,
                             PointRange range, TileRange* out) {
  const float perTile = 1 / static_cast<float>(grid.step);
  const float lastColumn = static_cast<float>(grid.columns - 1);
  const float lastRow = static_cast<float>(grid.rows - 1);
  for (std::size_t i = range.begin; i < range.end; i += kLanes) {
    Seen c;
    rotate(view, lanes(&scene.x[i]), lanes(&scene.y[i]), lanes(&scene.z[i]), c);
    c.x -= view.eye[0], c.y -= view.eye[1], c.depth -= view.eye[2];
    const Float8 radius = lanes(&scene.radius[i]);
    const Int8 seen = (c.depth >= view.nearest) & (c.depth <= view.farthest) & (radius > 0);
    const Float8 perDepth = 1 / c.depth;
    // The disc lies in a ball; its image is longer by the length of the ray at most, and by what
    // is nearer to the eye than its centre.
    const Float8 sx = c.x * perDepth, sy = c.y * perDepth;
    Float8 reach = 1 + sx * sx + sy * sy;
    squareRoot(reach);
    reach = view.focal * radius * perDepth * reach;
    reach = (reach < view.lowPass ? view.lowPass + 0 * reach : reach) + kSlack;
    const Float8 px = view.focal * sx - grid.originX, py = view.focal * sy - grid.originY;
    const Float8 none{}, column = none + lastColumn, row = none + lastRow;
    const Float8 farLeft = none - 1, farRight = column + 1, farBottom = row + 1;
    Float8 left = (px - reach) * perTile, right = (px + reach) * perTile;
    Float8 top = (py - reach) * perTile, bottom = (py + reach) * perTile;
    limitTo(left, farLeft, farRight), limitTo(right, farLeft, farRight);
    limitTo(top, farLeft, farBottom), limitTo(bottom, farLeft, farBottom);
    const Int8 inside = seen & (right >= 0) & (bottom >= 0) & (left < farRight) & (top < farBottom);
    limitTo(left, none, column), limitTo(right, none, column);
    limitTo(top, none, row), limitTo(bottom, none, row);
    Seen n;
    rotate(view, lanes(&scene.nx[i]), lanes(&scene.ny[i]), lanes(&scene.nz[i]), n);
    const Int8 away = (n.x * sx + n.y * sy + n.depth > 0) & 1;
    const Int8 l = __builtin_convertvector(left, Int8), r = __builtin_convertvector(right, Int8);
    const Int8 t = __builtin_convertvector(top, Int8), b = __builtin_convertvector(bottom, Int8);
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      out[i - range.begin + lane] = {
          inside[lane] != 0 ? static_cast<std::uint8_t>(l[lane]) : kNoTile,
          static_cast<std::uint8_t>(t[lane]), static_cast<std::uint8_t>(r[lane]),
          static_cast<std::uint8_t>(b[lane]), static_cast<std::uint8_t>(away[lane])};
  }
}

float farthestSeen(const SplatTile& tile, int side) {
  float farthest = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) farthest = std::max(farthest, tile.depth[y * kSplatStride + x]);
  return farthest;
}

// long: one projection, whose many terms are shared
DAPPLE_CLONES std::size_t projectSplats(const SplatScene& scene, const SplatView& view,
                                        const TilePlace& place, std::span<const Index> points,
                                        ProjectedSplats* out) {
  std::size_t kept = 0;
  const Float8 zero{}, one = zero + 1;
  for (std::size_t begin = 0; begin < points.size(); begin += kLanes) {
    const std::size_t count = std::min(kLanes, points.size() - begin);
    ProjectedSplats& s = out[kept];
    Float8 x, y, z, radius;
    for (std::size_t l = 0; l < kLanes; ++l) {
      const Index i = points[begin + std::min(l, count - 1)];
      s.point[l] = i;
      x[l] = scene.x[i], y[l] = scene.y[i], z[l] = scene.z[i];
      radius[l] = scene.radius[i];
    }
    Seen c, n;
    rotate(view, x, y, z, c);
    c.x -= view.eye[0], c.y -= view.eye[1], c.depth -= view.eye[2];
    const Int8 hidden = c.depth - radius > place.farthest;
    int visible = 0;
    for (std::size_t l = 0; l < kLanes; ++l) visible |= ~hidden[l];
    if (visible == 0) continue;
    Float8 ax, ay, az;
    Int8 colour;
    for (std::size_t l = 0; l < kLanes; ++l) {
      const Index i = s.point[l];
      ax[l] = scene.nx[i], ay[l] = scene.ny[i], az[l] = scene.nz[i];
      colour[l] = static_cast<int>(scene.colour[i]);
    }
    rotate(view, ax, ay, az, n);
    // s: the ray through the centre is (sx, sy, 1).
    const Float8 perDepth = 1 / c.depth;
    const Float8 sx = c.x * perDepth, sy = c.y * perDepth;
    Float8 ray = 1 + sx * sx + sy * sy;
    squareRoot(ray);
    // A point without a normal faces the eye.
    const Int8 any = ax * ax + ay * ay + az * az > 0.25f;
    n.x = any ? n.x : -sx / ray, n.y = any ? n.y : -sy / ray, n.depth = any ? n.depth : -1 / ray;
    Float8 q = n.x * sx + n.y * sy + n.depth;
    const Float8 steep = q < 0 ? -q : q;
    q = steep < kEdgeOn ? (q < 0 ? zero - kEdgeOn : zero + kEdgeOn) : q;
    // Covariance of the disc's image over its radius squared: J (I - n n^T) J^T.
    const Float8 ex = n.x - sx * n.depth, ey = n.y - sy * n.depth;
    Float8 cxx = 1 + sx * sx - ex * ex, cyy = 1 + sy * sy - ey * ey;
    const Float8 cxy = sx * sy - ex * ey;
    cxx = cxx < 0 ? zero : cxx, cyy = cyy < 0 ? zero : cyy;
    const Float8 scale = view.focal * radius * perDepth;
    const Float8 inverse = 1 / (scale * scale * q * q);
    Float8 width = cxx, height = cyy;
    squareRoot(width), squareRoot(height);
    width *= scale, height *= scale;
    width = (width < view.lowPass ? zero + view.lowPass : width) + kSlack;
    height = (height < view.lowPass ? zero + view.lowPass : height) + kSlack;
    const Float8 px = view.focal * sx - place.x, py = view.focal * sy - place.y;
    const Float8 facing = steep / ray;
    Float8 tilt = one - facing * facing;
    tilt = tilt < 0 ? zero : tilt;
    squareRoot(tilt);
    Float8 slope = tilt / (facing < 1e-3f ? zero + 1e-3f : facing);
    slope = slope > kSteepest ? zero + kSteepest : slope;
    const Float8 offset = kDepthOffset * radius + view.lowPass / view.focal * c.depth * slope;
    Float8 reach = one - n.depth * n.depth;
    reach = reach < 0 ? zero : reach;
    squareRoot(reach);
    const Float8 perSlope = c.depth / (view.focal * q);
    const Float8 light = view.headlight ? kAmbient + (1 - kAmbient) * facing : one;
    // Sample i of the tile lies at i + 0.5.
    Float8 left = px - width - 0.5f, right = px + width - 0.5f;
    Float8 top = py - height - 0.5f, bottom = py + height - 0.5f;
    const Float8 outside = zero + static_cast<float>(kSplatTile), before = zero - 1;
    limitTo(left, before, outside), limitTo(right, before, outside);
    limitTo(top, before, outside), limitTo(bottom, before, outside);
    const Int8 lane{0, 1, 2, 3, 4, 5, 6, 7};
    const Int8 drawn = ~hidden & (lane < static_cast<int>(count));
    const Int8 last = Int8{} + (kSplatTile - 1);
    const Int8 from = __builtin_convertvector(left + 1, Int8);
    Int8 to = __builtin_convertvector(right + 1, Int8) - 1;
    Int8 low = __builtin_convertvector(bottom + 1, Int8) - 1;
    to = to > last ? last : to;
    low = low > last ? last : low;
    low = drawn ? low : Int8{} - 1;
    lanes(s.x) = px - 0.5f, lanes(s.y) = py - 0.5f;
    lanes(s.xx) = cyy * inverse, lanes(s.xy) = -cxy * inverse, lanes(s.yy) = cxx * inverse;
    lanes(s.depth) = c.depth;
    // The plane's depth along a ray is (n.c) / (n.ray).
    lanes(s.slopeX) = -n.x * perSlope, lanes(s.slopeY) = -n.y * perSlope;
    lanes(s.reach) = radius * reach, lanes(s.offset) = offset;
    lanes(s.red) = light * __builtin_convertvector(colour & 255, Float8);
    lanes(s.green) = light * __builtin_convertvector(colour >> 8 & 255, Float8);
    lanes(s.blue) = light * __builtin_convertvector(colour >> 16 & 255, Float8);
    lanes(s.left) = from, lanes(s.right) = to;
    lanes(s.top) = __builtin_convertvector(top + 1, Int8), lanes(s.bottom) = low;
    ++kept;
  }
  return kept;
}

namespace {

// A splat as its samples see it.
struct Splat {
  float x, y, xx, xy, yy, depth, slopeX, slopeY, reach;
  int left, right, top, bottom;
};
[[gnu::always_inline]] inline Splat splatOf(const ProjectedSplats& s, int l) {
  return {s.x[l],      s.y[l],     s.xx[l],   s.xy[l],    s.yy[l],  s.depth[l], s.slopeX[l],
          s.slopeY[l], s.reach[l], s.left[l], s.right[l], s.top[l], s.bottom[l]};
}

// The squared distance of eight samples from a splat's centre (1 at its rim, on the screen or on
// the disc, whatever is less) and the depth of its plane there.
struct Reached {
  Float8 distance, depth;
};
[[gnu::always_inline]] inline void reachSamples(const Splat& s, float perLowPass2, const Float8& dx,
                                                float dy, Reached& out) {
  const Float8 disc = (s.xx * dx + 2 * s.xy * dy) * dx + s.yy * dy * dy;
  const Float8 screen = (dx * dx + dy * dy) * perLowPass2;
  out.distance = disc < screen ? disc : screen;
  const Float8 zero{};
  Float8 apart = s.slopeX * dx + s.slopeY * dy;
  limitTo(apart, zero - s.reach, zero + s.reach);
  out.depth = s.depth + apart;
}

constexpr Float8 kSteps{0, 1, 2, 3, 4, 5, 6, 7};

}  // namespace

DAPPLE_CLONES void drawDepths(std::span<const ProjectedSplats> splats, float lowPass,
                              SplatTile& tile) {
  const float perLowPass2 = 1 / (lowPass * lowPass);
  for (const ProjectedSplats& block : splats)
    for (int l = 0; l < ProjectedSplats::kCount; ++l) {
      const Splat s = splatOf(block, l);
      const float offset = block.offset[l];
      for (int y = s.top; y <= s.bottom; ++y)
        for (int x = s.left; x <= s.right; x += static_cast<int>(kLanes)) {
          const Float8 dx = kSteps + (static_cast<float>(x) - s.x);
          Reached r;
          reachSamples(s, perLowPass2, dx, static_cast<float>(y) - s.y, r);
          r.depth += offset;
          Float8& nearest = lanes(&tile.depth[y * kSplatStride + x]);
          nearest = ((r.distance <= 1) & (r.depth < nearest)) ? r.depth : nearest;
        }
    }
}

DAPPLE_CLONES void drawColours(std::span<const ProjectedSplats> splats, float lowPass, bool trace,
                               SplatTile& tile) {
  const float perLowPass2 = 1 / (lowPass * lowPass);
  const Float8 zero{}, least = zero + kLeast;
  for (const ProjectedSplats& block : splats)
    for (int l = 0; l < ProjectedSplats::kCount; ++l) {
      const Splat s = splatOf(block, l);
      const float red = block.red[l], green = block.green[l], blue = block.blue[l];
      for (int y = s.top; y <= s.bottom; ++y)
        for (int x = s.left; x <= s.right; x += static_cast<int>(kLanes)) {
          const int at = y * kSplatStride + x;
          const Float8 dx = kSteps + (static_cast<float>(x) - s.x);
          Reached r;
          reachSamples(s, perLowPass2, dx, static_cast<float>(y) - s.y, r);
          const Float8 &distance = r.distance, &depth = r.depth;
          const Int8 counts = (distance <= 1) & (depth <= lanes(&tile.depth[at]));
          Float8 weight =
              (1 - distance) *
              (((kKernel[3] * distance + kKernel[2]) * distance + kKernel[1]) * distance +
               kKernel[0]);
          weight = weight < least ? least : weight;
          weight = counts ? weight : zero;
          lanes(&tile.red[at]) += weight * red;
          lanes(&tile.green[at]) += weight * green;
          lanes(&tile.blue[at]) += weight * blue;
          lanes(&tile.weight[at]) += weight;
          if (!trace) continue;
          for (int k = 0; k < static_cast<int>(kLanes); ++k)
            if (counts[k] != 0 && distance[k] < tile.least[at + k]) {
              tile.least[at + k] = distance[k];
              tile.seenDepth[at + k] = depth[k];
              tile.point[at + k] = block.point[l];
            }
        }
    }
}

DAPPLE_CLONES void normalise(SplatTile& tile, const vec3& background) {
  for (int at = 0; at < kSplatTile * kSplatStride; at += static_cast<int>(kLanes)) {
    const Float8 weight = lanes(&tile.weight[at]);
    const Int8 covered = weight > 0;
    const Float8 perWeight = 1 / weight;
    Float8 &red = lanes(&tile.red[at]), &green = lanes(&tile.green[at]),
           &blue = lanes(&tile.blue[at]);
    red = covered ? red * perWeight : background.r + 0 * weight;
    green = covered ? green * perWeight : background.g + 0 * weight;
    blue = covered ? blue * perWeight : background.b + 0 * weight;
  }
}

DAPPLE_CLONES void packPixels(const SplatTile& tile, int samples, std::uint32_t* pixels) {
  const int side = kSplatTile / samples;
  const float share = 1 / static_cast<float>(samples * samples);
  const Float8 zero{}, most = zero + 255;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; x += static_cast<int>(kLanes)) {
      Float8 red{}, green{}, blue{};
      for (int sy = 0; sy < samples; ++sy)
        for (int sx = 0; sx < samples; ++sx) {
          const int at = (y * samples + sy) * kSplatStride + x * samples + sx;
          for (int l = 0; l < static_cast<int>(kLanes); ++l) {
            const int sample = std::min(at + l * samples, kSplatTile * kSplatStride - 1);
            red[l] += tile.red[sample], green[l] += tile.green[sample];
            blue[l] += tile.blue[sample];
          }
        }
      red *= share, green *= share, blue *= share;
      limitTo(red, zero, most), limitTo(green, zero, most), limitTo(blue, zero, most);
      const Int8 bytes = __builtin_convertvector(red + 0.5f, Int8) |
                         __builtin_convertvector(green + 0.5f, Int8) << 8 |
                         __builtin_convertvector(blue + 0.5f, Int8) << 16 |
                         static_cast<int>(0xff000000u);
      std::memcpy(pixels + y * kSplatTile + x, &bytes, sizeof bytes);
    }
}

}  // namespace dapple
