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
    const Float8 perDepth = view.orthographic ? Float8{} + 1 : 1 / c.depth;
    // The disc lies in a ball; its image is longer by the length of the ray at most, and by what
    // is nearer to the eye than its centre.
    const Float8 sx = c.x * perDepth, sy = c.y * perDepth;
    Float8 reach = view.orthographic ? Float8{} + 1 : 1 + sx * sx + sy * sy;
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
    const Float8 along = view.orthographic ? n.depth : n.x * sx + n.y * sy + n.depth;
    const Int8 away = (along > 0) & 1;
    const Int8 l = __builtin_convertvector(left, Int8), r = __builtin_convertvector(right, Int8);
    const Int8 t = __builtin_convertvector(top, Int8), b = __builtin_convertvector(bottom, Int8);
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      out[i - range.begin + lane] = {
          inside[lane] != 0 ? static_cast<std::uint8_t>(l[lane]) : kNoTile,
          static_cast<std::uint8_t>(t[lane]), static_cast<std::uint8_t>(r[lane]),
          static_cast<std::uint8_t>(b[lane]), static_cast<std::uint8_t>(away[lane])};
  }
}

namespace {

// How a step of one sample to the right, or down, moves the place that is seen on a disc: by `x` or
// `y` along the ray, and by `sideways` along the screen.
struct DiscSteps {
  Float8 x, y, sideways;
};

// How the swatch lies in the tile, where the view magnifies it.
[[gnu::always_inline]] inline void placeSwatch(const SplatScene& scene, const SplatView& view,
                                               const Seen& ray, const DiscSteps& steps,
                                               ProjectedSplats& out) {
  Float8 sx, sy, sz, tx, ty, tz, texelX, texelY;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const Index i = out.point[l];
    sx[l] = scene.sx[i], sy[l] = scene.sy[i], sz[l] = scene.sz[i];
    tx[l] = scene.tx[i], ty[l] = scene.ty[i], tz[l] = scene.tz[i];
    texelX[l] = scene.texelX[i], texelY[l] = scene.texelY[i];
  }
  Seen s, t;
  rotate(view, sx, sy, sz, s);
  rotate(view, tx, ty, tz, t);
  const Float8 rayS = ray.x * s.x + ray.y * s.y + ray.depth * s.depth;
  const Float8 rayT = ray.x * t.x + ray.y * t.y + ray.depth * t.depth;
  const Float8 xx = steps.x * rayS + steps.sideways * s.x;
  const Float8 xy = steps.y * rayS + steps.sideways * s.y;
  // Image rows run down.
  const Float8 yx = -(steps.x * rayT + steps.sideways * t.x);
  const Float8 yy = -(steps.y * rayT + steps.sideways * t.y);
  lanes(out.texelX) = texelX, lanes(out.texelY) = texelY;
  lanes(out.xPerX) = xx, lanes(out.xPerY) = xy, lanes(out.yPerX) = yx, lanes(out.yPerY) = yy;
  const float longest = scene.longestStep * scene.longestStep;
  // NaN compares false.
  lanes(out.textured) =
      (texelX == texelX) & (xx * xx + yx * yx <= longest) & (xy * xy + yy * yy <= longest);
}

// A coordinate before which pixel, how far beyond it, and the pixel after it.
struct SwatchStep {
  Int8 first, second;
  Float8 beyond;
};
[[gnu::always_inline]] inline void stepInSwatch(const Float8& at, int size, bool repeats,
                                                SwatchStep& out) {
  const Float8 zero{}, last = zero + static_cast<float>(size - 1);
  Float8 value = at;
  if (!repeats) limitTo(value, zero, last);
  Int8 whole = __builtin_convertvector(value, Int8);
  whole += __builtin_convertvector(whole, Float8) > value;
  const Float8 before = __builtin_convertvector(whole, Float8);
  out.beyond = value - before;
  const Int8 turns = __builtin_convertvector(before * (1 / static_cast<float>(size)), Int8);
  Int8 first = whole - turns * size;
  first += (first < 0) & size;
  first -= (first >= size) & size;
  Int8 second = first + 1;
  second = second >= size ? (repeats ? Int8{} : first) : second;
  out.first = first, out.second = second;
}

// Colours of the swatch at eight samples, 0..255.
struct SwatchColours {
  Float8 red, green, blue;
};
[[gnu::always_inline]] inline void readSwatch(const SplatScene& scene, const Float8& x,
                                              const Float8& y, SwatchColours& out) {
  SwatchStep column, row;
  stepInSwatch(x, scene.swatchWidth, scene.swatchRepeats, column);
  stepInSwatch(y, scene.swatchHeight, scene.swatchRepeats, row);
  const Int8 above = row.first * scene.swatchWidth, below = row.second * scene.swatchWidth;
  const Int8 places[] = {above + column.first, above + column.second, below + column.first,
                         below + column.second};
  const Float8 shares[] = {(1 - row.beyond) * (1 - column.beyond), (1 - row.beyond) * column.beyond,
                           row.beyond * (1 - column.beyond), row.beyond * column.beyond};
  out.red = out.green = out.blue = Float8{};
  for (int corner = 0; corner < 4; ++corner) {
    Int8 colour;
    for (std::size_t l = 0; l < kLanes; ++l)
      colour[l] = static_cast<int>(scene.swatch[static_cast<std::size_t>(places[corner][l])]);
    out.red += shares[corner] * __builtin_convertvector(colour & 255, Float8);
    out.green += shares[corner] * __builtin_convertvector(colour >> 8 & 255, Float8);
    out.blue += shares[corner] * __builtin_convertvector(colour >> 16 & 255, Float8);
  }
}

}  // namespace

float farthestSeen(const SplatTile& tile, int side) {
  float farthest = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) farthest = std::max(farthest, tile.depth[y * kSplatStride + x]);
  return farthest;
}

namespace {

// Eight discs in the camera's axes: the ray through a centre is (sx, sy, 1). At this distance a
// local unit is `focal` samples.
struct Discs {
  Seen centre, normal;
  Float8 radius, distance, sx, sy, ray;  // ray: its length
  Int8 drawn;                            // -1: yes
};

[[gnu::always_inline]] inline void readNormals(const SplatScene& scene, const SplatView& view,
                                               const Index* points, Discs& d) {
  Float8 x, y, z;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const Index i = points[l];
    x[l] = scene.nx[i], y[l] = scene.ny[i], z[l] = scene.nz[i];
  }
  Seen& n = d.normal;
  rotate(view, x, y, z, n);
  const Float8 zero{};
  d.distance = view.orthographic ? zero + 1 : d.centre.depth;
  d.sx = view.orthographic ? zero : d.centre.x / d.distance;
  d.sy = view.orthographic ? zero : d.centre.y / d.distance;
  d.ray = 1 + d.sx * d.sx + d.sy * d.sy;
  squareRoot(d.ray);
  // A point without a normal faces the eye.
  const Int8 any = x * x + y * y + z * z > 0.25f;
  n.x = any ? n.x : -d.sx / d.ray;
  n.y = any ? n.y : -d.sy / d.ray;
  n.depth = any ? n.depth : -1 / d.ray;
}

// The samples of the tile that an image of this half size round (x, y) may touch; sample i lies at
// i + 0.5.
[[gnu::always_inline]] inline void clipToTile(const Float8& halfWidth, const Float8& halfHeight,
                                              const Int8& drawn, ProjectedSplats& out) {
  const Float8 zero{}, outside = zero + static_cast<float>(kSplatTile), before = zero - 1;
  const Float8 x = lanes(out.x), y = lanes(out.y);
  Float8 left = x - halfWidth, right = x + halfWidth, top = y - halfHeight, low = y + halfHeight;
  limitTo(left, before, outside), limitTo(right, before, outside);
  limitTo(top, before, outside), limitTo(low, before, outside);
  const Int8 last = Int8{} + (kSplatTile - 1);
  Int8 to = __builtin_convertvector(right + 1, Int8) - 1;
  Int8 bottom = __builtin_convertvector(low + 1, Int8) - 1;
  to = to > last ? last : to;
  bottom = bottom > last ? last : bottom;
  lanes(out.left) = __builtin_convertvector(left + 1, Int8), lanes(out.right) = to;
  lanes(out.top) = __builtin_convertvector(top + 1, Int8);
  lanes(out.bottom) = drawn ? bottom : Int8{} - 1;
}

// The image of the discs: an ellipse each, and the depth of its plane.
[[gnu::always_inline]] inline void projectDiscs(const SplatScene& scene, const SplatView& view,
                                                const TilePlace& place, const Discs& d,
                                                ProjectedSplats& out) {
  const Float8 zero{}, one = zero + 1;
  const Seen &c = d.centre, &n = d.normal;
  Float8 q = n.x * d.sx + n.y * d.sy + n.depth;
  const Float8 steep = q < 0 ? -q : q;
  q = steep < kEdgeOn ? (q < 0 ? zero - kEdgeOn : zero + kEdgeOn) : q;
  // Covariance of the image over the radius squared: J (I - n n^T) J^T; its determinant is q^2.
  const Float8 ex = n.x - d.sx * n.depth, ey = n.y - d.sy * n.depth;
  Float8 cxx = 1 + d.sx * d.sx - ex * ex, cyy = 1 + d.sy * d.sy - ey * ey;
  const Float8 cxy = d.sx * d.sy - ex * ey;
  cxx = cxx < 0 ? zero : cxx, cyy = cyy < 0 ? zero : cyy;
  const Float8 scale = view.focal * d.radius / d.distance;
  const Float8 inverse = 1 / (scale * scale * q * q);
  lanes(out.xx) = cyy * inverse, lanes(out.xy) = -cxy * inverse, lanes(out.yy) = cxx * inverse;
  lanes(out.x) = view.focal * c.x / d.distance - place.x - 0.5f;
  lanes(out.y) = view.focal * c.y / d.distance - place.y - 0.5f;
  Float8 width = cxx, height = cyy;
  squareRoot(width), squareRoot(height);
  width *= scale, height *= scale;
  width = (width < view.lowPass ? zero + view.lowPass : width) + kSlack;
  height = (height < view.lowPass ? zero + view.lowPass : height) + kSlack;
  clipToTile(width, height, d.drawn, out);

  const Float8 facing = steep / d.ray;
  Float8 tilt = one - facing * facing, reach = one - n.depth * n.depth;
  tilt = tilt < 0 ? zero : tilt, reach = reach < 0 ? zero : reach;
  squareRoot(tilt), squareRoot(reach);
  Float8 slope = tilt / (facing < 1e-3f ? zero + 1e-3f : facing);
  slope = slope > kSteepest ? zero + kSteepest : slope;
  lanes(out.offset) = kDepthOffset * d.radius + view.lowPass / view.focal * d.distance * slope;
  lanes(out.reach) = d.radius * reach;
  lanes(out.depth) = c.depth;
  // The plane's depth along a ray is (n.c) / (n.ray).
  const Float8 perSlope = -d.distance / (view.focal * q);
  lanes(out.slopeX) = n.x * perSlope, lanes(out.slopeY) = n.y * perSlope;
  lanes(out.light) = view.headlight ? kAmbient + (1 - kAmbient) * facing : one;
  lanes(out.textured) = Int8{};
  if (scene.swatch.empty()) return;
  const DiscSteps steps{n.x * perSlope, n.y * perSlope, d.distance / view.focal};
  placeSwatch(scene, view, {d.sx, d.sy, one}, steps, out);
}

}  // namespace

DAPPLE_CLONES std::size_t projectSplats(const SplatScene& scene, const SplatView& view,
                                        const TilePlace& place, std::span<const Index> points,
                                        ProjectedSplats* out) {
  const Int8 lane{0, 1, 2, 3, 4, 5, 6, 7};
  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < points.size(); begin += kLanes) {
    const std::size_t count = std::min(kLanes, points.size() - begin);
    ProjectedSplats& s = out[kept];
    Discs d;
    Float8 x, y, z;
    for (std::size_t l = 0; l < kLanes; ++l) {
      const Index i = points[begin + std::min(l, count - 1)];
      s.point[l] = i;
      x[l] = scene.x[i], y[l] = scene.y[i], z[l] = scene.z[i];
      d.radius[l] = scene.radius[i];
    }
    rotate(view, x, y, z, d.centre);
    d.centre.x -= view.eye[0], d.centre.y -= view.eye[1], d.centre.depth -= view.eye[2];
    d.drawn = (d.centre.depth - d.radius <= place.farthest) & (lane < static_cast<int>(count));
    if (!anyLane(d.drawn)) continue;
    readNormals(scene, view, s.point, d);
    projectDiscs(scene, view, place, d, s);
    Int8 colour;
    for (std::size_t l = 0; l < kLanes; ++l) colour[l] = static_cast<int>(scene.colour[s.point[l]]);
    const Float8 light = lanes(s.light);
    lanes(s.red) = light * __builtin_convertvector(colour & 255, Float8);
    lanes(s.green) = light * __builtin_convertvector(colour >> 8 & 255, Float8);
    lanes(s.blue) = light * __builtin_convertvector(colour >> 16 & 255, Float8);
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

DAPPLE_CLONES void drawColours(const SplatScene& scene, std::span<const ProjectedSplats> splats,
                               float lowPass, bool trace, SplatTile& tile) {
  const float perLowPass2 = 1 / (lowPass * lowPass);
  const Float8 zero{}, least = zero + kLeast;
  for (const ProjectedSplats& block : splats)
    for (int l = 0; l < ProjectedSplats::kCount; ++l) {
      const Splat s = splatOf(block, l);
      const bool textured = block.textured[l] != 0;
      SwatchColours colour{zero + block.red[l], zero + block.green[l], zero + block.blue[l]};
      for (int y = s.top; y <= s.bottom; ++y)
        for (int x = s.left; x <= s.right; x += static_cast<int>(kLanes)) {
          const int at = y * kSplatStride + x;
          const Float8 dx = kSteps + (static_cast<float>(x) - s.x);
          const float dy = static_cast<float>(y) - s.y;
          Reached r;
          reachSamples(s, perLowPass2, dx, dy, r);
          const Float8 &distance = r.distance, &depth = r.depth;
          const Int8 counts = (distance <= 1) & (depth <= lanes(&tile.depth[at]));
          if (!anyLane(counts)) continue;
          Float8 weight =
              (1 - distance) *
              (((kKernel[3] * distance + kKernel[2]) * distance + kKernel[1]) * distance +
               kKernel[0]);
          weight = weight < least ? least : weight;
          weight = counts ? weight : zero;
          if (textured) {
            readSwatch(scene, block.texelX[l] + block.xPerX[l] * dx + block.xPerY[l] * dy,
                       block.texelY[l] + block.yPerX[l] * dx + block.yPerY[l] * dy, colour);
            const float light = block.light[l];
            colour.red *= light, colour.green *= light, colour.blue *= light;
          }
          lanes(&tile.red[at]) += weight * colour.red;
          lanes(&tile.green[at]) += weight * colour.green;
          lanes(&tile.blue[at]) += weight * colour.blue;
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
