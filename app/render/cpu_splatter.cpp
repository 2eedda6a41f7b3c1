// Blocks of eight points are binned into the tiles that their splats may touch, chunk after chunk,
// so that each tile has them in their order whatever thread has binned them; then every tile is
// drawn alone.
#include "app/render/cpu_splatter.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "app/render/splat_kernels.h"
#include "base/errors.h"
#include "base/scratch_pool.h"
#include "base/simd.h"

namespace dapple {
namespace {

constexpr std::size_t kChunkOfPoints = 16384;
constexpr std::size_t kChunks = 32;         // at most
constexpr std::size_t kSmallestChunk = 64;  // blocks

template <class Body>
void forChunks(Workers& workers, std::size_t n, const Body& body) {
  workers.run((n + kChunkOfPoints - 1) / kChunkOfPoints, [&](std::size_t c) {
    for (std::size_t i = c * kChunkOfPoints; i < std::min(n, (c + 1) * kChunkOfPoints); ++i)
      body(i);
  });
}

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

// A picture that is being drawn, in tiles.
struct Frame {
  SplatView view;
  TileGrid grid{};
  SplatOptions options;
  Bins bins;
  std::vector<std::uint32_t> order;  // of the tiles, from the middle of the picture outwards
  std::vector<std::uint8_t> drawn;   // by tile
  std::size_t firstLeft = 0;         // in order: all before are drawn
  std::size_t splats = 0;            // so far, by tile

  int side() const { return kSplatTile / options.samples; }  // pixels
};

// Draws one tile at a time.
class TilePainter {
 public:
  // Returns how many splats it has, at most.
  std::size_t paint(const SplatScene& scene, const Frame& frame, std::size_t tile, Raster& out) {
    const auto facing = frame.bins.of(2 * tile), away = frame.bins.of(2 * tile + 1);
    const auto columns = static_cast<std::size_t>(frame.grid.columns);
    const int column = static_cast<int>(tile % columns), row = static_cast<int>(tile / columns);
    const int left = column * frame.side(), top = row * frame.side();
    if (facing.empty() && away.empty()) {
      clear(frame, left, top, out);
      return 0;
    }
    const TilePlace place{frame.grid.originX + static_cast<float>(column * frame.grid.step),
                          frame.grid.originY + static_cast<float>(row * frame.grid.step),
                          std::numeric_limits<float>::infinity()};
    empty(out.trace);
    const std::size_t blocks = draw({scene, frame, place, out.trace}, facing, away);
    resolve(frame, scene.order, left, top, out);
    return kLanes * blocks;
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
    std::fill(std::begin(tile_.point), std::end(tile_.point), std::bit_cast<float>(kNone));
    std::fill(std::begin(tile_.seenDepth), std::end(tile_.seenDepth), kFar);
  }

  // Blocks that face the eye first: the others are hidden then, most of them.
  std::size_t draw(Job job, std::span<const std::uint32_t> facing,
                   std::span<const std::uint32_t> away) {
    const float lowPass = job.frame.view.lowPass;
    const std::size_t first = project(job, facing, 0);
    drawDepths({splats_.data(), first}, lowPass, tile_);
    job.place.farthest = farthestSeen(tile_, job.frame.side() * job.frame.options.samples);
    const std::size_t all = project(job, away, first);
    drawDepths({splats_.data() + first, all - first}, lowPass, tile_);
    drawColours(job.scene, {splats_.data(), all}, lowPass, job.trace, tile_);
    return all;
  }

  std::size_t project(const Job& job, std::span<const std::uint32_t> blocks, std::size_t from) {
    if (splats_.size() < from + blocks.size()) splats_.resize(from + blocks.size());
    return from +
           projectSplats(job.scene, job.frame.view, job.place, blocks, splats_.data() + from);
  }

  // Into the pixels from (left, top) on.
  void resolve(const Frame& frame, const std::vector<Index>& order, int left, int top,
               Raster& out) {
    const int samples = frame.options.samples, side = frame.side();
    const int columns = std::min(side, out.width - left), rows = std::min(side, out.height - top);
    packPixels(tile_, 255.f * frame.options.background, samples, pixels_);
    for (int y = 0; y < rows; ++y) {
      const std::size_t first = pixelAt(out, left, top + y);
      std::copy_n(pixels_ + y * kSplatTile, columns, out.pixels.data() + first);
      for (int x = 0; out.trace && x < columns; ++x) {
        const int at = y * samples * kSplatStride + x * samples;
        const Index point = std::bit_cast<Index>(tile_.point[at]);
        out.points[first + static_cast<std::size_t>(x)] =
            point == kNone || order.empty() ? point : order[point];
        out.depths[first + static_cast<std::size_t>(x)] = tile_.seenDepth[at];
      }
    }
  }

  static void clear(const Frame& frame, int left, int top, Raster& out) {
    const auto columns = static_cast<std::size_t>(std::min(frame.side(), out.width - left));
    for (int y = top; y < std::min(top + frame.side(), out.height); ++y) {
      const std::size_t first = pixelAt(out, left, y);
      std::fill_n(out.pixels.data() + first, columns, packedColour(frame.options.background));
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

void setSwatch(const Swatch& swatch, SplatTexels& t) {
  t.width = swatch.width, t.height = swatch.height;
  t.repeats = swatch.tileable;
  const auto pixelAt = [&](int x, int y) {
    const int column = t.repeats ? x % t.width : std::min(x, t.width - 1);
    const int row = t.repeats ? y % t.height : std::min(y, t.height - 1);
    return packedColour(swatch.colours()[static_cast<std::size_t>(row * t.width + column)]);
  };
  for (int y = 0; y < t.height; ++y)
    for (int x = 0; x < t.width; ++x)
      t.swatch.push_back(
          {pixelAt(x, y), pixelAt(x + 1, y), pixelAt(x, y + 1), pixelAt(x + 1, y + 1)});
}

Index pointOf(const SplatScene& scene, std::size_t i) {
  return scene.order.empty() ? static_cast<Index>(i) : scene.order[i];
}

void setColours(const std::vector<vec3>& colours, const PlainPoints& plain, Workers& workers,
                SplatScene& s) {
  s.colour.resize(paddedToLanes(colours.size()));
  forChunks(workers, s.size, [&](std::size_t i) {
    const Index point = pointOf(s, i);
    s.colour[i] = packedColour(colours[point], !plain.empty() && plain[point] != 0);
  });
}

void setBlocks(Workers& workers, SplatScene& s) {
  SplatBlocks& b = s.blocks;
  b.size = s.radius.size() / kLanes;
  for (auto* column : {&b.x, &b.y, &b.z, &b.largest, &b.nx, &b.ny, &b.nz})
    column->resize(paddedToLanes(b.size));
  b.spread.assign(paddedToLanes(b.size), -1);
  const std::size_t chunk = kChunkOfPoints / kLanes;
  workers.run((b.size + chunk - 1) / chunk, [&](std::size_t c) {
    findBlocks(s, {c * chunk, std::min(b.size, (c + 1) * chunk)});
  });
}

}  // namespace

struct CpuSplatter::Drawing {
  Frame frame;
  ScratchPool<TilePainter> painters{[] { return std::make_unique<TilePainter>(); }};
};

CpuSplatter::CpuSplatter(Workers& workers)
    : workers_(workers),
      scene_(std::make_shared<SplatScene>()),
      drawing_(std::make_unique<Drawing>()) {}
CpuSplatter::~CpuSplatter() = default;

std::shared_ptr<SplatScene> makeSplatScene(const SplatColumns& columns, Workers& workers) {
  const std::size_t n = columns.positions.size(), room = paddedToLanes(n);
  DAPPLE_CHECK(columns.normals.size(), ==, n);
  DAPPLE_CHECK(columns.colours.size(), ==, n);
  DAPPLE_CHECK(columns.radii.size(), ==, n);
  if (columns.order) DAPPLE_CHECK(columns.order->size(), ==, n);
  auto made = std::make_shared<SplatScene>();
  SplatScene& s = *made;
  s.size = n;
  if (columns.order) s.order = *columns.order;
  s.placeOf.resize(s.order.size());
  for (std::size_t i = 0; i < s.order.size(); ++i) s.placeOf[s.order[i]] = static_cast<Index>(i);
  for (auto* column : {&s.x, &s.y, &s.z, &s.nx, &s.ny, &s.nz}) column->resize(room);
  s.radius.assign(room, 0);
  forChunks(workers, n, [&](std::size_t i) {
    const Index point = pointOf(s, i);
    const vec3 &p = columns.positions[point], normal = columns.normals[point];
    const float length = glm::length(normal);
    const vec3 unit = length > 0.5f ? normal / length : vec3(0);
    s.x[i] = p.x, s.y[i] = p.y, s.z[i] = p.z;
    s.nx[i] = unit.x, s.ny[i] = unit.y, s.nz[i] = unit.z;
    s.radius[i] = columns.radii[point];
  });
  setBlocks(workers, s);
  setColours(columns.colours, {}, workers, s);
  return made;
}

std::shared_ptr<const SplatTexels> makeSplatTexels(const SplatTexture& texture,
                                                   const std::vector<Index>* order,
                                                   Workers& workers) {
  const std::size_t n = texture.texel.size();
  DAPPLE_CHECK(texture.frame.size(), ==, n);
  auto made = std::make_shared<SplatTexels>();
  SplatTexels& t = *made;
  for (auto* column : {&t.x, &t.y, &t.sx, &t.sy, &t.sz, &t.tx, &t.ty, &t.tz})
    column->resize(paddedToLanes(n));
  forChunks(workers, n, [&](std::size_t i) {
    const std::size_t point = order && !order->empty() ? (*order)[i] : i;
    const TangentFrame& frame = texture.frame[point];
    const float pixels = texture.pixelsPerUnit(point);
    const vec3 right = pixels * frame.s, up = pixels * frame.t;
    const vec2 texel = texture.texel[point] - 0.5f;
    t.x[i] = texel.x, t.y[i] = texel.y;
    t.sx[i] = right.x, t.sy[i] = right.y, t.sz[i] = right.z;
    t.tx[i] = up.x, t.ty[i] = up.y, t.tz[i] = up.z;
  });
  t.longestStep = texture.longestStep;
  setSwatch(texture.swatch, t);
  return made;
}

void CpuSplatter::update(const SplatColumns& columns) {
  show(makeSplatScene(columns, workers_));
  retexture(columns.texture);
}

void CpuSplatter::retexture(const SplatTexture* texture) {
  show(texture ? makeSplatTexels(*texture, &scene_->order, workers_) : nullptr);
}

void CpuSplatter::recolour(const std::vector<vec3>& colours, const PlainPoints& plain) {
  DAPPLE_CHECK(colours.size(), ==, scene_->size);
  if (!plain.empty()) DAPPLE_CHECK(plain.size(), ==, scene_->size);
  setColours(colours, plain, workers_, *scene_);
}

void CpuSplatter::show(std::shared_ptr<SplatScene> scene) {
  scene_ = std::move(scene);
}

void CpuSplatter::show(std::shared_ptr<const SplatTexels> texels) {
  if (texels) DAPPLE_CHECK(texels->x.size(), ==, paddedToLanes(scene_->size));
  scene_->texels = std::move(texels);
}

void CpuSplatter::swapColours(std::vector<std::uint32_t>& colours) {
  DAPPLE_CHECK(colours.size(), ==, scene_->size);
  colours.resize(paddedToLanes(colours.size()));
  std::swap(scene_->colour, colours);
}

void CpuSplatter::tint(std::span<const Index> points, const Tint& tint) {
  SplatScene& s = *scene_;
  for (const Index point : points) {
    std::uint32_t& colour = s.colour[s.placeOf.empty() ? point : s.placeOf[point]];
    colour = tint.over(colour);
  }
}

std::span<const std::uint32_t> CpuSplatter::colours() const {
  return {scene_->colour.data(), scene_->size};
}

void CpuSplatter::begin(const Camera& camera, int width, int height, const SplatOptions& options,
                        Raster& out) {
  validate(width, height, options);
  Frame& frame = drawing_->frame;
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
  if (!same) out.pixels.assign(pixels, packedColour(options.background));
  out.points.resize(out.trace ? pixels : 0, kNone);
  out.depths.resize(out.trace ? pixels : 0, std::numeric_limits<float>::infinity());
  bin(scene_->blocks, frame.view, frame.grid, workers_, frame.bins);
  orderTiles(frame);
  frame.drawn.assign(frame.order.size(), 0);
  frame.firstLeft = 0;
  frame.splats = 0;
}

bool CpuSplatter::advance(std::chrono::steady_clock::time_point until, Raster& out) {
  Frame& frame = drawing_->frame;
  const std::size_t left = frame.order.size() - frame.firstLeft;
  std::atomic<bool> late = false;
  std::atomic<std::size_t> splats = frame.splats;
  workers_.run(left, [&](std::size_t k) {
    // The first is drawn in any case, so that every call gets on.
    if (k > 0 && late.load(std::memory_order_relaxed)) return;
    const std::size_t tile = frame.order[frame.firstLeft + k];
    drawing_->painters.use(
        [&](TilePainter& painter) { splats += painter.paint(*scene_, frame, tile, out); });
    frame.drawn[tile] = 1;
    if (std::chrono::steady_clock::now() >= until) late.store(true, std::memory_order_relaxed);
  });
  frame.splats = splats;
  while (frame.firstLeft < frame.order.size() && frame.drawn[frame.order[frame.firstLeft]])
    ++frame.firstLeft;
  return frame.firstLeft == frame.order.size();
}

std::size_t CpuSplatter::splatsDrawn() const {
  return drawing_->frame.splats;
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
