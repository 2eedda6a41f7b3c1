// One loop in SIMD projects all points and keeps those in a box or disc; only those are asked
// whether they lie in the outline and are seen.
#include "app/render/picking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "app/render/polygon_mask.h"
#include "base/errors.h"
#include "base/simd.h"

namespace dapple {
namespace {

constexpr std::size_t kChunk = 32768, kBlock = 2048;  // points, multiples of kLanes
constexpr float kInfinite = std::numeric_limits<float>::infinity();

// A point that is drawn lies no deeper than about a radius behind the nearest splat, and the traced
// depth is that of any splat in between: this much covers what an uneven surface adds.
constexpr float kDeeper = 1.5f;  // radii
// Across the pixels between a point and the place where its pixel was traced, and the low-pass
// filter, an inclined surface grows deeper by this times its slope.
constexpr float kAcross = 1.5f;      // pixels
constexpr float kSteepest = 8;       // as the splatter
constexpr float kOtherSide = -0.3f;  // cosine between normals: a thin wall's two sides
constexpr float kRounded = 1.0001f;  // a ball's square, for what is rounded
constexpr float kFold = -0.5f;  // cosine between neighbours' normals that do not belong together

// In the splatter's columns: see splat_kernels.h.
struct Lens {
  float ex, ey, ez, rx, ry, rz, dx, dy, dz, fx, fy, fz;
  float middleX, middleY, focal, nearest, farthest;
  bool orthographic;

  explicit Lens(const PixelView& v)
      : ex(v.eye.x),
        ey(v.eye.y),
        ez(v.eye.z),
        rx(v.right.x),
        ry(v.right.y),
        rz(v.right.z),
        dx(v.down.x),
        dy(v.down.y),
        dz(v.down.z),
        fx(v.forward.x),
        fy(v.forward.y),
        fz(v.forward.z),
        middleX(0.5f * static_cast<float>(v.width)),
        middleY(0.5f * static_cast<float>(v.height)),
        focal(v.focal),
        nearest(v.nearest),
        farthest(v.farthest),
        orthographic(v.orthographic) {}
};

// Points inside the box and nearer to the centre than the radius, which a splat may enlarge.
struct Sieve {
  vec2 low{-kInfinite}, high{kInfinite}, centre{0};
  float radius = kInfinite;  // pixels
  float ofSplat = 0;         // 1: a splat counts as a disc of its own radius where that is more
};

struct Hits {
  std::size_t count = 0;
  Index point[kBlock];
  float x[kBlock], y[kBlock], depth[kBlock];
};

[[gnu::always_inline]] inline const Float8& lanes(const float* p) {
  return *reinterpret_cast<const Float8*>(p);
}

struct PointColumns {
  const float *x, *y, *z, *radius;
};

DAPPLE_CLONES void sift(const PointColumns& p, const Lens& lens, const Sieve& sieve,
                        std::size_t begin, Hits& hits) {
  const Float8 zero{};
  const std::size_t end = begin + kBlock;
  hits.count = 0;
  for (std::size_t i = begin; i < end; i += kLanes) {
    const Float8 x = lanes(p.x + i) - lens.ex, y = lanes(p.y + i) - lens.ey,
                 z = lanes(p.z + i) - lens.ez;
    const Float8 depth = lens.fx * x + lens.fy * y + lens.fz * z;
    const Float8 scale = lens.orthographic ? zero + lens.focal : lens.focal / depth;
    const Float8 px = lens.middleX + scale * (lens.rx * x + lens.ry * y + lens.rz * z),
                 py = lens.middleY + scale * (lens.dx * x + lens.dy * y + lens.dz * z);
    const Float8 ax = px - sieve.centre.x, ay = py - sieve.centre.y;
    const Float8 splat = sieve.ofSplat * scale * lanes(p.radius + i);
    const Float8 reach = splat > sieve.radius ? splat : zero + sieve.radius;
    const Int8 inside = (depth > lens.nearest) & (depth < lens.farthest) & (px >= sieve.low.x) &
                        (px < sieve.high.x) & (py >= sieve.low.y) & (py < sieve.high.y) &
                        (ax * ax + ay * ay <= reach * reach);
    if (!anyLane(inside)) continue;
    for (std::size_t l = 0; l < kLanes; ++l) {
      hits.point[hits.count] = static_cast<Index>(i + l);
      hits.x[hits.count] = px[l], hits.y[hits.count] = py[l], hits.depth[hits.count] = depth[l];
      hits.count += inside[l] != 0;
    }
  }
}

DAPPLE_CLONES void siftBall(const PointColumns& p, const vec3& centre, float radius,
                            std::size_t begin, Hits& hits) {
  hits.count = 0;
  for (std::size_t i = begin; i < begin + kBlock; i += kLanes) {
    const Float8 x = lanes(p.x + i) - centre.x, y = lanes(p.y + i) - centre.y,
                 z = lanes(p.z + i) - centre.z;
    const Int8 inside = x * x + y * y + z * z <= radius * radius;
    if (!anyLane(inside)) continue;
    for (std::size_t l = 0; l < kLanes; ++l) {
      hits.point[hits.count] = static_cast<Index>(i + l);
      hits.count += inside[l] != 0;
    }
  }
}

// Sets of points that are connected, each known by its smallest member.
class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  Index find(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(Index i, Index j) {
    const Index a = find(i), b = find(j);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<Index> parent_;
};

std::vector<Index> joined(const std::vector<std::vector<Index>>& parts) {
  std::vector<Index> all;
  for (const std::vector<Index>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

void checkView(const PickView& view) {
  if (!view.traced) return;
  DAPPLE_CHECK(view.traced->width, ==, view.width);
  DAPPLE_CHECK(view.traced->height, ==, view.height);
  DAPPLE_CHECK(view.traced->points.size(), ==, view.traced->pixels.size());
}

}  // namespace

struct PickColumns {
  std::size_t size = 0;
  // Padded to whole blocks, with points that are nowhere.
  std::vector<float> x, y, z, radius;
  std::vector<vec3> normals;
  std::vector<vec3> low, high;  // of each block

  PointColumns all() const { return {x.data(), y.data(), z.data(), radius.data()}; }
  // False: no point of the block that begins at `begin` is in the ball.
  bool mayMeet(std::size_t begin, const Ball& ball) const {
    const vec3 &least = low[begin / kBlock], &most = high[begin / kBlock];
    const vec3 nearest = glm::max(least, glm::min(ball.centre, most));
    const vec3 away = nearest - ball.centre;
    return glm::dot(away, away) <= kRounded * ball.radius * ball.radius;
  }
  vec3 position(Index i) const { return {x[i], y[i], z[i]}; }
  vec3 normal(Index i) const { return normals.empty() ? vec3(0) : normals[i]; }

  // Of a point that lies at `pixel`.
  bool seen(const PixelView& pixels, const Raster& traced, Index i, const vec3& pixel) const {
    const auto at = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(traced.width) +
                    static_cast<std::size_t>(pixel.x);
    const float behind = pixel.z - traced.depths[at];
    if (behind <= 0) return true;
    const float perPixel = pixels.unitsPerPixel(pixel.z);
    const float least = kDeeper * radius[i];
    if (behind > least + kAcross * kSteepest * perPixel) return false;
    const vec3 n = normal(i);
    const vec3 other = normal(traced.points[at]);
    if (glm::dot(n, other) < kOtherSide) return false;
    const float cosine = std::abs(glm::dot(n, pixels.towardsEye(position(i))));
    const float sine = std::sqrt(std::max(0.f, glm::dot(n, n) - cosine * cosine));
    const float slope = std::min(kSteepest, sine / std::max(cosine, 1e-3f));
    return behind <= least + kAcross * slope * perPixel;
  }
};

// What find() looks for.
struct Picker::Query {
  Sieve sieve;
  const PolygonMask* polygon = nullptr;
};

Picker::Picker(Workers& workers) : workers_(workers), columns_(std::make_shared<PickColumns>()) {}
Picker::~Picker() = default;

std::shared_ptr<const PickColumns> makePickColumns(const std::vector<vec3>& positions,
                                                   const std::vector<vec3>& normals,
                                                   const std::vector<float>& radii) {
  const std::size_t n = positions.size(), room = (n + kBlock - 1) / kBlock * kBlock;
  DAPPLE_CHECK(radii.size(), ==, n);
  if (!normals.empty()) DAPPLE_CHECK(normals.size(), ==, n);
  auto made = std::make_shared<PickColumns>();
  PickColumns& c = *made;
  c.size = n;
  for (auto* column : {&c.x, &c.y, &c.z})
    column->assign(room, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < n; ++i)
    if (radii[i] > 0) c.x[i] = positions[i].x, c.y[i] = positions[i].y, c.z[i] = positions[i].z;
  c.low.assign(room / kBlock, vec3(kInfinite)), c.high.assign(room / kBlock, vec3(-kInfinite));
  for (std::size_t i = 0; i < n; ++i) {
    if (!(radii[i] > 0)) continue;
    c.low[i / kBlock] = glm::min(c.low[i / kBlock], positions[i]);
    c.high[i / kBlock] = glm::max(c.high[i / kBlock], positions[i]);
  }
  c.radius = radii;
  c.radius.resize(room, 0);
  c.normals = normals;
  return made;
}

void Picker::show(std::shared_ptr<const PickColumns> columns) {
  columns_ = std::move(columns);
}

void Picker::update(const std::vector<vec3>& positions, const std::vector<vec3>& normals,
                    const std::vector<float>& radii) {
  show(makePickColumns(positions, normals, radii));
}

std::vector<Index> Picker::find(const PickView& view, const Query& query) const {
  checkView(view);
  const PixelView pixels(view.camera, view.width, view.height);
  const Lens lens(pixels);
  Sieve sieve = query.sieve;
  sieve.low = glm::max(sieve.low, vec2(0));
  sieve.high = glm::min(sieve.high, vec2(view.width, view.height));
  const std::size_t room = columns_->x.size(), chunks = (room + kChunk - 1) / kChunk;
  std::vector<std::vector<Index>> found(chunks);
  workers_.run(chunks, [&](std::size_t chunk) {
    const auto hits = std::make_unique<Hits>();
    std::vector<Index>& out = found[chunk];
    const std::size_t end = std::min(room, (chunk + 1) * kChunk);
    for (std::size_t begin = chunk * kChunk; begin < end; begin += kBlock) {
      sift(columns_->all(), lens, sieve, begin, *hits);
      for (std::size_t k = 0; k < hits->count; ++k) {
        const vec3 at(hits->x[k], hits->y[k], hits->depth[k]);
        if (query.polygon && !query.polygon->contains(at)) continue;
        if (view.traced && !columns_->seen(pixels, *view.traced, hits->point[k], at)) continue;
        out.push_back(hits->point[k]);
      }
    }
  });
  return joined(found);
}

std::vector<Index> Picker::inDisc(const PickView& view, vec2 centre, float radius) const {
  return find(view, {.sieve = {.low = centre - vec2(radius),
                               .high = centre + vec2(std::nextafter(radius, kInfinite) + 1),
                               .centre = centre,
                               .radius = radius}});
}

std::vector<Index> Picker::inRectangle(const PickView& view, vec2 a, vec2 b) const {
  return find(view, {.sieve = {.low = glm::min(a, b), .high = glm::max(a, b)}});
}

std::vector<Index> Picker::inPolygon(const PickView& view, std::span<const vec2> corners) const {
  const PolygonMask mask(corners, view.width, view.height);
  if (mask.low().x > mask.high().x) return {};
  return find(view, {.sieve = {.low = mask.low(), .high = mask.high()}, .polygon = &mask});
}

std::vector<Index> Picker::visible(const PickView& view, std::span<const Index> points) const {
  checkView(view);
  DAPPLE_CHECK(view.traced != nullptr, ==, true);
  const PixelView pixels(view.camera, view.width, view.height);
  std::vector<Index> out;
  for (const Index i : points) {
    const vec3 at = pixels.project(columns_->position(i));
    const bool inside = at.z > pixels.nearest && at.z < pixels.farthest && at.x >= 0 && at.y >= 0 &&
                        at.x < static_cast<float>(view.width) &&
                        at.y < static_cast<float>(view.height);
    if (inside && columns_->seen(pixels, *view.traced, i, at)) out.push_back(i);
  }
  return out;
}

// Of the points of a ball those that neighbours connect to its seed.
std::vector<Index> Picker::connected(const Ball& ball, std::span<const Index> inside) const {
  const auto rankOf = [&](Index i) {  // kNone: not in the ball
    const auto place = std::lower_bound(inside.begin(), inside.end(), i);
    return place != inside.end() && *place == i ? static_cast<Index>(place - inside.begin())
                                                : kNone;
  };
  const Index seed = rankOf(ball.seed);
  if (seed == kNone) return {};
  UnionFind parts(inside.size());
  for (std::size_t k = 0; k < inside.size(); ++k)
    for (const Index j : ball.neighborhoods->of(inside[k])) {
      if (glm::dot(columns_->normal(inside[k]), columns_->normal(j)) < kFold) continue;
      if (const Index rank = rankOf(j); rank != kNone) parts.unite(static_cast<Index>(k), rank);
    }
  std::vector<Index> out;
  for (std::size_t k = 0; k < inside.size(); ++k)
    if (parts.find(static_cast<Index>(k)) == parts.find(seed)) out.push_back(inside[k]);
  return out;
}

std::vector<Index> Picker::inBall(const Ball& ball, const PickView* view) const {
  const std::size_t room = columns_->x.size(), chunks = (room + kChunk - 1) / kChunk;
  std::vector<std::vector<Index>> found(chunks);
  workers_.run(chunks, [&](std::size_t chunk) {
    const auto hits = std::make_unique<Hits>();
    const std::size_t end = std::min(room, (chunk + 1) * kChunk);
    for (std::size_t begin = chunk * kChunk; begin < end; begin += kBlock) {
      if (!columns_->mayMeet(begin, ball)) continue;
      siftBall(columns_->all(), ball.centre, ball.radius, begin, *hits);
      found[chunk].insert(found[chunk].end(), hits->point, hits->point + hits->count);
    }
  });
  std::vector<Index> inside = joined(found);
  if (ball.neighborhoods && ball.seed != kNone) inside = connected(ball, inside);
  return view && view->traced ? visible(*view, inside) : inside;
}

namespace {

// The traced pixel nearest to `pixel`, up to `tolerance` away.
struct TracedPoint {
  Index point = kNone;
  float depth = 0;
  bool under = false;  // the pixel itself
};
TracedPoint nearestTraced(const Raster& traced, vec2 pixel, float tolerance) {
  const int column = static_cast<int>(std::floor(pixel.x)),
            row = static_cast<int>(std::floor(pixel.y)),
            reach = static_cast<int>(std::ceil(std::max(0.f, tolerance)));
  TracedPoint best;
  float nearest = kInfinite;
  for (int y = std::max(0, row - reach); y <= std::min(traced.height - 1, row + reach); ++y)
    for (int x = std::max(0, column - reach); x <= std::min(traced.width - 1, column + reach);
         ++x) {
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(traced.width) +
                      static_cast<std::size_t>(x);
      const bool under = x == column && y == row;
      const float away = under ? 0 : glm::distance(vec2(x, y) + vec2(0.5f), pixel);
      if (traced.points[at] == kNone || away >= nearest || (!under && away > tolerance)) continue;
      nearest = away;
      best = {traced.points[at], traced.depths[at], under};
    }
  return best;
}

}  // namespace

// Of the splats under the pixel those of the nearest surface, of them the nearest in the picture;
// without one, what lies nearest in the picture.
Index Picker::nearestUntraced(const PickView& view, vec2 pixel, float tolerance) const {
  const PixelView pixels(view.camera, view.width, view.height);
  struct Candidate {
    Index point;
    float depth, away;
    bool under;
  };
  std::vector<Candidate> candidates;
  float front = kInfinite;
  bool anyUnder = false;
  for (const Index i :
       find(view, {.sieve = {.centre = pixel, .radius = std::max(0.f, tolerance), .ofSplat = 1}})) {
    const vec3 at = pixels.project(columns_->position(i));
    const float away = glm::distance(vec2(at), pixel), radius = columns_->radius[i];
    const bool under = away <= pixels.pixelsPerUnit(at.z) * radius;
    candidates.push_back({i, at.z, away, under});
    if (under) front = std::min(front, at.z + radius);
    anyUnder = anyUnder || under;
  }
  Index best = kNone;
  float nearest = kInfinite;
  for (const Candidate& c : candidates) {
    if (anyUnder && (!c.under || c.depth > front)) continue;
    if (c.away >= nearest) continue;
    nearest = c.away, best = c.point;
  }
  return best;
}

std::optional<Picked> Picker::pointAt(const PickView& view, vec2 pixel, float tolerance) const {
  checkView(view);
  const auto near = [&](float at, int size) {  // also false for NaN
    return at >= -tolerance - 1 && at <= static_cast<float>(size) + tolerance + 1;
  };
  if (!near(pixel.x, view.width) || !near(pixel.y, view.height)) return std::nullopt;
  const PixelView pixels(view.camera, view.width, view.height);
  Picked picked;
  if (view.traced) {
    const TracedPoint traced = nearestTraced(*view.traced, pixel, tolerance);
    if (traced.point == kNone) return std::nullopt;
    picked.point = traced.point;
    picked.position =
        traced.under ? pixels.unproject(pixel, traced.depth) : columns_->position(traced.point);
  } else {
    picked.point = nearestUntraced(view, pixel, tolerance);
    if (picked.point == kNone) return std::nullopt;
    picked.position = columns_->position(picked.point);
  }
  const vec3 eye = pixels.towardsEye(picked.position), normal = columns_->normal(picked.point);
  const bool known = glm::dot(normal, normal) > 0.25f;
  picked.normal = !known ? eye : glm::dot(normal, eye) < 0 ? -normal : normal;
  return picked;
}

}  // namespace dapple
