// From ellipses to pixels. The kernel is a polynomial close to the Gaussian of shaders/splat.frag.
#include <algorithm>

#include "app/render/splat_kernels.h"
#include "app/render/splat_lanes.h"

namespace dapple {
namespace {

constexpr float kLeast = 1e-3f;  // so that a disc alone is seen to its rim
// exp(-2.5 d) - exp(-2.5) within 0.0013 for d in 0..1.
constexpr float kKernel[] = {0.91664182f, -1.54443346f, 1.29660787f, -0.47839974f};

// A coordinate in the swatch: the pixel before it and how far it lies beyond.
struct SwatchStep {
  Int8 first;
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
  out.first = whole - turns * size;
  out.first += (out.first < 0) & size;
  out.first -= (out.first >= size) & size;
}

// The four pixels round eight places: upper left and right, lower left and right.
struct SwatchCorners {
  Int8 of[4];
};
[[gnu::always_inline]] inline void readCorners(const SplatTexels& texels, const Int8& places,
                                               SwatchCorners& out) {
  Int4 quads[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l)
    quads[l] =
        *reinterpret_cast<const Int4*>(texels.swatch[static_cast<std::size_t>(places[l])].data());
  Int8 rows[4];  // quads l and l + 4
  for (std::size_t l = 0; l < 4; ++l)
    rows[l] = __builtin_shufflevector(quads[l], quads[l + 4], 0, 1, 2, 3, 4, 5, 6, 7);
  Int8 low[2], high[2];
  for (std::size_t l = 0; l < 2; ++l) {
    low[l] = __builtin_shufflevector(rows[2 * l], rows[2 * l + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    high[l] = __builtin_shufflevector(rows[2 * l], rows[2 * l + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  out.of[0] = __builtin_shufflevector(low[0], low[1], 0, 1, 8, 9, 4, 5, 12, 13);
  out.of[1] = __builtin_shufflevector(low[0], low[1], 2, 3, 10, 11, 6, 7, 14, 15);
  out.of[2] = __builtin_shufflevector(high[0], high[1], 0, 1, 8, 9, 4, 5, 12, 13);
  out.of[3] = __builtin_shufflevector(high[0], high[1], 2, 3, 10, 11, 6, 7, 14, 15);
}

// Colours of the swatch at eight samples, 0..255.
struct SwatchColours {
  Float8 red, green, blue;
};
[[gnu::always_inline]] inline void readSwatch(const SplatTexels& texels, const Float8& x,
                                              const Float8& y, SwatchColours& out) {
  SwatchStep column, row;
  stepInSwatch(x, texels.width, texels.repeats, column);
  stepInSwatch(y, texels.height, texels.repeats, row);
  SwatchCorners corners;
  readCorners(texels, row.first * texels.width + column.first, corners);
  const Float8 shares[] = {(1 - row.beyond) * (1 - column.beyond), (1 - row.beyond) * column.beyond,
                           row.beyond * (1 - column.beyond), row.beyond * column.beyond};
  out.red = out.green = out.blue = Float8{};
  for (int k = 0; k < 4; ++k) {
    const Int8 colour = corners.of[k];
    out.red += shares[k] * __builtin_convertvector(colour & 255, Float8);
    out.green += shares[k] * __builtin_convertvector(colour >> 8 & 255, Float8);
    out.blue += shares[k] * __builtin_convertvector(colour >> 16 & 255, Float8);
  }
}

// A splat as its samples see it.
struct Splat {
  float x, y, xx, xy, yy, depth, slopeX, slopeY, reach, perLowPass2;
  bool round;
  int left, right, top, bottom;
};
[[gnu::always_inline]] inline Splat splatOf(const ProjectedSplats& s, int l, float perLowPass2) {
  return {s.x[l],          s.y[l],      s.xx[l],     s.xy[l],    s.yy[l],
          s.depth[l],      s.slopeX[l], s.slopeY[l], s.reach[l], perLowPass2,
          s.round[l] != 0, s.left[l],   s.right[l],  s.top[l],   s.bottom[l]};
}

// Eight samples are drawn at once: so many columns of as many rows as that makes.
template <int kColumns>
struct Shape;
template <>
struct Shape<8> {
  static constexpr Float8 kX{0, 1, 2, 3, 4, 5, 6, 7}, kY{};
  [[gnu::always_inline]] static void load(const float* from, Float8& out) { out = lanes(from); }
  [[gnu::always_inline]] static void store(const Float8& v, float* to) { lanes(to) = v; }
};
template <>
struct Shape<4> {
  static constexpr Float8 kX{0, 1, 2, 3, 0, 1, 2, 3}, kY{0, 0, 0, 0, 1, 1, 1, 1};
  [[gnu::always_inline]] static void load(const float* from, Float8& out) {
    out = __builtin_shufflevector(fourLanes(from), fourLanes(from + kSplatStride), 0, 1, 2, 3, 4, 5,
                                  6, 7);
  }
  [[gnu::always_inline]] static void store(const Float8& v, float* to) {
    fourLanes(to) = __builtin_shufflevector(v, v, 0, 1, 2, 3);
    fourLanes(to + kSplatStride) = __builtin_shufflevector(v, v, 4, 5, 6, 7);
  }
};

// The squared distance of eight samples from a splat's centre (1 at its rim, on the screen or on
// the disc, whatever is less) and the depth of its plane there.
struct Reached {
  Float8 distance, depth;
};
template <bool kRound>
[[gnu::always_inline]] inline void reachSamples(const Splat& s, const Float8& dx, const Float8& dy,
                                                Reached& out) {
  out.distance = (s.xx * dx + 2 * s.xy * dy) * dx + s.yy * dy * dy;
  Float8 apart = s.slopeX * dx + s.slopeY * dy;
  if constexpr (!kRound) {
    const Float8 screen = (dx * dx + dy * dy) * s.perLowPass2;
    out.distance = out.distance < screen ? out.distance : screen;
    // Beyond the disc its plane says nothing (shaders/splat.frag).
    const Float8 most = Float8{} + s.reach;
    limitTo(apart, -most, most);
  }
  out.depth = s.depth + apart;
}

// Eight samples of a splat.
struct Samples {
  Float8 dx, dy;      // from its centre
  int at;             // the first one's place in the tile
  int columns, rows;  // that the splat may touch, from the first one
};

// Gives draw(samples) all that the splat may touch.
template <int kColumns, class Draw>
[[gnu::always_inline]] inline void forSamples(const Splat& s, const Draw& draw) {
  for (int y = s.top; y <= s.bottom; y += 8 / kColumns)
    for (int x = s.left; x <= s.right; x += kColumns)
      draw(Samples{Shape<kColumns>::kX + (static_cast<float>(x) - s.x),
                   Shape<kColumns>::kY + (static_cast<float>(y) - s.y), y * kSplatStride + x,
                   s.right - x + 1, s.bottom - y + 1});
}

template <int kColumns, bool kRound>
[[gnu::always_inline]] inline void drawDepth(const Splat& s, float offset, SplatTile& tile) {
  forSamples<kColumns>(
      s, [&](const Samples& samples) __attribute__((always_inline)) {
        Reached r;
        reachSamples<kRound>(s, samples.dx, samples.dy, r);
        r.depth += offset;
        float* at = &tile.depth[samples.at];
        Float8 nearest;
        Shape<kColumns>::load(at, nearest);
        nearest = ((r.distance <= 1) & (r.depth < nearest)) ? r.depth : nearest;
        Shape<kColumns>::store(nearest, at);
      });
}

// The place, in samples, of the k-th four of eight samples.
template <int kColumns>
constexpr int fourAt(int k) {
  return 4 * k % kColumns + 4 * k / kColumns * kSplatStride;
}
template <int kColumns>
[[gnu::always_inline]] inline bool touchesFour(const Samples& samples, int k) {
  return 4 * k % kColumns < samples.columns && 4 * k / kColumns < samples.rows;
}

// Adds a colour (red, green, blue, 1, four times) to the k-th four.
template <int kColumns, int k>
[[gnu::always_inline]] inline void addColour(const Float8& weight, const Float16& colour,
                                             const Samples& samples, SplatTile& tile) {
  if (!touchesFour<kColumns>(samples, k)) return;
  constexpr int a = 4 * k, b = a + 1, c = a + 2, d = a + 3;
  sixteenLanes(&tile.colour[4 * (samples.at + fourAt<kColumns>(k))]) +=
      __builtin_shufflevector(weight, weight, a, a, a, a, b, b, b, b, c, c, c, c, d, d, d, d) *
      colour;
}

template <int kColumns, int k>
[[gnu::always_inline]] inline void addTexels(const Float8& weight, const SwatchColours& colours,
                                             const Samples& samples, SplatTile& tile) {
  constexpr int a = 4 * k, b = a + 1, c = a + 2, d = a + 3;
  const Float8 one = Float8{} + 1;
  const Float8 redGreen =
      __builtin_shufflevector(colours.red, colours.green, a, a + 8, b, b + 8, c, c + 8, d, d + 8);
  const Float8 blueOne =
      __builtin_shufflevector(colours.blue, one, a, a + 8, b, b + 8, c, c + 8, d, d + 8);
  addColour<kColumns, k>(weight,
                         __builtin_shufflevector(redGreen, blueOne, 0, 1, 8, 9, 2, 3, 10, 11, 4, 5,
                                                 12, 13, 6, 7, 14, 15),
                         samples, tile);
}

[[gnu::always_inline]] inline void weigh(const Float8& distance, const Int8& counts, Float8& out) {
  const Float8 zero{}, least = zero + kLeast;
  out = (1 - distance) *
        (((kKernel[3] * distance + kKernel[2]) * distance + kKernel[1]) * distance + kKernel[0]);
  out = out < least ? least : out;
  out = counts ? out : zero;
}

// Of the splat that is nearest, in its own measure: where it lies and which it is.
template <int kColumns>
[[gnu::always_inline]] inline void traceSamples(const Reached& r, const Int8& counts, Index point,
                                                int at, SplatTile& tile) {
  Float8 least, depth, id;
  Shape<kColumns>::load(&tile.least[at], least);
  Shape<kColumns>::load(&tile.seenDepth[at], depth);
  Shape<kColumns>::load(&tile.point[at], id);
  const Int8 nearer = counts & (r.distance < least);
  least = nearer ? r.distance : least;
  depth = nearer ? r.depth : depth;
  const Int8 own = Int8{} + static_cast<int>(point);
  id = nearer ? reinterpret_cast<const Float8&>(own) : id;
  Shape<kColumns>::store(least, &tile.least[at]);
  Shape<kColumns>::store(depth, &tile.seenDepth[at]);
  Shape<kColumns>::store(id, &tile.point[at]);
}

// What a splat is drawn with.
struct Paint {
  float red, green, blue;  // with the swatch: the light
  bool textured;
  float texelX, texelY, xPerX, xPerY, yPerX, yPerY;
  Index point;
};
[[gnu::always_inline]] inline void paintOf(const ProjectedSplats& b, int l, Paint& out) {
  out.red = b.red[l], out.green = b.green[l], out.blue = b.blue[l];
  out.textured = b.textured[l] != 0;
  out.texelX = b.texelX[l], out.texelY = b.texelY[l];
  out.xPerX = b.xPerX[l], out.xPerY = b.xPerY[l];
  out.yPerX = b.yPerX[l], out.yPerY = b.yPerY[l];
  out.point = static_cast<Index>(b.first + l);
}

template <int kColumns>
[[gnu::always_inline]] inline void addSwatch(const SplatScene& scene, const Paint& p,
                                             const Float8& weight, const Samples& samples,
                                             SplatTile& tile) {
  SwatchColours c;
  readSwatch(*scene.texels, p.texelX + p.xPerX * samples.dx + p.xPerY * samples.dy,
             p.texelY + p.yPerX * samples.dx + p.yPerY * samples.dy, c);
  c.red *= p.red, c.green *= p.green, c.blue *= p.blue;
  addTexels<kColumns, 0>(weight, c, samples, tile);
  addTexels<kColumns, 1>(weight, c, samples, tile);
}

template <int kColumns, bool kRound, bool kTextured>
[[gnu::always_inline]] inline void drawColour(const SplatScene& scene, const Splat& s,
                                              const Paint& p, bool trace, SplatTile& tile) {
  const Float16 colour{p.red, p.green, p.blue, 1, p.red, p.green, p.blue, 1,
                       p.red, p.green, p.blue, 1, p.red, p.green, p.blue, 1};
  forSamples<kColumns>(
      s, [&](const Samples& samples) __attribute__((always_inline)) {
        Reached r;
        reachSamples<kRound>(s, samples.dx, samples.dy, r);
        Float8 nearest, weight;
        Shape<kColumns>::load(&tile.depth[samples.at], nearest);
        const Int8 counts = (r.distance <= 1) & (r.depth <= nearest);
        if (!anyLane(counts)) return;
        weigh(r.distance, counts, weight);
        if constexpr (kTextured) {
          addSwatch<kColumns>(scene, p, weight, samples, tile);
        } else {
          addColour<kColumns, 0>(weight, colour, samples, tile);
          addColour<kColumns, 1>(weight, colour, samples, tile);
        }
        if (trace) traceSamples<kColumns>(r, counts, p.point, samples.at, tile);
      });
}

template <bool kRound, bool kTextured>
[[gnu::always_inline]] inline void drawColour(const SplatScene& scene, const Splat& s,
                                              const Paint& p, bool trace, SplatTile& tile) {
  const int columns = s.right - s.left + 1;
  if (columns <= 4)
    drawColour<4, kRound, kTextured>(scene, s, p, trace, tile);
  else
    drawColour<8, kRound, kTextured>(scene, s, p, trace, tile);
}

}  // namespace

DAPPLE_CLONES float farthestSeen(const SplatTile& tile, int side) {
  const Int8 lane{0, 1, 2, 3, 4, 5, 6, 7};
  Float8 farthest{};
  for (int x = 0; x < side; x += static_cast<int>(kLanes))
    for (int y = 0; y < side; ++y) {
      const Float8 depth = lanes(&tile.depth[y * kSplatStride + x]);
      farthest = ((depth > farthest) & (lane < side - x)) ? depth : farthest;
    }
  float most = 0;
  for (std::size_t l = 0; l < kLanes; ++l) most = std::max(most, farthest[l]);
  return most;
}

DAPPLE_CLONES void drawDepths(std::span<const ProjectedSplats> splats, float lowPass,
                              SplatTile& tile) {
  const float perLowPass2 = 1 / (lowPass * lowPass);
  for (const ProjectedSplats& block : splats)
    for (int l = 0; l < ProjectedSplats::kCount; ++l) {
      if (block.top[l] > block.bottom[l]) continue;
      const Splat s = splatOf(block, l, perLowPass2);
      const float offset = block.offset[l];
      const int columns = s.right - s.left + 1;
      if (columns <= 4)
        drawDepth<4, false>(s, offset, tile);
      else if (s.round)
        drawDepth<8, true>(s, offset, tile);
      else
        drawDepth<8, false>(s, offset, tile);
    }
}

DAPPLE_CLONES void drawColours(const SplatScene& scene, std::span<const ProjectedSplats> splats,
                               float lowPass, bool trace, SplatTile& tile) {
  const float perLowPass2 = 1 / (lowPass * lowPass);
  for (const ProjectedSplats& block : splats)
    for (int l = 0; l < ProjectedSplats::kCount; ++l) {
      if (block.top[l] > block.bottom[l]) continue;
      const Splat s = splatOf(block, l, perLowPass2);
      Paint paint;
      paintOf(block, l, paint);
      if (paint.textured)
        drawColour<false, true>(scene, s, paint, trace, tile);
      else if (s.round)
        drawColour<true, false>(scene, s, paint, trace, tile);
      else
        drawColour<false, false>(scene, s, paint, trace, tile);
    }
}

namespace {

// Two samples in a row: their means, and 255, or what is behind them.
[[gnu::always_inline]] inline void meansOfTwo(const float* colour, const Float8& behind,
                                              Float8& out) {
  const Int8 alpha{0, 0, 0, -1, 0, 0, 0, -1};
  const Float8 sum = lanes(colour), opaque = Float8{} + 255;
  const Float8 weight = __builtin_shufflevector(sum, sum, 3, 3, 3, 3, 7, 7, 7, 7);
  const Float8 mean = alpha ? opaque : sum / weight;
  out = weight > 0 ? mean : behind;
}

[[gnu::always_inline]] inline void packTwo(const Float8& colour, std::uint32_t* pixels) {
  const Float8 zero{}, most = zero + 255;
  Float8 bounded = colour;
  limitTo(bounded, zero, most);
  Int8 bytes = __builtin_convertvector(bounded + 0.5f, Int8) << Int8{0, 8, 16, 24, 0, 8, 16, 24};
  bytes |= __builtin_shufflevector(bytes, bytes, 1, 0, 3, 2, 5, 4, 7, 6);
  bytes |= __builtin_shufflevector(bytes, bytes, 2, 3, 0, 1, 6, 7, 4, 5);
  pixels[0] = static_cast<std::uint32_t>(bytes[0]);
  pixels[1] = static_cast<std::uint32_t>(bytes[4]);
}

}  // namespace

DAPPLE_CLONES void packPixels(SplatTile& tile, const vec3& background, int samples,
                              std::uint32_t* pixels) {
  const Float8 behind{background.r, background.g, background.b, 255,
                      background.r, background.g, background.b, 255};
  const int side = kSplatTile / samples, used = side * samples;
  if (samples == 1) {
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; x += 2) {
        Float8 means;
        meansOfTwo(&tile.colour[4 * (y * kSplatStride + x)], behind, means);
        packTwo(means, pixels + y * kSplatTile + x);
      }
    return;
  }
  for (int y = 0; y < used; ++y)
    for (int x = 0; x < used; x += 2) {
      float* at = &tile.colour[4 * (y * kSplatStride + x)];
      meansOfTwo(at, behind, lanes(at));
    }
  const float share = 1 / static_cast<float>(samples * samples);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; x += 2) {
      Float8 sum{};
      for (int sy = 0; sy < samples; ++sy)
        for (int sx = 0; sx < samples; ++sx) {
          const float* at =
              &tile.colour[4 * ((y * samples + sy) * kSplatStride + x * samples + sx)];
          sum += __builtin_shufflevector(fourLanes(at), fourLanes(at + 4 * samples), 0, 1, 2, 3, 4,
                                         5, 6, 7);
        }
      packTwo(sum * share, pixels + y * kSplatTile + x);
    }
}

}  // namespace dapple
