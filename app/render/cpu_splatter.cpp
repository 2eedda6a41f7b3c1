// Points are binned into the tiles that their splats may touch, chunk after chunk, so that each
// tile has them in their order whatever thread has binned them; then every tile is drawn alone.
#include "app/render/cpu_splatter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/render/splat_kernels.h"
#include "base/errors.h"
#include "base/simd.h"

namespace dapple {
namespace {

constexpr std::size_t kChunk = 8192;  // points
constexpr int kLargestGrid = 254;     // tiles a side that one pass can have

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
  view.headlight = options.shading != Shading::Off;
  return view;
}

// For each tile the points that may touch it, in their order, those that face the eye first: bin
// 2 t and bin 2 t + 1.
struct Bins {
  std::vector<TileRange> ranges;    // by point
  std::vector<std::uint32_t> next;  // [chunk][bin]; once filled, where a chunk's share ends
  std::vector<Index> points;
  std::size_t chunks = 0, bins = 0;

  std::span<const Index> of(std::size_t b) const {
    if (chunks == 0) return {};
    const std::uint32_t* ends = next.data() + (chunks - 1) * bins;
    const std::size_t begin = b == 0 ? 0 : ends[b - 1];
    return {points.data() + begin, ends[b] - begin};
  }
};

template <class Visit>
void forBins(const TileRange& range, int columns, const Visit& visit) {
  if (range.left == kNoTile) return;
  for (int row = range.top; row <= range.bottom; ++row)
    for (int column = range.left; column <= range.right; ++column)
      visit(2 * static_cast<std::size_t>(row * columns + column) + range.away);
}

void bin(const SplatScene& scene, const SplatView& view, const TileGrid& grid, Workers& workers,
         Bins& out) {
  out.chunks = (scene.size + kChunk - 1) / kChunk;
  out.bins = 2 * static_cast<std::size_t>(grid.columns * grid.rows);
  out.ranges.resize(paddedToLanes(scene.size));
  out.next.assign(out.chunks * out.bins, 0);
  const auto endOf = [&](std::size_t chunk) { return std::min(scene.size, (chunk + 1) * kChunk); };
  workers.run(out.chunks, [&](std::size_t chunk) {
    const std::size_t begin = chunk * kChunk;
    findTiles(scene, view, grid, {begin, endOf(chunk)}, out.ranges.data() + begin);
    std::uint32_t* counts = out.next.data() + chunk * out.bins;
    for (std::size_t i = begin; i < endOf(chunk); ++i)
      forBins(out.ranges[i], grid.columns, [&](std::size_t b) { ++counts[b]; });
  });
  std::uint32_t sum = 0;
  for (std::size_t b = 0; b < out.bins; ++b)
    for (std::size_t chunk = 0; chunk < out.chunks; ++chunk) {
      std::uint32_t& count = out.next[chunk * out.bins + b];
      sum += count;
      count = sum - count;
    }
  if (out.points.size() < sum) out.points.resize(sum);
  workers.run(out.chunks, [&](std::size_t chunk) {
    std::uint32_t* next = out.next.data() + chunk * out.bins;
    for (std::size_t i = chunk * kChunk; i < endOf(chunk); ++i)
      forBins(out.ranges[i], grid.columns,
              [&](std::size_t b) { out.points[next[b]++] = static_cast<Index>(i); });
  });
}

std::uint32_t packed(float red, float green, float blue) {
  const auto byte = [](float v) {
    return static_cast<std::uint32_t>(std::clamp(v, 0.f, 255.f) + 0.5f);
  };
  return byte(red) | byte(green) << 8 | byte(blue) << 16 | 0xff000000u;
}

// One tile at a time; each thread has its own.
class TilePainter {
 public:
  TilePainter(const SplatScene& scene, const SplatView& view, const SplatOptions& options,
              bool trace)
      : scene_(scene), view_(view), options_(options), trace_(trace) {}

  // The points of a tile whose corner lies at (x, y): those that face the eye, and the others.
  void paint(std::span<const Index> facing, std::span<const Index> away, float x, float y) {
    std::fill(std::begin(tile_.depth), std::end(tile_.depth),
              std::numeric_limits<float>::infinity());
    for (float* channel : {tile_.red, tile_.green, tile_.blue, tile_.weight})
      std::fill_n(channel, kSplatTile * kSplatStride, 0.f);
    if (trace_) {
      std::fill(std::begin(tile_.least), std::end(tile_.least), 2.f);
      std::fill(std::begin(tile_.point), std::end(tile_.point), kNone);
      std::fill(std::begin(tile_.seenDepth), std::end(tile_.seenDepth),
                std::numeric_limits<float>::infinity());
    }
    const int side = kSplatTile / options_.samples * options_.samples;
    TilePlace place{x, y, std::numeric_limits<float>::infinity()};
    project(facing, place, 0);
    const std::size_t facingCount = count_;
    drawDepths({splats_.data(), count_}, view_.lowPass, tile_);
    place.farthest = farthestSeen(tile_, side);
    project(away, place, count_);
    drawDepths({splats_.data() + facingCount, count_ - facingCount}, view_.lowPass, tile_);
    drawColours(scene_, {splats_.data(), count_}, view_.lowPass, trace_, tile_);
  }

  // Into the pixels from (x0, y0) on.
  void resolve(int x0, int y0, Raster& out) {
    const int samples = options_.samples, side = kSplatTile / samples;
    const int columns = std::min(side, out.width - x0), rows = std::min(side, out.height - y0);
    normalise(tile_, 255.f * options_.background);
    packPixels(tile_, samples, pixels_);
    for (int y = 0; y < rows; ++y) {
      const std::size_t first = pixelAt(out, x0, y0 + y);
      std::copy_n(pixels_ + y * kSplatTile, columns, out.pixels.data() + first);
      for (int x = 0; trace_ && x < columns; ++x) {
        const int at = y * samples * kSplatStride + x * samples;
        out.points[first + static_cast<std::size_t>(x)] = tile_.point[at];
        out.depths[first + static_cast<std::size_t>(x)] = tile_.seenDepth[at];
      }
    }
  }

  // A tile without points.
  void clear(int x0, int y0, Raster& out) const {
    const int side = kSplatTile / options_.samples;
    const auto columns = static_cast<std::size_t>(std::min(side, out.width - x0));
    const vec3 background = 255.f * options_.background;
    for (int y = y0; y < std::min(y0 + side, out.height); ++y) {
      const std::size_t first = pixelAt(out, x0, y);
      std::fill_n(out.pixels.data() + first, columns,
                  packed(background.r, background.g, background.b));
      if (!trace_) continue;
      std::fill_n(out.points.data() + first, columns, kNone);
      std::fill_n(out.depths.data() + first, columns, std::numeric_limits<float>::infinity());
    }
  }

 private:
  static std::size_t pixelAt(const Raster& out, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) +
           static_cast<std::size_t>(x);
  }
  void project(std::span<const Index> points, const TilePlace& place, std::size_t from) {
    const std::size_t room = from + points.size() / ProjectedSplats::kCount + 1;
    if (splats_.size() < room) splats_.resize(room);
    count_ = from + projectSplats(scene_, view_, place, points, splats_.data() + from);
  }

  const SplatScene& scene_;
  const SplatView& view_;
  const SplatOptions& options_;
  bool trace_;
  std::vector<ProjectedSplats> splats_;
  std::size_t count_ = 0;
  SplatTile tile_;
  std::uint32_t pixels_[kSplatTile * kSplatTile + kLanes];
};

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
  for (const vec3& c : texture->swatch.colours())
    s.swatch.push_back(packed(255 * c.r, 255 * c.g, 255 * c.b));
}

}  // namespace

struct CpuSplatter::Scene : SplatScene {
  Bins bins;  // kept for their memory
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
  recolour(columns.colours);
  setTexture(columns.texture, s);
}

void CpuSplatter::recolour(const std::vector<vec3>& colours) {
  DAPPLE_CHECK(colours.size(), ==, scene_->size);
  scene_->colour.resize(paddedToLanes(colours.size()));
  for (std::size_t i = 0; i < colours.size(); ++i)
    scene_->colour[i] = packed(255 * colours[i].r, 255 * colours[i].g, 255 * colours[i].b);
}

void CpuSplatter::draw(const Camera& camera, int width, int height, const SplatOptions& options,
                       Raster& out) {
  validate(width, height, options);
  const int samples = options.samples, side = kSplatTile / samples;
  const SplatView view = viewOf(camera, height * samples, options);
  out.width = width, out.height = height;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  out.pixels.resize(pixels);
  out.points.resize(out.trace ? pixels : 0);
  out.depths.resize(out.trace ? pixels : 0);
  // Pictures of more tiles than a byte counts are drawn in parts.
  const int part = kLargestGrid * side;
  for (int top = 0; top < height; top += part)
    for (int left = 0; left < width; left += part) {
      const TileGrid grid{.columns = (std::min(part, width - left) + side - 1) / side,
                          .rows = (std::min(part, height - top) + side - 1) / side,
                          .step = side * samples,
                          .originX = static_cast<float>(samples) *
                                     (static_cast<float>(left) - 0.5f * static_cast<float>(width)),
                          .originY = static_cast<float>(samples) *
                                     (static_cast<float>(top) - 0.5f * static_cast<float>(height))};
      Bins& bins = scene_->bins;
      bin(*scene_, view, grid, workers_, bins);
      // A row of tiles at a time: one painter for many tiles.
      workers_.run(static_cast<std::size_t>(grid.rows), [&](std::size_t row) {
        const auto painter = std::make_unique<TilePainter>(*scene_, view, options, out.trace);
        for (int column = 0; column < grid.columns; ++column) {
          const std::size_t tile =
              row * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column);
          const int x = left + column * side, y = top + static_cast<int>(row) * side;
          const auto facing = bins.of(2 * tile), away = bins.of(2 * tile + 1);
          if (facing.empty() && away.empty()) {
            painter->clear(x, y, out);
            continue;
          }
          painter->paint(facing, away, grid.originX + static_cast<float>(column * grid.step),
                         grid.originY + static_cast<float>(static_cast<int>(row) * grid.step));
          painter->resolve(x, y, out);
        }
      });
    }
}

Image toImage(const Raster& raster) {
  Image image{raster.width, raster.height, 4, std::vector<float>(4 * raster.pixels.size())};
  for (std::size_t p = 0; p < raster.pixels.size(); ++p)
    for (std::size_t c = 0; c < 4; ++c)
      image.pixels[4 * p + c] = static_cast<float>(raster.pixels[p] >> (8 * c) & 255) / 255;
  return image;
}

}  // namespace dapple
