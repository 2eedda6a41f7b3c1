// The inner loops of cpu_splatter.cpp, in SIMD.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "app/render/splats.h"
#include "base/types.h"

namespace dapple {

// Samples a side of a tile. Its rows are longer and there is one more: whole lanes are written.
inline constexpr int kSplatTile = 32, kSplatStride = kSplatTile + 8;
inline constexpr int kSplatSamples = (kSplatTile + 1) * kSplatStride;

// Eight points in a row, as the one place and direction that tiles are found for: they are near
// each other where the points are in Morton order. A column for each number, padded to whole lanes.
struct SplatBlocks {
  std::size_t size = 0;
  std::vector<float> x, y, z, spread;  // a ball round the centres; negative: nothing to draw
  std::vector<float> largest;          // radius of a splat
  std::vector<float> nx, ny, nz;       // mean normal, any length
};

// The swatch inside the splats, by points as SplatScene has them.
struct SplatTexels {
  std::vector<float> x, y;                    // swatch pixels from the first one's centre, or NaN
  std::vector<float> sx, sy, sz, tx, ty, tz;  // the swatch's axes, divided by a pixel's length
  // Each of the swatch's pixels with its right, lower and lower right neighbours, as
  // Raster::pixels.
  std::vector<std::array<std::uint32_t, 4>> swatch;
  int width = 0, height = 0;  // of the swatch
  bool repeats = false;
  float longestStep = 0;  // swatch pixels from sample to sample; further away it is not shown
};

// What is drawn, a column for each number, padded to whole lanes.
struct SplatScene {
  std::size_t size = 0;
  std::vector<float> x, y, z, nx, ny, nz, radius;  // local units; a normal may be zero
  std::vector<std::uint32_t> colour;               // as Raster::pixels
  std::vector<Index> order;                        // which point each is; empty: they are in order
  std::vector<Index> placeOf;                      // of each point in `order`; empty as that is
  SplatBlocks blocks;
  std::shared_ptr<const SplatTexels> texels;  // null: all show their colours
};

// The camera as seen by the loops: x to the right, y down, depth along the view axis. Samples are
// counted from the view axis.
struct SplatView {
  // Rows: right, down, forward; then the eye along each.
  std::array<std::array<float, 3>, 3> rows;
  std::array<float, 3> eye;
  float focal = 1;  // samples; orthographic: samples per local unit
  bool orthographic = false;
  float nearest = 0, farthest = 0;
  float lowPass = 1;  // samples
  Shading shading = Shading::Off;
  float enlarge = 1;      // times the radii
  std::size_t count = 0;  // points that are drawn: the first so many
};

// Eight splats in one tile: distances are in samples from the tile's first sample.
struct alignas(64) ProjectedSplats {
  static constexpr int kCount = 8;
  float x[kCount], y[kCount];                           // of the centre
  float xx[kCount], xy[kCount], yy[kCount];             // squared distance, 1 at the rim
  float depth[kCount], slopeX[kCount], slopeY[kCount];  // of the disc's plane
  float reach[kCount];                                  // most by which that may leave the centre's
  float offset[kCount];                                 // by which visibility lies deeper
  float red[kCount], green[kCount], blue[kCount];       // 0..255, lit; with the swatch: the light
  int round[kCount];                                    // -1: nowhere narrower than the low-pass
  int left[kCount], right[kCount], top[kCount], bottom[kCount];  // samples of the tile; may be none
  int first;                                                     // of the points
  // Of a splat that shows the swatch: its texel, and by how much that moves from sample to sample.
  float texelX[kCount], texelY[kCount], xPerX[kCount], xPerY[kCount], yPerX[kCount], yPerY[kCount];
  int textured[kCount];  // 0: it shows its colour
};

struct SplatTile {
  alignas(64) float depth[kSplatSamples];       // of the nearest surface, moved back
  alignas(64) float colour[4 * kSplatSamples];  // red, green, blue and weight of each sample
  // Of the splat that counts most, with trace only.
  alignas(64) float least[kSplatSamples], seenDepth[kSplatSamples];
  alignas(64) float point[kSplatSamples];  // the bits of an Index
};

// The tiles that the splats of a block may touch: first and last column and row; kNoTile: none.
// `away`: its normal looks away from the eye, so that it is likely hidden.
inline constexpr std::uint16_t kNoTile = 65535;
struct TileRange {
  std::uint16_t left, top, right, bottom, away;
};
struct TileGrid {
  int columns, rows;
  int step;                // samples from tile to tile, at most kSplatTile
  float originX, originY;  // samples from the view axis to the first tile's corner
};
struct BlockRange {
  std::size_t begin, end;  // begin: a multiple of 8
};

// Balls and mean normals of some of the blocks of a scene, whose columns have room for them.
void findBlocks(SplatScene& scene, BlockRange range);

// `out` has room for whole lanes.
void findTiles(const SplatBlocks& blocks, const SplatView& view, const TileGrid& grid,
               BlockRange range, TileRange* out);

// Where a tile lies and how deep it has to be looked into.
struct TilePlace {
  float x, y;      // of its corner, samples from the view axis
  float farthest;  // what lies behind is hidden
};
// The farthest place of the tile that can be seen: infinite unless all samples are covered.
float farthestSeen(const SplatTile& tile, int side);

// Projects blocks of points into a tile; returns how many of `out` were filled (room for all).
// Those that are out of sight are dropped or have no samples.
std::size_t projectSplats(const SplatScene& scene, const SplatView& view, const TilePlace& place,
                          std::span<const std::uint32_t> blocks, ProjectedSplats* out);

// The nearest surface, moved back so that all splats of one surface pass.
void drawDepths(std::span<const ProjectedSplats> splats, float lowPass, SplatTile& tile);

// Adds up what lies in front of that. `trace`: also which splat counts most.
void drawColours(const SplatScene& scene, std::span<const ProjectedSplats> splats, float lowPass,
                 bool trace, SplatTile& tile);

// Divides what was added up by its weights, over the background (0..255); pixels are the mean of
// samples x samples, as Raster::pixels, kSplatTile a row. Changes the tile's colours.
void packPixels(SplatTile& tile, const vec3& background, int samples, std::uint32_t* pixels);

}  // namespace dapple
