// From points to ellipses in a tile: Zwicker et al. 2001, Botsch et al. 2005, as in
// splat_renderer.cpp, with the disc's image taken to be an ellipse: its perspective is that of its
// centre.
#include <algorithm>
#include <cmath>

#include "app/render/splat_kernels.h"
#include "app/render/splat_lanes.h"

namespace dapple {
namespace {

constexpr float kDepthOffset = 1;  // radii
constexpr float kSteepest = 4;     // slope up to which a pixel's own depth is allowed for
constexpr float kAmbient = 0.25f;
constexpr float kEdgeOn = 1e-4f;   // least cosine between the disc's plane and the ray
constexpr float kSlack = 0.0625f;  // samples

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

void findBlocks(SplatScene& s, BlockRange range) {
  SplatBlocks& b = s.blocks;
  for (std::size_t k = range.begin; k < range.end; ++k) {
    b.largest[k] = 0, b.spread[k] = -1;
    vec3 low(std::numeric_limits<float>::infinity()), high = -low, normal(0);
    const std::size_t begin = k * kLanes, end = std::min(s.size, begin + kLanes);
    for (std::size_t i = begin; i < end; ++i) {
      if (!(s.radius[i] > 0)) continue;
      const vec3 p(s.x[i], s.y[i], s.z[i]);
      low = glm::min(low, p), high = glm::max(high, p);
      normal += vec3(s.nx[i], s.ny[i], s.nz[i]);
      b.largest[k] = std::max(b.largest[k], s.radius[i]);
    }
    if (!(b.largest[k] > 0)) continue;
    const vec3 middle = 0.5f * (low + high);
    b.x[k] = middle.x, b.y[k] = middle.y, b.z[k] = middle.z;
    b.nx[k] = normal.x, b.ny[k] = normal.y, b.nz[k] = normal.z;
    b.spread[k] = glm::distance(middle, high);
  }
}

DAPPLE_CLONES void findTiles(const SplatBlocks& blocks, const SplatView& view, const TileGrid& grid,
                             BlockRange range, TileRange* out) {
  const float perTile = 1 / static_cast<float>(grid.step);
  const float lastColumn = static_cast<float>(grid.columns - 1);
  const float lastRow = static_cast<float>(grid.rows - 1);
  for (std::size_t i = range.begin; i < range.end; i += kLanes) {
    Seen c;
    rotate(view, lanes(&blocks.x[i]), lanes(&blocks.y[i]), lanes(&blocks.z[i]), c);
    c.x -= view.eye[0], c.y -= view.eye[1], c.depth -= view.eye[2];
    const Float8 spread = lanes(&blocks.spread[i]);
    const Float8 ball = spread + view.enlarge * lanes(&blocks.largest[i]);
    const Float8 front = c.depth - ball;
    const Int8 seen = (spread >= 0) & (c.depth + ball >= view.nearest) & (front <= view.farthest);
    // What is in the ball is at most that far from the eye's ray through its middle, and at least
    // this deep. A ball round the eye is everywhere.
    const Float8 none{}, one = none + 1, column = none + lastColumn, row = none + lastRow;
    const Int8 beyond = front > 0.25f * ball;
    const Float8 perDepth = view.orthographic ? one : one / c.depth;
    const Float8 sx = c.x * perDepth, sy = c.y * perDepth;
    Float8 reach = 1 + sx * sx + sy * sy;
    squareRoot(reach);
    reach = view.orthographic ? view.focal * ball : view.focal * ball * reach / front;
    reach += view.lowPass + kSlack;
    const Float8 px = view.focal * sx - grid.originX, py = view.focal * sy - grid.originY;
    const Float8 farLeft = none - 1, farRight = column + 1, farBottom = row + 1;
    Float8 left = (px - reach) * perTile, right = (px + reach) * perTile;
    Float8 top = (py - reach) * perTile, bottom = (py + reach) * perTile;
    if (!view.orthographic) {
      left = beyond ? left : none, right = beyond ? right : column;
      top = beyond ? top : none, bottom = beyond ? bottom : row;
    }
    limitTo(left, farLeft, farRight), limitTo(right, farLeft, farRight);
    limitTo(top, farLeft, farBottom), limitTo(bottom, farLeft, farBottom);
    const Int8 inside = seen & (right >= 0) & (bottom >= 0) & (left < farRight) & (top < farBottom);
    limitTo(left, none, column), limitTo(right, none, column);
    limitTo(top, none, row), limitTo(bottom, none, row);
    Seen n;
    rotate(view, lanes(&blocks.nx[i]), lanes(&blocks.ny[i]), lanes(&blocks.nz[i]), n);
    const Float8 along = view.orthographic ? n.depth : n.x * sx + n.y * sy + n.depth;
    const Int8 away = (along > 0) & 1;
    const Int8 l = __builtin_convertvector(left, Int8), r = __builtin_convertvector(right, Int8);
    const Int8 t = __builtin_convertvector(top, Int8), b = __builtin_convertvector(bottom, Int8);
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      out[i - range.begin + lane] = {
          inside[lane] != 0 ? static_cast<std::uint16_t>(l[lane]) : kNoTile,
          static_cast<std::uint16_t>(t[lane]), static_cast<std::uint16_t>(r[lane]),
          static_cast<std::uint16_t>(b[lane]), static_cast<std::uint16_t>(away[lane])};
  }
}

namespace {

// Eight discs in the camera's axes: the ray through a centre is (sx, sy, 1). At this distance a
// local unit is `focal` samples.
struct Discs {
  Seen centre, normal;
  Float8 radius, distance, sx, sy, ray;  // ray: its length
  Float8 x, y, scale;                    // the image: centre and radius, samples of the tile
  Int8 drawn;                            // -1: yes
};

// False when none of the block's discs may be seen in the tile.
[[gnu::always_inline]] inline bool readCentres(const SplatScene& scene, const SplatView& view,
                                               const TilePlace& place, std::size_t first,
                                               Discs& d) {
  const Float8 zero{}, one = zero + 1, last = zero + static_cast<float>(kSplatTile);
  Seen& c = d.centre;
  rotate(view, lanes(&scene.x[first]), lanes(&scene.y[first]), lanes(&scene.z[first]), c);
  c.x -= view.eye[0], c.y -= view.eye[1], c.depth -= view.eye[2];
  d.radius = lanes(&scene.radius[first]) * view.enlarge;
  const Int8 lane{0, 1, 2, 3, 4, 5, 6, 7};
  const int left = static_cast<int>(std::min(view.count - first, kLanes));
  d.drawn = (lane < left) & (d.radius > 0) & (c.depth - d.radius <= place.farthest) &
            (c.depth >= view.nearest) & (c.depth <= view.farthest);
  if (!anyLane(d.drawn)) return false;
  d.distance = view.orthographic ? one : c.depth;
  const Float8 perDistance = 1 / d.distance;
  d.sx = view.orthographic ? zero : c.x * perDistance;
  d.sy = view.orthographic ? zero : c.y * perDistance;
  d.ray = 1 + d.sx * d.sx + d.sy * d.sy;
  squareRoot(d.ray);
  d.scale = view.focal * d.radius * perDistance;
  d.x = view.focal * c.x * perDistance - place.x;
  d.y = view.focal * c.y * perDistance - place.y;
  // The disc's image is longer than a ball's in the middle by the length of the ray at most.
  const Float8 reach = d.scale * d.ray + (view.lowPass + 2 * kSlack);
  d.drawn = d.drawn & (d.x + reach >= 0) & (d.x - reach <= last) & (d.y + reach >= 0) &
            (d.y - reach <= last);
  return anyLane(d.drawn);
}

[[gnu::always_inline]] inline void readNormals(const SplatScene& scene, const SplatView& view,
                                               std::size_t first, Discs& d) {
  const Float8 x = lanes(&scene.nx[first]), y = lanes(&scene.ny[first]),
               z = lanes(&scene.nz[first]);
  Seen& n = d.normal;
  rotate(view, x, y, z, n);
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
  // One test tells whether there is anything to draw.
  lanes(out.bottom) = (drawn & (lanes(out.left) <= to)) ? bottom : Int8{} - 1;
}

// How a step of one sample to the right, or down, moves the place that is seen on a disc: by `x` or
// `y` along the ray, and by `sideways` along the screen.
struct DiscSteps {
  Float8 x, y, sideways;
};

// How the swatch lies in the tile, where the view magnifies it.
[[gnu::always_inline]] inline void placeSwatch(const SplatScene& scene, const SplatView& view,
                                               const Discs& d, const DiscSteps& steps,
                                               ProjectedSplats& out) {
  const auto first = static_cast<std::size_t>(out.first);
  const SplatTexels& texels = *scene.texels;
  Seen s, t;
  rotate(view, lanes(&texels.sx[first]), lanes(&texels.sy[first]), lanes(&texels.sz[first]), s);
  rotate(view, lanes(&texels.tx[first]), lanes(&texels.ty[first]), lanes(&texels.tz[first]), t);
  const Float8 rayS = d.sx * s.x + d.sy * s.y + s.depth;
  const Float8 rayT = d.sx * t.x + d.sy * t.y + t.depth;
  const Float8 xx = steps.x * rayS + steps.sideways * s.x;
  const Float8 xy = steps.y * rayS + steps.sideways * s.y;
  // Image rows run down.
  const Float8 yx = -(steps.x * rayT + steps.sideways * t.x);
  const Float8 yy = -(steps.y * rayT + steps.sideways * t.y);
  const Float8 texelX = lanes(&texels.x[first]);
  lanes(out.texelX) = texelX, lanes(out.texelY) = lanes(&texels.y[first]);
  lanes(out.xPerX) = xx, lanes(out.xPerY) = xy, lanes(out.yPerX) = yx, lanes(out.yPerY) = yy;
  const float longest = texels.longestStep * texels.longestStep;
  // NaN compares false.
  Int8 mayShow;
  for (std::size_t l = 0; l < kLanes; ++l) mayShow[l] = scene.colour[first + l] >> 24 != 0 ? -1 : 0;
  lanes(out.textured) = mayShow & (texelX == texelX) & (xx * xx + yx * yx <= longest) &
                        (xy * xy + yy * yy <= longest);
}

struct Light {
  Float8 red, green, blue;
};
[[gnu::always_inline]] inline void lightOf(const SplatView& view, const Discs& d,
                                           const Float8& facing, Light& light) {
  const Float8 zero{};
  if (view.shading == Shading::Off) {
    light.red = light.green = light.blue = zero + 1;
  } else if (view.shading == Shading::Headlight) {
    light.red = light.green = light.blue = kAmbient + (1 - kAmbient) * facing;
  } else {
    const Seen& n = d.normal;
    const Int8 away = n.x * d.sx + n.y * d.sy + n.depth > 0;
    const Float8 up = away ? n.y : -n.y;
    const StudioLight& l = kStudioLight;
    const vec3 towards = glm::normalize(l.towardsKey);
    Float8 key = -towards.x * n.x + towards.z * n.depth;
    key = (away ? key : -key) + towards.y * up;
    key = key < 0 ? zero : key;
    const Float8 sky = 0.5f * (1 + l.below) + 0.5f * (1 - l.below) * up, off = 1 - facing,
                 rim = off * off * off;
    light.red = l.sky.r * sky + l.key.r * key + l.rim.r * rim;
    light.green = l.sky.g * sky + l.key.g * key + l.rim.g * rim;
    light.blue = l.sky.b * sky + l.key.b * key + l.rim.b * rim;
  }
}

[[gnu::always_inline]] inline void readColours(const SplatScene& scene, const Light& light,
                                               ProjectedSplats& out) {
  Int8 colour;
  for (std::size_t l = 0; l < kLanes; ++l)
    colour[l] = static_cast<int>(scene.colour[static_cast<std::size_t>(out.first) + l]);
  const Int8 own = ~lanes(out.textured);
  const Float8 one = Float8{} + 1;
  lanes(out.red) = light.red * (own ? __builtin_convertvector(colour & 255, Float8) : one);
  lanes(out.green) = light.green * (own ? __builtin_convertvector(colour >> 8 & 255, Float8) : one);
  lanes(out.blue) = light.blue * (own ? __builtin_convertvector(colour >> 16 & 255, Float8) : one);
}

// The image of the discs: an ellipse each, and the depth of its plane.
[[gnu::always_inline]] inline void projectDiscs(const SplatScene& scene, const SplatView& view,
                                                const Discs& d, ProjectedSplats& out) {
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
  const Float8 inverse = 1 / (d.scale * d.scale * q * q);
  const Float8 xx = cyy * inverse, xy = -cxy * inverse, yy = cxx * inverse;
  lanes(out.xx) = xx, lanes(out.xy) = xy, lanes(out.yy) = yy;
  const Float8 aboveX = 1 / (view.lowPass * view.lowPass) - xx;
  const Float8 aboveY = 1 / (view.lowPass * view.lowPass) - yy;
  lanes(out.round) = (aboveX >= 0) & (aboveY >= 0) & (aboveX * aboveY >= xy * xy);
  lanes(out.x) = d.x - 0.5f, lanes(out.y) = d.y - 0.5f;
  Float8 width = cxx, height = cyy;
  squareRoot(width), squareRoot(height);
  width *= d.scale, height *= d.scale;
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
  lanes(out.textured) = Int8{};
  const DiscSteps steps{n.x * perSlope, n.y * perSlope, d.distance / view.focal};
  if (scene.texels) placeSwatch(scene, view, d, steps, out);
  Light light;
  lightOf(view, d, facing, light);
  readColours(scene, light, out);
}

}  // namespace

DAPPLE_CLONES std::size_t projectSplats(const SplatScene& scene, const SplatView& view,
                                        const TilePlace& place,
                                        std::span<const std::uint32_t> blocks,
                                        ProjectedSplats* out) {
  std::size_t kept = 0;
  for (const std::uint32_t block : blocks) {
    const std::size_t first = kLanes * block;
    Discs d;
    if (!readCentres(scene, view, place, first, d)) continue;
    readNormals(scene, view, first, d);
    out[kept].first = static_cast<int>(first);
    projectDiscs(scene, view, d, out[kept]);
    ++kept;
  }
  return kept;
}

}  // namespace dapple
