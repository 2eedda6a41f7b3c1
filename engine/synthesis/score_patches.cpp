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

// The study had 6000: on a 256 x 256 swatch they lie 3.3 pixels apart, and one perfect window in
// thirty was not found.
constexpr std::size_t kPlaces = 12000;
constexpr std::size_t kTurns = 16;
constexpr std::size_t kParts = 48;
constexpr std::size_t kTrainingWindows = 6000;
constexpr std::size_t kGrain = 32;      // places encoded together
constexpr std::size_t kQueryBlock = 8;  // codes that share one pass over the places
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

// The nearest window of every part, for a block of codes.
struct PartBest {
  float key = kNoWindow;  // |code|^2 / 2 - query . code
  std::uint32_t window = 0;
};
using PartBests = std::array<PartBest, kParts>;

struct SearchTable {
  const float* codes;
  const float* halfNorms;
  std::size_t places;
};

// Each lane is one turn and adds up its own products in order, so every vector width gives the
// same bits.
template <class Lanes, class Ids>
[[gnu::always_inline]] inline void searchPart(const SearchTable& table, std::size_t part,
                                              const PatchCode* queries, PartBests* bests) {
  constexpr std::size_t kWidth = sizeof(Lanes) / sizeof(float);
  const std::size_t begin = part * table.places / kParts, end = (part + 1) * table.places / kParts;
  for (std::size_t lane = 0; lane < kTurns; lane += kWidth) {
    Lanes best[kQueryBlock];
    Ids where[kQueryBlock];
    for (std::size_t q = 0; q < kQueryBlock; ++q) {
      best[q] = Lanes{} + kNoWindow;
      where[q] = Ids{};
    }
    for (std::size_t place = begin; place < end; ++place) {
      const float* codes = table.codes + place * kPatchNumbers * kTurns + lane;
      Lanes key[kQueryBlock], code;
      std::memcpy(&code, table.halfNorms + place * kTurns + lane, sizeof(Lanes));
      for (std::size_t q = 0; q < kQueryBlock; ++q) key[q] = code;
      for (int d = 0; d < kPatchNumbers; ++d) {
        std::memcpy(&code, codes + d * kTurns, sizeof(Lanes));
        for (std::size_t q = 0; q < kQueryBlock; ++q) key[q] -= code * queries[q][d];
      }
      for (std::size_t q = 0; q < kQueryBlock; ++q) {
        const Ids nearer = key[q] < best[q];
        best[q] = nearer ? key[q] : best[q];
        where[q] = nearer ? Ids{} + static_cast<std::int32_t>(place) : where[q];
      }
    }
    for (std::size_t q = 0; q < kQueryBlock; ++q) {
      PartBest& least = bests[q][part];
      for (std::size_t l = 0; l < kWidth; ++l) {
        const auto window = static_cast<std::uint32_t>(where[q][l] * kTurns + lane + l);
        if (best[q][l] < least.key || (best[q][l] == least.key && window < least.window))
          least = {best[q][l], window};
      }
    }
  }
}

using Int4 = std::int32_t __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

using Float16 = float __attribute__((vector_size(64)));
using Int16 = std::int32_t __attribute__((vector_size(64)));
using SearchPart = void (*)(const SearchTable&, std::size_t, const PatchCode*, PartBests*);

void searchPartBase(const SearchTable& table, std::size_t part, const PatchCode* queries,
                    PartBests* bests) {
  searchPart<Float4, Int4>(table, part, queries, bests);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void searchPartAvx2(const SearchTable& table, std::size_t part,
                                                    const PatchCode* queries, PartBests* bests) {
  searchPart<Float8, Int8>(table, part, queries, bests);
}

__attribute__((target("avx512f"))) void searchPartAvx512(const SearchTable& table, std::size_t part,
                                                         const PatchCode* queries,
                                                         PartBests* bests) {
  searchPart<Float16, Int16>(table, part, queries, bests);
}
#endif

SearchPart searchPartFor(SearchPath path) {
  if (path == SearchPath::Portable) return searchPartBase;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return searchPartAvx512;
  if (__builtin_cpu_supports("avx2")) return searchPartAvx2;
#endif
  return searchPartBase;
}

}  // namespace

ScorePatches::ScorePatches(const ScoreImage& image, TurnLimit limit, std::uint64_t seed,
                           Monitor& monitor)
    : image_(image), limit_(limit) {
  choosePlaces(seed);
  findComponents(monitor);
  encodePlaces(monitor);
}

Placement ScorePatches::placementOf(std::size_t place, std::size_t turn) const {
  const float span = 2 * std::min(limit_.angle, std::numbers::pi_v<float>);
  const float angle = (firstTurns_[place] + static_cast<float>(turn)) / kTurns * span - 0.5f * span;
  return turnedPlacement(places_[place], angle);
}

// The R2 sequence (Roberts 2018) covers the image evenly at any length.
void ScorePatches::choosePlaces(std::uint64_t seed) {
  const float w = static_cast<float>(image_.width()), h = static_cast<float>(image_.height());
  // Where no window may cross the border, none has its centre near it.
  const float rim = image_.wraps() ? 0.0f : (kWindowReach - 1) * image_.step() + 0.5f;
  const double area = static_cast<double>(w - 2 * rim) * (h - 2 * rim);
  const auto count = static_cast<std::size_t>(
      std::clamp(area, static_cast<double>(kParts), static_cast<double>(kPlaces)));
  std::vector<vec2> unit(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double k = static_cast<double>(i);
    unit[i] = {std::fmod(0.5 + k * 0.7548776662466927, 1.0),
               std::fmod(0.5 + k * 0.5698402909980532, 1.0)};
  }
  std::stable_sort(unit.begin(), unit.end(),
                   [](const vec2& a, const vec2& b) { return zOrder(a) < zOrder(b); });
  for (std::size_t i = 0; i < count; ++i) {
    places_.push_back(rim + unit[i] * vec2(w - 2 * rim, h - 2 * rim));
    firstTurns_.push_back(hashUniform(seed, i, 71));
  }
}

void ScorePatches::findComponents(Monitor& monitor) {
  monitor.checkpoint();
  std::vector<std::size_t> windows;
  for (std::size_t i = 0; i < places_.size() * kTurns; ++i)
    if (image_.holds(placementOf(i / kTurns, i % kTurns))) windows.push_back(i);
  DAPPLE_CHECK(windows.size(), >, std::size_t{0});
  const std::size_t used = std::min(windows.size(), kTrainingWindows);
  RowMatrix data(used, kWindowNumbers);
  for (std::size_t i = 0; i < used; ++i) {
    const std::size_t pick = windows[i * windows.size() / used];
    flatten(image_.read(placementOf(pick / kTurns, pick % kTurns)), data.row(i).data());
  }
  const Eigen::RowVectorXf mean = data.colwise().mean();
  data.rowwise() -= mean;
  monitor.checkpoint();
  Eigen::MatrixXf covariance = Eigen::MatrixXf::Zero(kWindowNumbers, kWindowNumbers);
  covariance.selfadjointView<Eigen::Lower>().rankUpdate(data.transpose());
  monitor.checkpoint();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(covariance);
  components_.resize(kWindowNumbers * kPatchNumbers);
  Eigen::Map<RowMatrix>(components_.data(), kWindowNumbers, kPatchNumbers) =
      solver.eigenvectors().rightCols(kPatchNumbers);
  Eigen::Map<Eigen::RowVectorXf>(mean_.data(), kWindowNumbers) = mean;
}

void ScorePatches::encodePlaces(Monitor& monitor) {
  const std::size_t places = places_.size();
  codes_.resize(places * kPatchNumbers * kTurns);
  halfNorms_.assign(places * kTurns, kNoWindow);
  const Eigen::Map<const RowMatrix> components(components_.data(), kWindowNumbers, kPatchNumbers);
  const Eigen::Map<const Eigen::RowVectorXf> mean(mean_.data(), kWindowNumbers);
  parallelFor(monitor, places, kGrain, [&](std::size_t begin, std::size_t end) {
    const std::size_t windows = (end - begin) * kTurns;
    RowMatrix data(windows, kWindowNumbers);
    for (std::size_t i = 0; i < windows; ++i) {
      const Placement placement = placementOf(begin + i / kTurns, i % kTurns);
      if (image_.holds(placement)) halfNorms_[begin * kTurns + i] = 0;
      flatten(image_.read(placement), data.row(i).data());
    }
    data.rowwise() -= mean;
    const RowMatrix codes = data * components;
    for (std::size_t i = 0; i < windows; ++i) {
      halfNorms_[begin * kTurns + i] += 0.5f * codes.row(i).squaredNorm();
      float* turns = codes_.data() + (begin + i / kTurns) * kPatchNumbers * kTurns + i % kTurns;
      for (int d = 0; d < kPatchNumbers; ++d) turns[d * kTurns] = codes(i, d);
    }
  });
}

PatchCode ScorePatches::encode(const Window& window) const {
  Numbers numbers;
  flatten(window, numbers.data());
  PatchCode code{};
  for (int i = 0; i < kWindowNumbers; ++i) {
    const float value = numbers[i] - mean_[i];
    for (int d = 0; d < kPatchNumbers; ++d) code[d] += value * components_[i * kPatchNumbers + d];
  }
  return code;
}

std::vector<PatchStarts> ScorePatches::search(std::span<const PatchCode> codes,
                                              SearchPath path) const {
  const SearchTable table{codes_.data(), halfNorms_.data(), places_.size()};
  const SearchPart searchPartOn = searchPartFor(path);
  const std::size_t blocks = (codes.size() + kQueryBlock - 1) / kQueryBlock;
  std::vector<PatchCode> queries(codes.begin(), codes.end());
  queries.resize(blocks * kQueryBlock, PatchCode{});
  std::vector<PartBests> bests(queries.size());
  for (std::size_t part = 0; part < kParts; ++part)  // a part stays in the cache for all codes
    for (std::size_t first = 0; first < queries.size(); first += kQueryBlock)
      searchPartOn(table, part, queries.data() + first, bests.data() + first);

  std::vector<PatchStarts> starts(codes.size());
  for (std::size_t q = 0; q < codes.size(); ++q) {
    std::partial_sort(bests[q].begin(), bests[q].begin() + kPatchStarts, bests[q].end(),
                      [](const PartBest& a, const PartBest& b) {
                        return a.key != b.key ? a.key < b.key : a.window < b.window;
                      });
    for (int s = 0; s < kPatchStarts; ++s) {
      // A part may have no window at all (holes); the best one then stands in for it.
      const PartBest& best = bests[q][s].key < kNoWindow / 2 ? bests[q][s] : bests[q][0];
      starts[q][s] = placementOf(best.window / kTurns, best.window % kTurns);
    }
  }
  return starts;
}

}  // namespace dapple
