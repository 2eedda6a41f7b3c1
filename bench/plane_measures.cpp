#include "plane_measures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "base/simd.h"
#include "swatch/autocorrelation.h"
#include "swatch/swatch_search.h"

namespace dapple::bench {
namespace {

constexpr int kReach = 24;  // of autocorrelations, pixels
constexpr std::size_t kQuantiles = 1024;
constexpr int kDirections = 32;
constexpr float kTwin = 4;  // RMS
constexpr int kSide = 15, kCell = 5, kCells = kSide / kCell, kBounds = 3 * kCells * kCells;
constexpr int kTwinStride = 7;  // pixels between patches whose twins are sought
constexpr int kTwinApart = 8;   // pixels, at least, between a patch and its twin
constexpr float kFar = 1e30f;

double meanOf(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

// RMS over pixels and channels between the squares of `side` pixels from a and from b on.
float patchDistance(const Image& p, ivec2 a, const Image& q, ivec2 b, int side) {
  float squares = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (int c = 0; c < 3; ++c) {
        const float d = 255 * (p.at(a.x + x, a.y + y, c) - q.at(b.x + x, b.y + y, c));
        squares += d * d;
      }
  return std::sqrt(squares / static_cast<float>(3 * side * side));
}

// For patches of `from`, one every `stride` pixels, the distance to the nearest of `to`.
std::vector<float> nearestDistances(const Image& from, const Image& to, ivec2 sideAndStride,
                                    Workers& workers) {
  const int side = sideAndStride.x, stride = sideAndStride.y, half = side / 2;
  const SwatchSearch search(makeSwatch(to, Tileable::No, 1, "picture"), 0, 1);
  const int columns = (from.width - side) / stride + 1, rows = (from.height - side) / stride + 1;
  std::vector<float> distances(static_cast<std::size_t>(columns) * rows);
  workers.run(static_cast<std::size_t>(rows), [&](std::size_t row) {
    std::vector<SearchTerm> terms;
    for (int column = 0; column < columns; ++column) {
      const ivec2 at(column * stride, static_cast<int>(row) * stride);
      terms.clear();
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const vec3 colour(from.at(at.x + x, at.y + y, 0), from.at(at.x + x, at.y + y, 1),
                            from.at(at.x + x, at.y + y, 2));
          terms.push_back({.offset = vec2(x - half, y - half), .colour = colour});
        }
      const SearchResult found = search.search(terms);
      DAPPLE_CHECK(found.found, ==, true);
      // The search compares 7 bits a channel; what it finds is measured in full.
      distances[row * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)] =
          patchDistance(from, at, to, ivec2(found.texel) - half, side);
    }
  });
  return distances;
}

double percentile95(std::vector<float> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * double(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Of two distributions, by their quantiles.
double wasserstein(std::vector<float> a, std::vector<float> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double sum = 0;
  for (std::size_t q = 0; q < kQuantiles; ++q) {
    const double share = (static_cast<double>(q) + 0.5) / kQuantiles;
    sum += std::abs(a[static_cast<std::size_t>(share * static_cast<double>(a.size()))] -
                    b[static_cast<std::size_t>(share * static_cast<double>(b.size()))]);
  }
  return sum / kQuantiles;
}

double slicedDistance(const Image& a, const Image& b) {
  double sum = 0;
  for (std::uint64_t d = 0; d < kDirections; ++d) {
    const float z = 2 * hashUniform(11, d, 0) - 1, turn = hashUniform(11, d, 1);
    const float angle = 2 * std::numbers::pi_v<float> * turn, r = std::sqrt(1 - z * z);
    const vec3 direction(r * std::cos(angle), r * std::sin(angle), z);
    const auto projected = [&](const Image& image) {
      std::vector<float> out;
      for (std::size_t i = 0; i < image.pixels.size(); i += 3)
        out.push_back(255 * (direction.x * image.pixels[i] + direction.y * image.pixels[i + 1] +
                             direction.z * image.pixels[i + 2]));
      return out;
    };
    sum += wasserstein(projected(a), projected(b));
  }
  return sum / kDirections;
}

Image luminance(const Image& image) {
  Image out{image.width, image.height, 1, {}};
  for (std::size_t i = 0; i < image.pixels.size(); i += 3)
    out.pixels.push_back(0.299f * image.pixels[i] + 0.587f * image.pixels[i + 1] +
                         0.114f * image.pixels[i + 2]);
  return out;
}

Image halved(const Image& grey) {
  Image out{grey.width / 2, grey.height / 2, 1, {}};
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out.pixels.push_back(0.25f *
                           (grey.at(2 * x, 2 * y, 0) + grey.at(2 * x + 1, 2 * y, 0) +
                            grey.at(2 * x, 2 * y + 1, 0) + grey.at(2 * x + 1, 2 * y + 1, 0)));
  return out;
}

std::vector<float> gradients(const Image& grey) {
  std::vector<float> out;
  for (int y = 0; y + 1 < grey.height; ++y)
    for (int x = 0; x + 1 < grey.width; ++x)
      out.push_back(255 * std::hypot(grey.at(x + 1, y, 0) - grey.at(x, y, 0),
                                     grey.at(x, y + 1, 0) - grey.at(x, y, 0)));
  return out;
}

double gradientDistance(Image a, Image b) {
  double sum = 0;
  for (int scale = 0; scale < 3; ++scale) {
    sum += wasserstein(gradients(a), gradients(b));
    a = halved(a), b = halved(b);
  }
  return sum / 3;
}

double correlationDistance(const Image& a, const Image& b, Workers& workers) {
  Monitor monitor(workers);
  const Autocorrelation p = autocorrelation(makeSwatch(a, Tileable::No, 1, "sample"), monitor),
                        q = autocorrelation(makeSwatch(b, Tileable::No, 1, "picture"), monitor);
  double squares = 0, count = 0;
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x <= kReach; ++x)
      squares += std::pow(p.at(x, y) - q.at(x, y), 2), ++count;
  return std::sqrt(squares / count);
}

// The mean colours of the cells of every patch, a column for each number. Distances of means are
// never more than those of the patches.
struct PatchMeans {
  explicit PatchMeans(const Image& image)
      : columns(image.width - kSide + 1),
        rows(image.height - kSide + 1),
        count(paddedToLanes(static_cast<std::size_t>(columns) * rows)),
        numbers(count * kBounds, kFar) {
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x)
        for (int k = 0; k < kBounds; ++k) {
          const ivec2 cell((k / 3) % kCells, k / 3 / kCells);
          float sum = 0;
          for (int v = 0; v < kCell; ++v)
            for (int u = 0; u < kCell; ++u)
              sum += image.at(x + kCell * cell.x + u, y + kCell * cell.y + v, k % 3);
          numbers[static_cast<std::size_t>(k) * count + static_cast<std::size_t>(y * columns + x)] =
              255 * sum / (kCell * kCell);
        }
  }

  int columns, rows;
  std::size_t count;
  std::vector<float> numbers;
};

// Mean squared difference of the means of patch `wanted` and each patch, to `out`.
DAPPLE_CLONES void boundsOf(const PatchMeans& means, std::size_t wanted, float* out) {
  for (std::size_t p = 0; p < means.count; p += kLanes) {
    Float8 squares{};
    for (std::size_t k = 0; k < kBounds; ++k) {
      const float* column = means.numbers.data() + k * means.count;
      const Float8 d = *reinterpret_cast<const Float8*>(column + p) - column[wanted];
      squares += d * d;
    }
    *reinterpret_cast<Float8*>(out + p) = squares * (1.f / kBounds);
  }
}

// How far it is from a patch to its nearest twin; (0, 0): none is near enough.
ivec2 twinOf(const Image& image, const PatchMeans& means, ivec2 at, std::vector<float>& bounds) {
  boundsOf(means, static_cast<std::size_t>(at.y * means.columns + at.x), bounds.data());
  float best = kTwin;
  ivec2 twin(0);
  for (int y = 0; y < means.rows; ++y)
    for (int x = 0; x < means.columns; ++x) {
      if (bounds[static_cast<std::size_t>(y * means.columns + x)] >= best * best) continue;
      if (std::max(std::abs(x - at.x), std::abs(y - at.y)) < kTwinApart) continue;
      const float distance = patchDistance(image, at, image, {x, y}, kSide);
      if (distance < best) best = distance, twin = ivec2(x, y) - at;
    }
  return twin;
}

double periodShare(const Image& picture, Workers& workers) {
  const PatchMeans means(picture);
  const int columns = (means.columns - 1) / kTwinStride + 1;
  const int rows = (means.rows - 1) / kTwinStride + 1;
  std::vector<ivec2> twins(static_cast<std::size_t>(columns) * rows);
  workers.run(static_cast<std::size_t>(rows), [&](std::size_t row) {
    std::vector<float> bounds(means.count);
    for (int column = 0; column < columns; ++column)
      twins[row * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)] =
          twinOf(picture, means, ivec2(column, row) * kTwinStride, bounds);
  });
  std::map<std::pair<int, int>, std::size_t> counts;
  for (const ivec2 d : twins) {
    if (d == ivec2(0)) continue;
    const int sign = d.y < 0 || (d.y == 0 && d.x < 0) ? -1 : 1;
    ++counts[{sign * d.x, sign * d.y}];
  }
  std::size_t first = 0, second = 0;
  for (const auto& [displacement, count] : counts)
    if (count > first)
      second = first, first = count;
    else
      second = std::max(second, count);
  return static_cast<double>(first + second) / static_cast<double>(twins.size());
}

}  // namespace

PlaneMeasures measurePlane(const Image& sample, const Image& picture, Workers& workers) {
  DAPPLE_CHECK(sample.channels, ==, 3);
  DAPPLE_CHECK(picture.channels, ==, 3);
  const std::vector<float> small = nearestDistances(picture, sample, {7, 5}, workers);
  const Image sampleGrey = luminance(sample), pictureGrey = luminance(picture);
  return {.coh7 = meanOf(small),
          .coh15 = meanOf(nearestDistances(picture, sample, {15, 7}, workers)),
          .seam = percentile95(small),
          .com7 = meanOf(nearestDistances(sample, picture, {7, 3}, workers)),
          .com15 = meanOf(nearestDistances(sample, picture, {15, 7}, workers)),
          .swd = slicedDistance(sample, picture),
          .grad = gradientDistance(sampleGrey, pictureGrey),
          .acf = correlationDistance(sampleGrey, pictureGrey, workers),
          .per = periodShare(picture, workers)};
}

}  // namespace dapple::bench
