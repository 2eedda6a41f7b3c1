// By the Wiener-Khinchin theorem: the power spectrum's inverse transform. The swatch is padded with
// zeros to at least one and a half times its size, so that no lag within reach wraps, and divided
// by the same correlation of what counts.
#include "swatch/autocorrelation.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace dapple {
namespace {

constexpr std::size_t kLineGrain = 16;

using Complex = std::complex<float>;

// e^(-2 pi i k / n) for k < n / 2.
std::vector<Complex> unitRoots(std::size_t n) {
  std::vector<Complex> roots(n / 2);
  for (std::size_t k = 0; k < roots.size(); ++k) {
    const double angle = -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    roots[k] = Complex(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
  }
  return roots;
}

// The discrete Fourier transform of n = 2 roots.size() numbers, a power of two, in place (Cooley
// and Tukey 1965).
void transformLine(Complex* line, const std::vector<Complex>& roots) {
  const std::size_t n = 2 * roots.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(line[i], line[j]);
  }
  for (std::size_t half = 1; half < n; half *= 2)
    for (std::size_t start = 0; start < n; start += 2 * half)
      for (std::size_t k = 0; k < half; ++k) {
        const Complex root = roots[k * (n / (2 * half))];
        const Complex b = line[start + k + half];
        // Written out: the library's product looks for infinities.
        const Complex turned(b.real() * root.real() - b.imag() * root.imag(),
                             b.real() * root.imag() + b.imag() * root.real());
        line[start + k + half] = line[start + k] - turned;
        line[start + k] += turned;
      }
}

// A plane of a power of two each way.
struct Plane {
  Plane(std::size_t w, std::size_t h) : width(w), height(h), numbers(w * h) {}

  void transform(Monitor& monitor) {
    const std::vector<Complex> along = unitRoots(width), across = unitRoots(height);
    parallelFor(monitor, height, kLineGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y) transformLine(&numbers[y * width], along);
    });
    parallelFor(monitor, width, kLineGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<Complex> column(height);
      for (std::size_t x = begin; x < end; ++x) {
        for (std::size_t y = 0; y < height; ++y) column[y] = numbers[y * width + x];
        transformLine(column.data(), across);
        for (std::size_t y = 0; y < height; ++y) numbers[y * width + x] = column[y];
      }
    });
  }

  std::size_t width, height;
  std::vector<Complex> numbers;
};

std::size_t paddedSize(int size) {
  std::size_t padded = 4;
  while (padded < static_cast<std::size_t>(size) + static_cast<std::size_t>(size) / 2 + 1)
    padded *= 2;
  return padded;
}

// Colour and relief.
glm::vec4 numbersAt(const Swatch& swatch, std::size_t i) {
  return {swatch.colours()[i], swatch.relief.empty() ? 0 : swatch.relief.front()[i]};
}

glm::vec4 meanNumbers(const Swatch& swatch) {
  glm::dvec4 sum(0);
  double count = 0;
  for (std::size_t i = 0; i < swatch.pixels(); ++i)
    if (swatch.opaque[i]) sum += glm::dvec4(numbersAt(swatch, i)), ++count;
  return glm::vec4(sum / count);
}

// Adds the power spectrum of the plane whose texel i is number(i).
template <class Number>
void addPower(const Swatch& swatch, const Number& number, Plane& power, Monitor& monitor) {
  Plane plane(power.width, power.height);
  for (int y = 0; y < swatch.height; ++y)
    for (int x = 0; x < swatch.width; ++x)
      plane.numbers[static_cast<std::size_t>(y) * plane.width + static_cast<std::size_t>(x)] =
          number(static_cast<std::size_t>(y) * swatch.width + x);
  plane.transform(monitor);
  for (std::size_t i = 0; i < power.numbers.size(); ++i)
    power.numbers[i] += std::norm(plane.numbers[i]);
}

}  // namespace

Autocorrelation autocorrelation(const Swatch& swatch, Monitor& monitor) {
  const glm::vec4 mean = meanNumbers(swatch);
  const auto deviation = [&](std::size_t i) {
    return swatch.opaque[i] ? numbersAt(swatch, i) - mean : glm::vec4(0);
  };
  Plane products(paddedSize(swatch.width), paddedSize(swatch.height));
  // Two channels at a time: what mixes them in the sum of the powers is odd, and only the real part
  // of its transform is read, where odd parts leave nothing.
  addPower(
      swatch, [&](std::size_t i) { return Complex(deviation(i).r, deviation(i).g); }, products,
      monitor);
  addPower(
      swatch, [&](std::size_t i) { return Complex(deviation(i).b, deviation(i).a); }, products,
      monitor);
  Plane pairs(products.width, products.height);
  addPower(
      swatch, [&](std::size_t i) { return Complex(swatch.opaque[i], 0); }, pairs, monitor);
  // A power spectrum is real, so that the transform forwards is the one back but for its sign.
  products.transform(monitor);
  pairs.transform(monitor);
  Autocorrelation out{.reachX = swatch.width / 2, .reachY = swatch.height / 2};
  const auto size = static_cast<float>(products.numbers.size());
  const float variance = products.numbers[0].real() / pairs.numbers[0].real();
  for (int y = -out.reachY; y <= out.reachY; ++y)
    for (int x = -out.reachX; x <= out.reachX; ++x) {
      const std::size_t column = static_cast<std::size_t>(x) & (products.width - 1);
      const std::size_t row = static_cast<std::size_t>(y) & (products.height - 1);
      const std::size_t i = row * products.width + column;
      const bool known = variance > 1e-9f && pairs.numbers[i].real() > 0.5f * size;
      out.values.push_back(known ? products.numbers[i].real() / pairs.numbers[i].real() / variance
                                 : 0);
    }
  out.values[out.values.size() / 2] = 1;
  return out;
}

std::vector<double> radialMean(const Autocorrelation& correlation) {
  const int reach = std::min(correlation.reachX, correlation.reachY);
  std::vector<double> sums(static_cast<std::size_t>(reach) + 1), counts(sums.size());
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      const auto bin = static_cast<std::size_t>(std::lround(std::hypot(x, y)));
      if (bin >= sums.size()) continue;
      sums[bin] += correlation.at(x, y);
      ++counts[bin];
    }
  for (std::size_t bin = 0; bin < sums.size(); ++bin) sums[bin] /= counts[bin];
  return sums;
}

}  // namespace dapple
