// Wang, Bovik, Sheikh, Simoncelli: Image Quality Assessment: From Error Visibility to Structural
// Similarity, 2004. Departures:
// - Square windows of 8 x 8 at every 4th pixel: as their first version, and quick.
// - Windows that are flat and equal in both pictures (the background) are left out of the mean;
//   in a picture of a small object they would hide any mistake.
// - Not luminance alone but the worst of it and two colour differences: two hues of the same
//   luminance, swapped, must not pass.
#include "app/render/image_compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr int kWindow = 8, kStep = 4;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;  // for values of 0..1
constexpr double kFlat = 1e-6;                          // variance, and difference of means squared

using Plane = std::vector<float>;

// Luminance, and how far blue and red lie from it (Rec. 601).
std::array<Plane, 3> planesOf(const Image& image) {
  std::array<Plane, 3> planes;
  for (Plane& plane : planes) plane.resize(static_cast<std::size_t>(image.width) * image.height);
  const bool colour = image.channels >= 3;
  for (std::size_t i = 0; i < planes[0].size(); ++i) {
    const float* pixel = image.pixels.data() + i * image.channels;
    const float r = pixel[0], g = colour ? pixel[1] : r, b = colour ? pixel[2] : r;
    const float luminance = 0.299f * r + 0.587f * g + 0.114f * b;
    planes[0][i] = luminance;
    planes[1][i] = 0.5f + 0.564f * (b - luminance);
    planes[2][i] = 0.5f + 0.713f * (r - luminance);
  }
  return planes;
}

struct Moments {
  double meanA = 0, meanB = 0, varianceA = 0, varianceB = 0, covariance = 0;
};

Moments momentsOf(const Plane& a, const Plane& b, int width, std::size_t corner) {
  double sumA = 0, sumB = 0, sumAA = 0, sumBB = 0, sumAB = 0;
  for (int y = 0; y < kWindow; ++y)
    for (int x = 0; x < kWindow; ++x) {
      const std::size_t i = corner + static_cast<std::size_t>(y) * width + x;
      sumA += a[i];
      sumB += b[i];
      sumAA += static_cast<double>(a[i]) * a[i];
      sumBB += static_cast<double>(b[i]) * b[i];
      sumAB += static_cast<double>(a[i]) * b[i];
    }
  constexpr double n = kWindow * kWindow;
  const double meanA = sumA / n, meanB = sumB / n;
  return {meanA, meanB, std::max(sumAA / n - meanA * meanA, 0.0),
          std::max(sumBB / n - meanB * meanB, 0.0), sumAB / n - meanA * meanB};
}

double similarity(const Moments& m) {
  return (2 * m.meanA * m.meanB + kC1) * (2 * m.covariance + kC2) /
         ((m.meanA * m.meanA + m.meanB * m.meanB + kC1) * (m.varianceA + m.varianceB + kC2));
}

bool flatAndEqual(const Moments& m) {
  const double difference = m.meanA - m.meanB;
  return m.varianceA < kFlat && m.varianceB < kFlat && difference * difference < kFlat;
}

}  // namespace

double structuralSimilarity(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height || a.width < kWindow || a.height < kWindow)
    throw InvalidInput(fmt::format(
        "Pictures of {} x {} and {} x {} pixels cannot be compared; both must have the same size, "
        "at least {} x {}.",
        a.width, a.height, b.width, b.height, kWindow, kWindow));
  const std::array<Plane, 3> planesA = planesOf(a), planesB = planesOf(b);

  std::array<double, 3> sums{};
  std::size_t windows = 0;
  for (int y = 0; y + kWindow <= a.height; y += kStep)
    for (int x = 0; x + kWindow <= a.width; x += kStep) {
      const std::size_t corner = static_cast<std::size_t>(y) * a.width + x;
      std::array<Moments, 3> moments;
      for (int c = 0; c < 3; ++c) moments[c] = momentsOf(planesA[c], planesB[c], a.width, corner);
      if (std::all_of(moments.begin(), moments.end(), flatAndEqual)) continue;
      for (int c = 0; c < 3; ++c) sums[c] += similarity(moments[c]);
      ++windows;
    }
  if (windows == 0) return 1;
  return *std::min_element(sums.begin(), sums.end()) / static_cast<double>(windows);
}

double structuralSimilarityError(const Image& a, const Image& b) {
  return 1 - structuralSimilarity(a, b);
}

}  // namespace dapple
