#include "synthesis/score_patches.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/errors.h"
#include "base/hash_rng.h"

namespace dapple {
namespace {

// Places lie so many steps apart (the windows are blurred by half a step) as far as the bounds
// allow. The study had 6000 of them at every scale, more than a small swatch needs; in a large one
// the score finds what lies between the places through windows near by.
constexpr double kPlaceSteps = 1.25;
constexpr std::size_t kFewestPlaces = 768, kMostPlaces = 16384;
constexpr std::size_t kFreeTurns = 16, kLimitedTurns = 4;
constexpr std::size_t kParts = 48;
constexpr std::size_t kTrainingWindows = 6000;
constexpr std::size_t kBlock = 64;  // windows that are compared, or passed over, together
constexpr std::size_t kTile = 4;    // blocks that stay in the nearest cache for all codes
constexpr int kHead = 8;            // components that decide whether the others are looked at
constexpr std::size_t kHeadSize = (kHead + 1) * kBlock;
constexpr std::size_t kTailSize = (kPatchNumbers - kHead + 1) * kBlock;
constexpr float kNoWindow = 1e30f;

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Z-order of a place on a 256 x 256 grid over the swatch, so that parts are compact.
std::uint32_t zOrder(vec2 unit) {
  std::uint32_t key = 0;
  const auto x = static_cast<std::uint32_t>(unit.x * 255),
             y = static_cast<std::uint32_t>(unit.y * 255);
  for (int bit = 0; bit < 8; ++bit)
    key |= (x >> bit & 1u) << (2 * bit) | (y >> bit & 1u) << (2 * bit + 1);
  return key;
}

void flatten(const Window& window, float* numbers) {
  for (int i = 0; i < kWindowNodes; ++i)
    for (int c = 0; c < 3; ++c) numbers[3 * i + c] = window.node[i][c];
}

// The nearest window of a part so far.
struct PartBest {
  float key = kNoWindow;  // |code|^2 / 2 - query . code: the squared distance but for a constant
  std::uint32_t window = 0;
};

// A code that is searched for.
struct Query {
  PatchCode code{};
  float tailHalf = 0;  // half the sum of squares of its tail
  std::array<PartBest, kParts> parts;
  std::array<float, kPatchStarts> least;  // keys of the nearest parts, ascending

  explicit Query(const PatchCode& c) : code(c) {
    for (int d = kHead; d < kPatchNumbers; ++d) tailHalf += 0.5f * code[d] * code[d];
    least.fill(kNoWindow);
  }
};

using Lanes = float __attribute__((vector_size(64)));
constexpr std::size_t kLanes = sizeof(Lanes) / sizeof(float), kRows = kBlock / kLanes;

[[gnu::always_inline]] inline float leastOf(const Lanes* rows) {
  Lanes least = rows[0];
  for (std::size_t r = 1; r < kRows; ++r) least = rows[r] < least ? rows[r] : least;
  float values[kLanes];
  std::memcpy(values, &least, sizeof(values));
  for (std::size_t half = kLanes / 2; half > 0; half /= 2)
    for (std::size_t l = 0; l < half; ++l) values[l] = std::min(values[l], values[l + half]);
  return values[0];
}

// Subtracts `count` products from the keys of a block.
[[gnu::always_inline]] inline void subtractProducts(const float* numbers, const float* factors,
                                                    int count, Lanes* keys) {
  for (int d = 0; d < count; ++d)
    for (std::size_t r = 0; r < kRows; ++r) {
      Lanes value;
      std::memcpy(&value, numbers + d * kBlock + r * kLanes, sizeof(value));
      keys[r] -= value * factors[d];
    }
}

// Blocks that follow each other.
struct Tile {
  const float *head, *tail;
  std::size_t blocks;
  std::uint32_t firstWindow;
};

// A block's windows are nearer than `least` only if they are by their heads alone, were their tails
// the query's own: most blocks are passed over. Whether is decided for a whole block, and each
// window adds up its own products in order, so every vector width gives the same bits.
[[gnu::always_inline]] inline void searchTile(const Tile& tile, const Query& query,
                                              PartBest& best) {
  float least = std::min(best.key, query.least.back());
  for (std::size_t b = 0; b < tile.blocks; ++b) {
    const float *head = tile.head + b * kHeadSize, *tail = tile.tail + b * kTailSize;
    Lanes keys[kRows];
    std::memcpy(keys, head, sizeof(keys));
    subtractProducts(head + kBlock, query.code.data(), kHead, keys);
    if (!(leastOf(keys) - query.tailHalf < least)) continue;
    Lanes more[kRows];
    std::memcpy(more, tail, sizeof(more));
    for (std::size_t r = 0; r < kRows; ++r) keys[r] += more[r];
    subtractProducts(tail + kBlock, query.code.data() + kHead, kPatchNumbers - kHead, keys);
    const float nearest = leastOf(keys);
    if (!(nearest < least)) continue;
    float values[kBlock];
    std::memcpy(values, keys, sizeof(values));
    std::uint32_t w = 0;
    while (values[w] != nearest) ++w;
    best = {nearest, tile.firstWindow + static_cast<std::uint32_t>(b * kBlock) + w};
    least = nearest;
  }
}

using SearchTile = void (*)(const Tile&, const Query&, PartBest&);

void searchTileBase(const Tile& tile, const Query& query, PartBest& best) {
  searchTile(tile, query, best);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void searchTileAvx2(const Tile& tile, const Query& query,
                                                    PartBest& best) {
  searchTile(tile, query, best);
}

__attribute__((target("avx512f"))) void searchTileAvx512(const Tile& tile, const Query& query,
                                                         PartBest& best) {
  searchTile(tile, query, best);
}
#endif

SearchTile searchTileFor(SearchPath path) {
  if (path == SearchPath::Portable) return searchTileBase;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return searchTileAvx512;
  if (__builtin_cpu_supports("avx2")) return searchTileAvx2;
#endif
  return searchTileBase;
}

std::size_t roundedUp(std::size_t count, std::size_t multiple) {
  return (count + multiple - 1) / multiple * multiple;
}

}  // namespace

// The R2 sequence (Roberts 2018) covers the image evenly at any length.
PatchGrid::PatchGrid(const ScoreImage& image, TurnLimit limit, std::uint64_t seed)
    : image_(image),
      limit_(limit),
      turns_(limit.angle < std::numbers::pi_v<float> ? kLimitedTurns : kFreeTurns) {
  const float w = static_cast<float>(image_.width()), h = static_cast<float>(image_.height());
  // Where no window may cross the border, none has its centre near it.
  const float rim = image_.wraps() ? 0.0f : (kWindowReach - 1) * image_.step() + 0.5f;
  const double area = static_cast<double>(w - 2 * rim) * (h - 2 * rim);
  const double wanted = area / std::pow(kPlaceSteps * image_.step(), 2);
  const auto count = static_cast<std::size_t>(
      std::clamp(wanted, static_cast<double>(kFewestPlaces), static_cast<double>(kMostPlaces)));
  std::vector<vec2> unit(roundedUp(count, kBlock / turns_));
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const double k = static_cast<double>(i);
    unit[i] = {std::fmod(0.5 + k * 0.7548776662466927, 1.0),
               std::fmod(0.5 + k * 0.5698402909980532, 1.0)};
  }
  std::stable_sort(unit.begin(), unit.end(),
                   [](const vec2& a, const vec2& b) { return zOrder(a) < zOrder(b); });
  for (std::size_t i = 0; i < unit.size(); ++i) {
    places_.push_back(rim + unit[i] * vec2(w - 2 * rim, h - 2 * rim));
    firstTurns_.push_back(hashUniform(seed, i, 71));
  }
}

Placement PatchGrid::placement(std::size_t window) const {
  const std::size_t place = window / turns_;
  const float turn = firstTurns_[place] + static_cast<float>(window % turns_);
  const float span = 2 * std::min(limit_.angle, std::numbers::pi_v<float>);
  return turnedPlacement(places_[place], turn / static_cast<float>(turns_) * span - 0.5f * span);
}

PatchCoder::PatchCoder(const PatchGrid& grid, Monitor& monitor) {
  monitor.checkpoint();
  const ScoreImage& image = grid.image();
  std::vector<std::size_t> windows;
  for (std::size_t i = 0; i < grid.windows(); ++i)
    if (image.holds(grid.placement(i))) windows.push_back(i);
  DAPPLE_CHECK(windows.size(), >, std::size_t{0});
  const std::size_t used = std::min(windows.size(), kTrainingWindows);
  RowMatrix data(used, kWindowNumbers);
  for (std::size_t i = 0; i < used; ++i)
    flatten(image.read(grid.placement(windows[i * windows.size() / used])), data.row(i).data());
  const Eigen::RowVectorXf mean = data.colwise().mean();
  data.rowwise() -= mean;
  monitor.checkpoint();
  Eigen::MatrixXf covariance = Eigen::MatrixXf::Zero(kWindowNumbers, kWindowNumbers);
  covariance.selfadjointView<Eigen::Lower>().rankUpdate(data.transpose());
  monitor.checkpoint();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(covariance);
  components_.resize(kWindowNumbers * kPatchNumbers);
  // The largest first, for a code's head to tell the most.
  Eigen::Map<RowMatrix>(components_.data(), kWindowNumbers, kPatchNumbers) =
      solver.eigenvectors().rightCols(kPatchNumbers).rowwise().reverse();
  Eigen::Map<Eigen::RowVectorXf>(mean_.data(), kWindowNumbers) = mean;
}

PatchCode PatchCoder::encode(const Window& window) const {
  std::array<float, kWindowNumbers> numbers;
  flatten(window, numbers.data());
  PatchCode code{};
  for (int i = 0; i < kWindowNumbers; ++i) {
    const float value = numbers[i] - mean_[i];
    for (int d = 0; d < kPatchNumbers; ++d) code[d] += value * components_[i * kPatchNumbers + d];
  }
  return code;
}

void PatchCoder::encodeRows(std::size_t rows, std::span<float> numbers,
                            std::span<float> codes) const {
  DAPPLE_CHECK(numbers.size(), ==, rows * kWindowNumbers);
  DAPPLE_CHECK(codes.size(), ==, rows * kPatchNumbers);
  const auto count = static_cast<Eigen::Index>(rows);
  Eigen::Map<RowMatrix> data(numbers.data(), count, kWindowNumbers);
  data.rowwise() -= Eigen::Map<const Eigen::RowVectorXf>(mean_.data(), kWindowNumbers);
  Eigen::Map<RowMatrix>(codes.data(), count, kPatchNumbers).noalias() =
      data * Eigen::Map<const RowMatrix>(components_.data(), kWindowNumbers, kPatchNumbers);
}

ScorePatches::ScorePatches(const PatchGrid& grid, const PatchCoder& coder, Monitor& monitor)
    : grid_(grid),
      blocks_(grid.windows() / kBlock),
      heads_(blocks_ * kHeadSize),
      tails_(blocks_ * kTailSize) {
  parallelFor(monitor, blocks_, kTile, [&](std::size_t begin, std::size_t end) {
    std::vector<float> numbers(kBlock * kWindowNumbers), codes(kBlock * kPatchNumbers);
    for (std::size_t b = begin; b < end; ++b) {
      float *head = heads_.data() + b * kHeadSize, *tail = tails_.data() + b * kTailSize;
      for (std::size_t i = 0; i < kBlock; ++i) {
        const Placement placement = grid.placement(b * kBlock + i);
        head[i] = grid.image().holds(placement) ? 0 : kNoWindow;
        flatten(grid.image().read(placement), numbers.data() + i * kWindowNumbers);
      }
      coder.encodeRows(kBlock, numbers, codes);
      for (std::size_t i = 0; i < kBlock; ++i)
        for (std::size_t d = 0; d < kPatchNumbers; ++d) {
          const float value = codes[i * kPatchNumbers + d];
          float* half = d < kHead ? head : tail;
          half[i] += 0.5f * value * value;
          half[(d < kHead ? d + 1 : d + 1 - kHead) * kBlock + i] = value;
        }
    }
  });
}

std::vector<PatchStarts> ScorePatches::search(std::span<const PatchCode> codes, Monitor& monitor,
                                              SearchPath path) const {
  const SearchTile searchTileOn = searchTileFor(path);
  std::vector<Query> queries(codes.begin(), codes.end());
  for (std::size_t part = 0; part < kParts; ++part) {
    monitor.checkpoint();
    const std::size_t end = (part + 1) * blocks_ / kParts;
    for (std::size_t b = part * blocks_ / kParts; b < end; b += kTile) {
      const Tile tile{heads_.data() + b * kHeadSize, tails_.data() + b * kTailSize,
                      std::min(kTile, end - b), static_cast<std::uint32_t>(b * kBlock)};
      for (Query& query : queries) searchTileOn(tile, query, query.parts[part]);
    }
    for (Query& query : queries) {
      float key = query.parts[part].key;
      for (float& least : query.least)
        if (key < least) std::swap(key, least);
    }
  }

  std::vector<PatchStarts> starts(codes.size());
  for (std::size_t q = 0; q < codes.size(); ++q) {
    auto& parts = queries[q].parts;
    std::partial_sort(parts.begin(), parts.begin() + kPatchStarts, parts.end(),
                      [](const PartBest& a, const PartBest& b) {
                        return a.key != b.key ? a.key < b.key : a.window < b.window;
                      });
    // A part may have no window at all (holes); the best one then stands in for it.
    for (int s = 0; s < kPatchStarts; ++s)
      starts[q][s] = grid_.placement(parts[parts[s].key < kNoWindow / 2 ? s : 0].window);
  }
  return starts;
}

}  // namespace dapple
