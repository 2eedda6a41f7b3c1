// All k-nearest neighbourhoods at once. A kd-tree query per point (nanoflann) spends its time on
// walking the tree and on keeping a sorted list; sixteen points that follow each other along the
// Morton curve share nearly all of their candidates, so we walk once for sixteen and let SIMD
// compare distances. Exact, and 3 to 4 times as fast as the tree (bench/knn prints both).
#include "points/neighborhoods.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kBlock = 16;  // points that are queried together
constexpr std::size_t kFan = 8;     // boxes under one box of the next level
constexpr std::size_t kBlocksPerChunk = 64;
constexpr float kFar = std::numeric_limits<float>::infinity();

struct Boxes {
  std::vector<float> lowX, lowY, lowZ, highX, highY, highZ;

  explicit Boxes(std::size_t count)
      : lowX(count, kFar),
        lowY(lowX),
        lowZ(lowX),
        highX(count, -kFar),
        highY(highX),
        highZ(highX) {}

  std::size_t size() const { return lowX.size(); }
  void extend(std::size_t box, const vec3& low, const vec3& high) {
    lowX[box] = std::min(lowX[box], low.x), highX[box] = std::max(highX[box], high.x);
    lowY[box] = std::min(lowY[box], low.y), highY[box] = std::max(highY[box], high.y);
    lowZ[box] = std::min(lowZ[box], low.z), highZ[box] = std::max(highZ[box], high.z);
  }
  vec3 low(std::size_t box) const { return {lowX[box], lowY[box], lowZ[box]}; }
  vec3 high(std::size_t box) const { return {highX[box], highY[box], highZ[box]}; }
};

// Points along the Morton curve in blocks of sixteen, under a tree of boxes of eight.
struct BlockTree {
  std::vector<Index> id;
  std::vector<float> x, y, z;  // padded to whole blocks with points at infinity
  std::vector<Boxes> levels;   // [0]: one box a block; each padded to a multiple of kFan

  std::size_t blocks() const { return x.size() / kBlock; }
};

BlockTree buildTree(const std::vector<vec3>& positions) {
  BlockTree tree;
  tree.id = mortonOrder(positions);
  const std::size_t blocks = (positions.size() + kBlock - 1) / kBlock;
  tree.x.assign(blocks * kBlock, kFar);
  tree.y = tree.z = tree.x;
  tree.id.resize(blocks * kBlock, kNone);
  auto padded = [](std::size_t count) { return (count + kFan - 1) / kFan * kFan; };
  tree.levels.emplace_back(padded(blocks));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const vec3& p = positions[tree.id[i]];
    tree.x[i] = p.x, tree.y[i] = p.y, tree.z[i] = p.z;
    tree.levels[0].extend(i / kBlock, p, p);
  }
  while (tree.levels.back().size() > kFan) {
    const Boxes& fine = tree.levels.back();
    Boxes coarse(padded(fine.size() / kFan));
    for (std::size_t b = 0; b < fine.size(); ++b)
      coarse.extend(b / kFan, fine.low(b), fine.high(b));
    tree.levels.push_back(std::move(coarse));
  }
  return tree;
}

// Working memory of one chunk of queries. Columns have room for a whole vector beyond their end.
struct Scratch {
  std::vector<Index> nodes, below;  // of the walk, level by level
  std::vector<float> x, y, z;       // candidates of the block
  std::vector<Index> id;
  std::size_t candidates = 0;
  std::vector<float> nearDistance2;  // of one query: within the radius
  std::vector<Index> nearId, rank;
  std::size_t near = 0;
  std::vector<std::pair<float, Index>> crowd;

  void reserve(std::size_t count) {
    if (x.size() >= count + kBlock) return;
    for (auto* column : {&x, &y, &z, &nearDistance2}) column->resize(2 * count + kBlock);
    for (auto* column : {&id, &nearId, &rank}) column->resize(2 * count + kBlock);
  }
};

struct Box {
  vec3 low, high;
};

// The three inner loops, once in plain C++ and once for AVX-512, whose compress store is what the
// plain form lacks most. Both do the same arithmetic on the same numbers in the same order.
struct PlainKernel {
  static float gap(float low, float high, float otherLow, float otherHigh) {
    const float above = otherLow - high, below = low - otherHigh;
    const float most = above > below ? above : below;
    return most > 0.f ? most : 0.f;
  }

  // Appends the children of `first` whose box comes within the radius of `box`.
  static void nearBoxes(const Boxes& boxes, std::size_t first, const Box& box, float radius2,
                        std::vector<Index>& out) {
    for (std::size_t b = first; b < first + kFan; ++b) {
      const float dx = gap(box.low.x, box.high.x, boxes.lowX[b], boxes.highX[b]);
      const float dy = gap(box.low.y, box.high.y, boxes.lowY[b], boxes.highY[b]);
      const float dz = gap(box.low.z, box.high.z, boxes.lowZ[b], boxes.highZ[b]);
      if (dx * dx + dy * dy + dz * dz <= radius2) out.push_back(static_cast<Index>(b));
    }
  }

  // Appends the points of the block at `first` within the radius of `box` to the candidates.
  static void nearPoints(const BlockTree& tree, std::size_t first, const Box& box, float radius2,
                         Scratch& scratch) {
    for (std::size_t i = first; i < first + kBlock; ++i) {
      const float dx = gap(box.low.x, box.high.x, tree.x[i], tree.x[i]);
      const float dy = gap(box.low.y, box.high.y, tree.y[i], tree.y[i]);
      const float dz = gap(box.low.z, box.high.z, tree.z[i], tree.z[i]);
      const std::size_t at = scratch.candidates;
      scratch.x[at] = tree.x[i], scratch.y[at] = tree.y[i], scratch.z[at] = tree.z[i];
      scratch.id[at] = tree.id[i];
      scratch.candidates += dx * dx + dy * dy + dz * dz <= radius2 ? 1u : 0u;
    }
  }

  // Candidates within the radius of point `point`, itself left out.
  static void within(const BlockTree& tree, std::size_t point, float radius2, Scratch& scratch) {
    const float px = tree.x[point], py = tree.y[point], pz = tree.z[point];
    std::size_t near = 0;
    for (std::size_t i = 0; i < scratch.candidates; ++i) {
      const float dx = scratch.x[i] - px, dy = scratch.y[i] - py, dz = scratch.z[i] - pz;
      const float distance2 = dx * dx + dy * dy + dz * dz;
      scratch.nearDistance2[near] = distance2;
      scratch.nearId[near] = scratch.id[i];
      near += static_cast<std::size_t>((distance2 <= radius2) & (scratch.id[i] != tree.id[point]));
    }
    scratch.near = near;
  }

  // rank[i] = how many of the near points are nearer than i.
  static void rankNear(Scratch& scratch) {
    const float* d = scratch.nearDistance2.data();
    for (std::size_t i = 0; i < scratch.near; ++i) {
      Index nearer = 0;
      for (std::size_t j = 0; j < scratch.near; ++j) nearer += d[j] < d[i] ? 1u : 0u;
      scratch.rank[i] = nearer;
    }
  }
};

#if defined(__x86_64__)
// g++ 12 reports its own intrinsics' undefined pass-through operands as uninitialised.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#define DAPPLE_AVX512 __attribute__((target("avx512f,avx512vl,popcnt")))
struct Avx512Kernel {
  DAPPLE_AVX512 static __m256 gap8(float low, float high, const float* otherLow,
                                   const float* otherHigh) {
    const __m256 above = _mm256_sub_ps(_mm256_loadu_ps(otherLow), _mm256_set1_ps(high));
    const __m256 below = _mm256_sub_ps(_mm256_set1_ps(low), _mm256_loadu_ps(otherHigh));
    return _mm256_max_ps(_mm256_max_ps(above, below), _mm256_setzero_ps());
  }

  DAPPLE_AVX512 static void nearBoxes(const Boxes& boxes, std::size_t first, const Box& box,
                                      float radius2, std::vector<Index>& out) {
    const __m256 dx = gap8(box.low.x, box.high.x, &boxes.lowX[first], &boxes.highX[first]);
    const __m256 dy = gap8(box.low.y, box.high.y, &boxes.lowY[first], &boxes.highY[first]);
    const __m256 dz = gap8(box.low.z, box.high.z, &boxes.lowZ[first], &boxes.highZ[first]);
    const __m256 d2 = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)),
                                    _mm256_mul_ps(dz, dz));
    unsigned mask = _mm256_cmp_ps_mask(d2, _mm256_set1_ps(radius2), _CMP_LE_OQ);
    for (; mask != 0; mask &= mask - 1)
      out.push_back(static_cast<Index>(first + static_cast<unsigned>(__builtin_ctz(mask))));
  }

  DAPPLE_AVX512 static __m512 gap16(float low, float high, __m512 other) {
    const __m512 above = _mm512_sub_ps(other, _mm512_set1_ps(high));
    const __m512 below = _mm512_sub_ps(_mm512_set1_ps(low), other);
    return _mm512_max_ps(_mm512_max_ps(above, below), _mm512_setzero_ps());
  }

  DAPPLE_AVX512 static __m512 lengthSquared(__m512 x, __m512 y, __m512 z) {
    return _mm512_add_ps(_mm512_add_ps(_mm512_mul_ps(x, x), _mm512_mul_ps(y, y)),
                         _mm512_mul_ps(z, z));
  }

  DAPPLE_AVX512 static void nearPoints(const BlockTree& tree, std::size_t first, const Box& box,
                                       float radius2, Scratch& scratch) {
    const __m512 x = _mm512_loadu_ps(&tree.x[first]), y = _mm512_loadu_ps(&tree.y[first]),
                 z = _mm512_loadu_ps(&tree.z[first]);
    const __m512 d2 =
        lengthSquared(gap16(box.low.x, box.high.x, x), gap16(box.low.y, box.high.y, y),
                      gap16(box.low.z, box.high.z, z));
    const __mmask16 mask = _mm512_cmp_ps_mask(d2, _mm512_set1_ps(radius2), _CMP_LE_OQ);
    const std::size_t at = scratch.candidates;
    _mm512_storeu_ps(&scratch.x[at], _mm512_maskz_compress_ps(mask, x));
    _mm512_storeu_ps(&scratch.y[at], _mm512_maskz_compress_ps(mask, y));
    _mm512_storeu_ps(&scratch.z[at], _mm512_maskz_compress_ps(mask, z));
    _mm512_storeu_si512(&scratch.id[at],
                        _mm512_maskz_compress_epi32(mask, _mm512_loadu_si512(&tree.id[first])));
    scratch.candidates = at + static_cast<unsigned>(__builtin_popcount(mask));
  }

  DAPPLE_AVX512 static void within(const BlockTree& tree, std::size_t point, float radius2,
                                   Scratch& scratch) {
    const __m512 px = _mm512_set1_ps(tree.x[point]), py = _mm512_set1_ps(tree.y[point]),
                 pz = _mm512_set1_ps(tree.z[point]), most = _mm512_set1_ps(radius2);
    const __m512i self = _mm512_set1_epi32(static_cast<int>(tree.id[point]));
    std::size_t near = 0;
    for (std::size_t i = 0; i < scratch.candidates; i += kBlock) {
      const std::size_t left = scratch.candidates - i;
      const __mmask16 valid = static_cast<__mmask16>(left >= kBlock ? 0xffffu : (1u << left) - 1u);
      const __m512 d2 = lengthSquared(_mm512_sub_ps(_mm512_loadu_ps(&scratch.x[i]), px),
                                      _mm512_sub_ps(_mm512_loadu_ps(&scratch.y[i]), py),
                                      _mm512_sub_ps(_mm512_loadu_ps(&scratch.z[i]), pz));
      const __m512i id = _mm512_loadu_si512(&scratch.id[i]);
      __mmask16 mask = _mm512_mask_cmp_ps_mask(valid, d2, most, _CMP_LE_OQ);
      mask = _mm512_mask_cmpneq_epi32_mask(mask, id, self);
      _mm512_storeu_ps(&scratch.nearDistance2[near], _mm512_maskz_compress_ps(mask, d2));
      _mm512_storeu_si512(&scratch.nearId[near], _mm512_maskz_compress_epi32(mask, id));
      near += static_cast<unsigned>(__builtin_popcount(mask));
    }
    scratch.near = near;
  }

  DAPPLE_AVX512 static void rankNear(Scratch& scratch) {
    float* d = scratch.nearDistance2.data();
    _mm512_storeu_ps(d + scratch.near, _mm512_set1_ps(kFar));  // the rest of the last vector
    for (std::size_t i = 0; i < scratch.near; ++i) {
      const __m512 own = _mm512_set1_ps(d[i]);
      unsigned nearer = 0;
      for (std::size_t j = 0; j < scratch.near; j += kBlock)
        nearer += static_cast<unsigned>(
            __builtin_popcount(_mm512_cmp_ps_mask(_mm512_loadu_ps(d + j), own, _CMP_LT_OQ)));
      scratch.rank[i] = nearer;
    }
  }
};
#pragma GCC diagnostic pop
#endif

// Gathers every point within `radius` of the box of `block`.
template <class Kernel>
void gatherCandidates(const BlockTree& tree, std::size_t block, float radius, Scratch& scratch) {
  const Box box{tree.levels[0].low(block), tree.levels[0].high(block)};
  const float radius2 = radius * radius;
  scratch.nodes.resize(tree.levels.back().size() / kFan);
  std::iota(scratch.nodes.begin(), scratch.nodes.end(), Index{0});
  for (std::size_t level = tree.levels.size(); level-- > 0;) {
    scratch.below.clear();
    for (const Index node : scratch.nodes)
      Kernel::nearBoxes(tree.levels[level], static_cast<std::size_t>(node) * kFan, box, radius2,
                        scratch.below);
    scratch.nodes.swap(scratch.below);
  }
  scratch.reserve(scratch.nodes.size() * kBlock);
  scratch.candidates = 0;
  for (const Index node : scratch.nodes)
    Kernel::nearPoints(tree, static_cast<std::size_t>(node) * kBlock, box, radius2, scratch);
}

// Of many near points (much denser here than the block's radius allows for) keeps the k nearest.
void thinCrowd(Scratch& scratch, std::size_t k) {
  scratch.crowd.resize(scratch.near);
  for (std::size_t i = 0; i < scratch.near; ++i)
    scratch.crowd[i] = {scratch.nearDistance2[i], scratch.nearId[i]};
  std::nth_element(scratch.crowd.begin(), scratch.crowd.begin() + static_cast<std::ptrdiff_t>(k),
                   scratch.crowd.end());
  scratch.near = k;
  for (std::size_t i = 0; i < k; ++i) {
    scratch.nearDistance2[i] = scratch.crowd[i].first;
    scratch.nearId[i] = scratch.crowd[i].second;
  }
}

// Writes the k nearest of the near points, nearest first, ties by id; returns how far the last is.
// Sorted by counting how many are nearer: k^2 compares, but a vector at a time and without a
// branch, half the time of a sort.
template <class Kernel>
float writeSorted(Scratch& scratch, std::size_t k, Index* ids) {
  if (scratch.near > 3 * k + 16) thinCrowd(scratch, k);
  Kernel::rankNear(scratch);
  std::fill(ids, ids + k, kNone);
  float farthest2 = 0;
  for (std::size_t i = 0; i < scratch.near; ++i) {
    std::size_t slot = scratch.rank[i];
    Index id = scratch.nearId[i];
    for (; slot < k && ids[slot] != kNone; ++slot)  // equally far: by id
      if (ids[slot] > id) std::swap(ids[slot], id);
    if (slot >= k) continue;
    ids[slot] = id;
    farthest2 = std::max(farthest2, scratch.nearDistance2[i]);
  }
  return std::sqrt(farthest2);
}

// All points of blocks [begin, end). The radius starts at what the block before needed and grows
// until every point of the block has k others within it.
template <class Kernel>
void queryBlocks(const BlockTree& tree, std::size_t begin, std::size_t end, Neighborhoods& out) {
  const std::size_t k = out.k;
  const Boxes& boxes = tree.levels[0];
  Scratch scratch;
  float guess = 0;
  for (std::size_t block = begin; block < end; ++block) {
    const float diagonal = glm::length(boxes.high(block) - boxes.low(block));
    const float own = diagonal * 0.5f * std::sqrt(static_cast<float>(k) / kBlock);
    float radius = guess > 0 ? std::min(guess, 2 * own) : own;
    if (!(radius > 0)) radius = std::max(guess, 1e-6f);  // the whole block in one place
    float needed = 0;
    gatherCandidates<Kernel>(tree, block, radius, scratch);
    for (std::size_t p = block * kBlock; p < (block + 1) * kBlock && tree.id[p] != kNone;) {
      Kernel::within(tree, p, radius * radius, scratch);
      if (scratch.near < k) {
        radius *= 1.3f;
        gatherCandidates<Kernel>(tree, block, radius, scratch);
        continue;
      }
      const std::size_t row = static_cast<std::size_t>(tree.id[p]) * k;
      needed = std::max(needed, writeSorted<Kernel>(scratch, k, &out.ids[row]));
      ++p;
    }
    guess = 1.1f * needed;
  }
}

void queryBlocksOnBestPath(const BlockTree& tree, std::size_t begin, std::size_t end,
                           [[maybe_unused]] bool portable, Neighborhoods& out) {
#if defined(__x86_64__)
  if (!portable && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl"))
    return queryBlocks<Avx512Kernel>(tree, begin, end, out);
#endif
  queryBlocks<PlainKernel>(tree, begin, end, out);
}

}  // namespace

Neighborhoods buildNeighborhoods(const std::vector<vec3>& positions, std::size_t k,
                                 Monitor& monitor, bool portable) {
  if (k == 0) throw InvalidInput("the number of neighbours is 0; give 1 or more");
  if (positions.size() <= k)
    throw InvalidInput(fmt::format(
        "{} distinct points are too few for {} neighbours each; give a scan of at least {} points "
        "or a smaller number of neighbours",
        positions.size(), k, k + 1));
  monitor.begin(Stage::Neighbours, positions.size());
  const BlockTree tree = buildTree(positions);
  Neighborhoods out;
  out.k = k;
  out.ids.resize(positions.size() * k);
  const std::size_t chunks = (tree.blocks() + kBlocksPerChunk - 1) / kBlocksPerChunk;
  monitor.workers().run(chunks, [&](std::size_t chunk) {
    const std::size_t begin = chunk * kBlocksPerChunk;
    const std::size_t end = std::min(tree.blocks(), begin + kBlocksPerChunk);
    monitor.advance(std::min(positions.size(), end * kBlock) - begin * kBlock);
    queryBlocksOnBestPath(tree, begin, end, portable, out);
  });
  return out;
}

ReverseNeighborhoods reverseNeighborhoods(const Neighborhoods& neighborhoods,
                                          const Monitor& monitor) {
  constexpr std::size_t kCheckEvery = 8192;  // points
  const std::size_t n = neighborhoods.size();
  ReverseNeighborhoods out;
  out.offset.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (i % kCheckEvery == 0) monitor.checkpoint();
    for (const Index j : neighborhoods.of(i)) ++out.offset[j + 1];
  }
  for (std::size_t i = 0; i < n; ++i) out.offset[i + 1] += out.offset[i];
  out.ids.resize(neighborhoods.ids.size());
  std::vector<std::size_t> next(out.offset.begin(), out.offset.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
    if (i % kCheckEvery == 0) monitor.checkpoint();
    for (const Index j : neighborhoods.of(i)) out.ids[next[j]++] = static_cast<Index>(i);
  }
  return out;
}

std::vector<float> localSpacing(const Neighborhoods& neighborhoods,
                                const std::vector<vec3>& positions) {
  const std::size_t k = neighborhoods.k;
  const float factor =
      static_cast<float>(std::sqrt(std::numbers::pi / (static_cast<double>(k) + 0.5)));
  std::vector<float> spacing(neighborhoods.size());
  for (std::size_t i = 0; i < spacing.size(); ++i)
    spacing[i] = distanceBetween(positions[i], positions[neighborhoods.of(i).back()]) * factor;
  return spacing;
}

double meanSpacing(const Neighborhoods& neighborhoods, const std::vector<vec3>& positions) {
  double sum = 0;
  for (const float s : localSpacing(neighborhoods, positions)) sum += s;
  return neighborhoods.size() == 0 ? 0 : sum / static_cast<double>(neighborhoods.size());
}

}  // namespace dapple
