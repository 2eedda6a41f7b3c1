#include "swatch/swatch_relief.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "swatch/gaussian_blur.h"

namespace dapple {
namespace {

constexpr double kLeastContrast = 0.05;  // of colours: where they are nearly one, height decides
constexpr double kFlat = 1e-6;           // deviation of heights that say nothing

struct Spread {
  double mean = 0, deviation = 0;
};

// Over what may be used.
Spread spreadOf(const Swatch& swatch, std::span<const float> values) {
  const auto counts = [&](std::size_t i) { return swatch.opaque[i] && std::isfinite(values[i]); };
  double sum = 0, squares = 0, count = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (counts(i)) sum += static_cast<double>(values[i]), ++count;
  if (count == 0) return {};
  const double mean = sum / count;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (counts(i)) squares += std::pow(static_cast<double>(values[i]) - mean, 2);
  return {mean, std::sqrt(squares / count)};
}

}  // namespace

Swatch withRelief(const Swatch& swatch, std::span<const float> height, double weight) {
  DAPPLE_CHECK(height.size(), ==, swatch.pixels());
  Swatch out = swatch;
  out.relief.clear();
  const Spread spread = spreadOf(swatch, height);
  if (weight <= 0 || spread.deviation < kFlat) return out;
  const double contrast = std::max(swatchContrast(swatch), kLeastContrast);
  const double factor = std::sqrt(3 * weight) * contrast / spread.deviation;
  std::vector<float> relief;
  for (const float h : height) {
    const double apart = std::isfinite(h) ? static_cast<double>(h) - spread.mean : 0;
    relief.push_back(static_cast<float>(std::clamp(0.5 + factor * apart, 0.0, 1.0)));
  }
  setRelief(out, std::move(relief));
  return out;
}

void setRelief(Swatch& swatch, std::vector<float> relief) {
  DAPPLE_CHECK(relief.size(), ==, swatch.pixels());
  swatch.relief.assign(1, std::move(relief));
  Swatch view = reliefAsColours(swatch);
  if (swatch.hasHoles) {
    fillHoles(swatch, view.stack[0]);
    for (std::size_t i = 0; i < swatch.pixels(); ++i) swatch.relief[0][i] = view.stack[0][i].x;
  }
  for (std::size_t level = 1; level < swatch.stack.size(); ++level) {
    std::vector<float>& blurred = swatch.relief.emplace_back();
    for (const vec3& value : blurSwatch(view, std::ldexp(0.5, static_cast<int>(level))))
      blurred.push_back(value.x);
  }
}

Swatch reliefAsColours(const Swatch& swatch) {
  Swatch view{.width = swatch.width,
              .height = swatch.height,
              .tileable = swatch.tileable,
              .hasHoles = swatch.hasHoles,
              .opaque = swatch.opaque};
  view.stack.emplace_back(swatch.relief.front().begin(), swatch.relief.front().end());
  return view;
}

}  // namespace dapple
