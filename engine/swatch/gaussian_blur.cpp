#include "swatch/gaussian_blur.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr double kReach = 3.5;  // of the kernel, in sigmas: 5e-4 of its weight is beyond

// Weights for -radius..radius, sum 1.
std::vector<float> gaussianKernel(double sigma) {
  const int radius = std::max(1, static_cast<int>(std::ceil(kReach * sigma)));
  std::vector<double> weights;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    weights.push_back(std::exp(-0.5 * (i / sigma) * (i / sigma)));
    sum += weights.back();
  }
  std::vector<float> kernel;
  for (double w : weights) kernel.push_back(static_cast<float>(w / sum));
  return kernel;
}

int wrapInto(int i, int n) {
  const int r = i % n;
  return r < 0 ? r + n : r;
}

// Rows of `stride` floats convolved along the column direction: out row y = sum k[j] in row y + j.
// Called for rows of texels (vertical pass) and, on a padded line, for single texels (horizontal).
struct Lines {
  std::size_t stride;
  int count;
  bool wraps;
};

void convolveLines(const std::vector<float>& in, const Lines& lines,
                   const std::vector<float>& kernel, std::vector<float>& out) {
  const int radius = static_cast<int>(kernel.size() / 2);
  std::fill(out.begin(), out.end(), 0.0f);
  for (int y = 0; y < lines.count; ++y) {
    float* target = out.data() + y * lines.stride;
    for (int j = -radius; j <= radius; ++j) {
      int from = y + j;
      if (lines.wraps) from = wrapInto(from, lines.count);
      if (from < 0 || from >= lines.count) continue;
      const float* source = in.data() + from * lines.stride;
      const float weight = kernel[j + radius];
      for (std::size_t i = 0; i < lines.stride; ++i) target[i] += weight * source[i];
    }
  }
}

// w x h texels of four floats, to h x w.
std::vector<float> transposed(const std::vector<float>& in, int w, int h) {
  std::vector<float> out(in.size());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (int c = 0; c < 4; ++c)
        out[(static_cast<std::size_t>(x) * h + y) * 4 + c] =
            in[(static_cast<std::size_t>(y) * w + x) * 4 + c];
  return out;
}

// For every texel the row of the nearest opaque texel of its column, or -1.
std::vector<int> nearestInColumn(const Swatch& swatch) {
  const int w = swatch.width, h = swatch.height;
  std::vector<int> row(swatch.pixels(), -1);
  for (int x = 0; x < w; ++x) {
    int last = -1;
    for (int y = 0; y < h; ++y) {
      if (swatch.opaque[static_cast<std::size_t>(y) * w + x]) last = y;
      row[static_cast<std::size_t>(y) * w + x] = last;
    }
    last = -1;
    for (int y = h - 1; y >= 0; --y) {
      int& nearest = row[static_cast<std::size_t>(y) * w + x];
      if (swatch.opaque[static_cast<std::size_t>(y) * w + x]) last = y;
      if (last >= 0 && (nearest < 0 || last - y < y - nearest)) nearest = last;
    }
  }
  return row;
}

}  // namespace

void fillHoles(const Swatch& swatch, std::vector<vec3>& colours) {
  const int w = swatch.width, h = swatch.height;
  const std::vector<int> row = nearestInColumn(swatch);
  const auto at = [w](int x, int y) { return static_cast<std::size_t>(y) * w + x; };
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      if (swatch.opaque[at(x, y)]) continue;
      std::int64_t best = std::numeric_limits<std::int64_t>::max();
      std::size_t from = at(x, y);
      for (std::int64_t d = 0; d < w && d * d < best; ++d) {  // columns outward, left one first
        for (int column : {x - static_cast<int>(d), x + static_cast<int>(d)}) {
          if (column < 0 || column >= w || row[at(column, y)] < 0) continue;
          const std::int64_t dy = row[at(column, y)] - y;
          if (d * d + dy * dy >= best) continue;
          best = d * d + dy * dy;
          from = at(column, row[at(column, y)]);
        }
      }
      colours[at(x, y)] = colours[from];
    }
  }
}

std::vector<vec3> blurSwatch(const Swatch& swatch, double sigma) {
  DAPPLE_CHECK(sigma, >, 0.0);
  const int w = swatch.width, h = swatch.height;
  const std::vector<float> kernel = gaussianKernel(sigma);
  std::vector<float> texels(swatch.pixels() * 4, 0.0f);  // weight * colour, weight
  for (std::size_t i = 0; i < swatch.pixels(); ++i) {
    if (!swatch.opaque[i]) continue;
    for (int c = 0; c < 3; ++c) texels[i * 4 + c] = swatch.colours()[i][c];
    texels[i * 4 + 3] = 1;
  }
  std::vector<float> blurred(texels.size());
  convolveLines(texels, {static_cast<std::size_t>(w) * 4, h, swatch.tileable}, kernel, blurred);
  texels = transposed(blurred, w, h);
  convolveLines(texels, {static_cast<std::size_t>(h) * 4, w, swatch.tileable}, kernel, blurred);
  texels = transposed(blurred, h, w);

  std::vector<vec3> result(swatch.pixels());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const float weight = texels[i * 4 + 3];
    if (!swatch.opaque[i]) continue;  // filled below; an opaque texel has its own weight
    result[i] = vec3(texels[i * 4], texels[i * 4 + 1], texels[i * 4 + 2]) / weight;
  }
  if (swatch.hasHoles) fillHoles(swatch, result);
  return result;
}

}  // namespace dapple
