// Blocks of eight points are binned into the tiles that their splats may touch, chunk after chunk,
// so that each tile has them in their order whatever thread has binned them; then every tile is
// drawn alone.
#include "app/render/cpu_splatter.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "app/render/splat_kernels.h"
#include "base/errors.h"
#include "base/scratch_pool.h"
#include "base/simd.h"

namespace dapple {
namespace {

constexpr std::size_t kChunks = 32;         // at most
constexpr std::size_t kSmallestChunk = 64;  // blocks

SplatView viewOf(const Camera& camera, int samplesHigh, const SplatOptions& options) {
  const glm::mat4 m = viewMatrix(camera);
  SplatView view;
  for (int c = 0; c < 3; ++c) {
    view.rows[0][static_cast<std::size_t>(c)] = m[c][0];
    view.rows[1][static_cast<std::size_t>(c)] = -m[c][1];
    view.rows[2][static_cast<std::size_t>(c)] = -m[c][2];
  }
  view.eye = {-m[3][0], m[3][1], m[3][2]};
  view.orthographic = camera.orthographicHeight > 0;
  view.focal = view.orthographic
                   ? static_cast<float>(samplesHigh) / camera.orthographicHeight
                   : 0.5f * static_cast<float>(samplesHigh) / std::tan(0.5f * camera.verticalFov);
  view.nearest = camera.nearPlane, view.farthest = camera.farPlane;
  view.lowPass = options.lowPass * static_cast<float>(options.samples);
  view.shading = options.shading;
  view.enlarge = options.enlarge;
  return view;
}

// For each tile the blocks that may touch it, in their order, those that face the eye first: bin
// 2 t and bin 2 t + 1.
struct Bins {
  std::vector<TileRange> ranges;    // by block
  std::vector<std::uint32_t> next;  // [chunk][bin]; once filled, where a chunk's share ends
  std::vector<std::uint32_t> blocks;
  std::size_t chunks = 0, bins = 0;

  std::span<const std::uint32_t> of(std::size_t b) const {
    if (chunks == 0) return {};
    const std::uint32_t* ends = next.data() + (chunks - 1) * bins;
    const std::size_t begin = b == 0 ? 0 : ends[b - 1];
    return {blocks.data() + begin, ends[b] - begin};
  }
};

template <class Visit>
void forBins(const TileRange& range, int columns, const Visit& visit) {
  if (range.left == kNoTile) return;
  for (int row = range.top; row <= range.bottom; ++row)
    for (int column = range.left; column <= range.right; ++column)
      visit(2 * static_cast<std::size_t>(row * columns + column) + range.away);
}

// Counts become where each chunk's share of a bin begins. Returns their sum.
std::uint32_t addUp(Bins& bins) {
  std::vector<std::uint32_t> begins(bins.bins, 0);
  for (std::size_t chunk = 0; chunk < bins.chunks; ++chunk)
    for (std::size_t b = 0; b < bins.bins; ++b) begins[b] += bins.next[chunk * bins.bins + b];
  std::uint32_t sum = 0;
  for (std::uint32_t& begin : begins) {
    sum += begin;
    begin = sum - begin;
  }
  for (std::size_t chunk = 0; chunk < bins.chunks; ++chunk)
    for (std::size_t b = 0; b < bins.bins; ++b) {
      std::uint32_t& count = bins.next[chunk * bins.bins + b];
      begins[b] += count;
      count = begins[b] - count;
    }
  return sum;
}

void bin(const SplatBlocks& blocks, const SplatView& view, const TileGrid& grid, Workers& workers,
         Bins& out) {
  const std::size_t count = std::min(blocks.size, paddedToLanes(view.count) / kLanes);
  const std::size_t chunk =
      paddedToLanes(std::max(kSmallestChunk, (count + kChunks - 1) / kChunks));
  out.chunks = (count + chunk - 1) / chunk;
  out.bins = 2 * static_cast<std::size_t>(grid.columns * grid.rows);
  out.ranges.resize(paddedToLanes(count));
  out.next.assign(out.chunks * out.bins, 0);
  const auto endOf = [&](std::size_t c) { return std::min(count, (c + 1) * chunk); };
  workers.run(out.chunks, [&](std::size_t c) {
    findTiles(blocks, view, grid, {c * chunk, endOf(c)}, out.ranges.data() + c * chunk);
    std::uint32_t* counts = out.next.data() + c * out.bins;
    for (std::size_t k = c * chunk; k < endOf(c); ++k)
      forBins(out.ranges[k], grid.columns, [&](std::size_t b) { ++counts[b]; });
  });
  const std::uint32_t sum = addUp(out);
  if (out.blocks.size() < sum) out.blocks.resize(sum);
  workers.run(out.chunks, [&](std::size_t c) {
    std::uint32_t* next = out.next.data() + c * out.bins;
    for (std::size_t k = c * chunk; k < endOf(c); ++k)
      forBins(out.ranges[k], grid.columns,
              [&](std::size_t b) { out.blocks[next[b]++] = static_cast<std::uint32_t>(k); });
  });
}

// 0..255.
std::uint32_t packed(const vec3& colour) {
  const auto byte = [](float v) {
    return static_cast<std::uint32_t>(std::clamp(v, 0.f, 255.f) + 0.5f);
  };
  return byte(colour.r) | byte(colour.g) << 8 | byte(colour.b) << 16 | 0xff000000u;
}

// A picture that is being drawn, in tiles.
struct Frame {
  SplatView view;
  TileGrid grid{};
  SplatOptions options;
  Bins bins;
  std::vector<std::uint32_t> order;  // of the tiles, from the middle of the picture outwards
  std::vector<std::uint8_t> drawn;   // by tile
  std::size_t firstLeft = 0;         // in order: all before are drawn

  int side() const { return kSplatTile / options.samples; }  // pixels
};

// Draws one tile at a time.
class TilePainter {
 public:
  void paint(const SplatScene& scene, const Frame& frame, std::size_t tile, Raster& out) {
    const auto facing = frame.bins.of(2 * tile), away = frame.bins.of(2 * tile + 1);
    const auto columns = static_cast<std::size_t>(frame.grid.columns);
    const int column = static_cast<int>(tile % columns), row = static_cast<int>(tile / columns);
    const int left = column * frame.side(), top = row * frame.side();
    if (facing.empty() && away.empty()) {
      clear(frame, left, top, out);
      return;
    }
    const TilePlace place{frame.grid.originX + static_cast<float>(column * frame.grid.step),
                          frame.grid.originY + static_cast<float>(row * frame.grid.step),
                          std::numeric_limits<float>::infinity()};
    empty(out.trace);
    draw({scene, frame, place, out.trace}, facing, away);
    resolve(frame, left, top, out);
  }

 private:
  struct Job {
    const SplatScene& scene;
    const Frame& frame;
    TilePlace place;
    bool trace;
  };

  void empty(bool trace) {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    std::fill(std::begin(tile_.depth), std::end(tile_.depth), kFar);
    std::fill(std::begin(tile_.colour), std::end(tile_.colour), 0.f);
    if (!trace) return;
    std::fill(std::begin(tile_.least), std::end(tile_.least), 2.f);
    std::fill(std::begin(tile_.point), std::end(tile_.point), kNone);
    std::fill(std::begin(tile_.seenDepth), std::end(tile_.seenDepth), kFar);
  }

  // Blocks that face the eye first: the others are hidden then, most of them.
  void draw(Job job, std::span<const std::uint32_t> facing, std::span<const std::uint32_t> away) {
    const float lowPass = job.frame.view.lowPass;
    const std::size_t first = project(job, facing, 0);
    drawDepths({splats_.data(), first}, lowPass, tile_);
    job.place.farthest = farthestSeen(tile_, job.frame.side() * job.frame.options.samples);
    const std::size_t all = project(job, away, first);
    drawDepths({splats_.data() + first, all - first}, lowPass, tile_);
    drawColours(job.scene, {splats_.data(), all}, lowPass, job.trace, tile_);
  }

  std::size_t project(const Job& job, std::span<const std::uint32_t> blocks, std::size_t from) {
    if (splats_.size() < from + blocks.size()) splats_.resize(from + blocks.size());
    return from +
           projectSplats(job.scene, job.frame.view, job.place, blocks, splats_.data() + from);
  }

  // Into the pixels from (left, top) on.
  void resolve(const Frame& frame, int left, int top, Raster& out) {
    const int samples = frame.options.samples, side = frame.side();
    const int columns = std::min(side, out.width - left), rows = std::min(side, out.height - top);
    packPixels(tile_, 255.f * frame.options.background, samples, pixels_);
    for (int y = 0; y < rows; ++y) {
      const std::size_t first = pixelAt(out, left, top + y);
      std::copy_n(pixels_ + y * kSplatTile, columns, out.pixels.data() + first);
      for (int x = 0; out.trace && x < columns; ++x) {
        const int at = y * samples * kSplatStride + x * samples;
        out.points[first + static_cast<std::size_t>(x)] = tile_.point[at];
        out.depths[first + static_cast<std::size_t>(x)] = tile_.seenDepth[at];
      }
    }
  }

  static void clear(const Frame& frame, int left, int top, Raster& out) {
    const auto columns = static_cast<std::size_t>(std::min(frame.side(), out.width - left));
    const vec3 background = 255.f * frame.options.background;
    for (int y = top; y < std::min(top + frame.side(), out.height); ++y) {
      const std::size_t first = pixelAt(out, left, y);
      std::fill_n(out.pixels.data() + first, columns, packed(background));
      if (!out.trace) continue;
      std::fill_n(out.points.data() + first, columns, kNone);
      std::fill_n(out.depths.data() + first, columns, std::numeric_limits<float>::infinity());
    }
  }

  static std::size_t pixelAt(const Raster& out, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) +
           static_cast<std::size_t>(x);
  }

  std::vector<ProjectedSplats> splats_;
  SplatTile tile_;
  std::uint32_t pixels_[kSplatTile * kSplatTile + kLanes];
};

// What is looked at is in the middle, mostly. Ties by row and column.
void orderTiles(Frame& frame) {
  const TileGrid& grid = frame.grid;
  frame.order.resize(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows));
  std::iota(frame.order.begin(), frame.order.end(), 0u);
  const auto apart = [&](std::uint32_t tile) {
    const int column = static_cast<int>(tile) % grid.columns;
    const int row = static_cast<int>(tile) / grid.columns;
    const int x = 2 * column + 1 - grid.columns, y = 2 * row + 1 - grid.rows;
    return x * x + y * y;
  };
  std::stable_sort(frame.order.begin(), frame.order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return apart(a) < apart(b); });
}

void setTexture(const SplatTexture* texture, SplatScene& s) {
  const std::size_t room = texture ? paddedToLanes(s.size) : 0;
  for (auto* column : {&s.texelX, &s.texelY, &s.sx, &s.sy, &s.sz, &s.tx, &s.ty, &s.tz})
    column->assign(room, 0);
  s.swatch.clear();
  if (!texture) return;
  DAPPLE_CHECK(texture->texel.size(), ==, s.size);
  DAPPLE_CHECK(texture->frame.size(), ==, s.size);
  const float perPixel = 1 / texture->scale;
  for (std::size_t i = 0; i < s.size; ++i) {
    const vec3 right = perPixel * texture->frame[i].s, up = perPixel * texture->frame[i].t;
    s.texelX[i] = texture->texel[i].x - 0.5f, s.texelY[i] = texture->texel[i].y - 0.5f;
    s.sx[i] = right.x, s.sy[i] = right.y, s.sz[i] = right.z;
    s.tx[i] = up.x, s.ty[i] = up.y, s.tz[i] = up.z;
  }
  s.swatchWidth = texture->swatch.width, s.swatchHeight = texture->swatch.height;
  s.swatchRepeats = texture->swatch.tileable;
  s.longestStep = texture->longestStep;
  const auto pixelAt = [&](int x, int y) {
    const int right = s.swatchRepeats ? x % s.swatchWidth : std::min(x, s.swatchWidth - 1);
    const int below = s.swatchRepeats ? y % s.swatchHeight : std::min(y, s.swatchHeight - 1);
    return packed(
        255.f * texture->swatch.colours()[static_cast<std::size_t>(below * s.swatchWidth + right)]);
  };
  for (int y = 0; y < s.swatchHeight; ++y)
    for (int x = 0; x < s.swatchWidth; ++x)
      s.swatch.push_back(
          {pixelAt(x, y), pixelAt(x + 1, y), pixelAt(x, y + 1), pixelAt(x + 1, y + 1)});
}

}  // namespace

struct CpuSplatter::Scene : SplatScene {
  Frame frame;
  ScratchPool<TilePainter> painters{[] { return std::make_unique<TilePainter>(); }};
};

CpuSplatter::CpuSplatter(Workers& workers) : workers_(workers), scene_(std::make_unique<Scene>()) {}
CpuSplatter::~CpuSplatter() = default;

void CpuSplatter::update(const SplatColumns& columns) {
  const std::size_t n = columns.positions.size(), room = paddedToLanes(n);
  DAPPLE_CHECK(columns.normals.size(), ==, n);
  DAPPLE_CHECK(columns.radii.size(), ==, n);
  Scene& s = *scene_;
  s.size = n;
  for (auto* column : {&s.x, &s.y, &s.z, &s.nx, &s.ny, &s.nz, &s.radius}) column->assign(room, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const vec3 &p = columns.positions[i], normal = columns.normals[i];
    const float length = glm::length(normal);
    const vec3 unit = length > 0.5f ? normal / length : vec3(0);
    s.x[i] = p.x, s.y[i] = p.y, s.z[i] = p.z;
    s.nx[i] = unit.x, s.ny[i] = unit.y, s.nz[i] = unit.z;
    s.radius[i] = columns.radii[i];
  }
  findBlocks(s);
  recolour(columns.colours);
  setTexture(columns.texture, s);
}

void CpuSplatter::recolour(const std::vector<vec3>& colours) {
  DAPPLE_CHECK(colours.size(), ==, scene_->size);
  scene_->colour.resize(paddedToLanes(colours.size()));
  for (std::size_t i = 0; i < colours.size(); ++i) scene_->colour[i] = packed(255.f * colours[i]);
}

void CpuSplatter::begin(const Camera& camera, int width, int height, const SplatOptions& options,
                        Raster& out) {
  validate(width, height, options);
  Frame& frame = scene_->frame;
  const int samples = options.samples;
  frame.options = options;
  frame.view = viewOf(camera, height * samples, options);
  frame.view.count = std::min(options.count, scene_->size);
  const int side = frame.side();
  const auto half = [&](int size) { return -0.5f * static_cast<float>(samples * size); };
  frame.grid = {.columns = (width + side - 1) / side,
                .rows = (height + side - 1) / side,
                .step = side * samples,
                .originX = half(width),
                .originY = half(height)};
  const bool same = out.width == width && out.height == height;
  out.width = width, out.height = height;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  // The old picture stays where the new one is not drawn yet.
  if (!same) out.pixels.assign(pixels, packed(255.f * options.background));
  out.points.resize(out.trace ? pixels : 0, kNone);
  out.depths.resize(out.trace ? pixels : 0, std::numeric_limits<float>::infinity());
  bin(scene_->blocks, frame.view, frame.grid, workers_, frame.bins);
  orderTiles(frame);
  frame.drawn.assign(frame.order.size(), 0);
  frame.firstLeft = 0;
}

bool CpuSplatter::advance(std::chrono::steady_clock::time_point until, Raster& out) {
  Frame& frame = scene_->frame;
  const std::size_t left = frame.order.size() - frame.firstLeft;
  std::atomic<bool> late = false;
  workers_.run(left, [&](std::size_t k) {
    // The first is drawn in any case, so that every call gets on.
    if (k > 0 && late.load(std::memory_order_relaxed)) return;
    const std::size_t tile = frame.order[frame.firstLeft + k];
    scene_->painters.use([&](TilePainter& painter) { painter.paint(*scene_, frame, tile, out); });
    frame.drawn[tile] = 1;
    if (std::chrono::steady_clock::now() >= until) late.store(true, std::memory_order_relaxed);
  });
  while (frame.firstLeft < frame.order.size() && frame.drawn[frame.order[frame.firstLeft]])
    ++frame.firstLeft;
  return frame.firstLeft == frame.order.size();
}

void CpuSplatter::draw(const Camera& camera, int width, int height, const SplatOptions& options,
                       Raster& out) {
  begin(camera, width, height, options, out);
  advance(std::chrono::steady_clock::time_point::max(), out);
}

Image toImage(const Raster& raster) {
  Image image{raster.width, raster.height, 4, std::vector<float>(4 * raster.pixels.size())};
  for (std::size_t p = 0; p < raster.pixels.size(); ++p)
    for (std::size_t c = 0; c < 4; ++c)
      image.pixels[4 * p + c] = static_cast<float>(raster.pixels[p] >> (8 * c) & 255) / 255;
  return image;
}

}  // namespace dapple
