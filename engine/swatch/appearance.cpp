// Methods 3.4, step 1, after Lefebvre and Hoppe, "Appearance-space texture synthesis" (2006).
//
// Departures: samples are four to a step on every level, not on the finest two only: finer ones
// than that look the same, and coarse levels get small.
#include "swatch/appearance.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <span>

#include "base/hash_rng.h"
#include "base/simd.h"
#include "swatch/gaussian_blur.h"
#include "swatch/swatch_relief.h"

namespace dapple {
namespace {

constexpr int kTaps = 2;  // texels to each side
constexpr int kSide = 2 * kTaps + 1;
template <int Colours>  // 3, or 4 with relief
constexpr int kNumbers = kSide* kSide* Colours;
constexpr float kTapWidth = 2.2f;  // of the Gaussian that weighs them, steps
constexpr float kLargest = 1000;   // of a number: 24 squared differences of 8 sums fit 31 bits
constexpr float kClipped = 1400;
constexpr std::int32_t kReachSteps = 4;
constexpr std::size_t kSurroundings = 4096;  // that the components are taken from
constexpr std::size_t kRowGrain = 16;
// Swatches of more pixels get fewer samples on the finest levels: the processor's caches are small.
constexpr std::size_t kSmallSwatch = 160 * 160, kMediumSwatch = 768 * 768;

template <int Colours>
using Basis = Eigen::Matrix<float, kAppearanceNumbers, kNumbers<Colours>>;

template <int Colours>
struct Samples {
  int perStep = 4;  // along each axis
  int border = 0;   // around those of the appearance
  int stride = 0, rows = 0;
  std::vector<glm::vec<Colours, float>> colours;
};

int samplesPerStep(const Swatch& swatch, int level) {
  if (swatch.pixels() > kMediumSwatch) return level == 0 ? 1 : level == 1 ? 2 : 4;
  if (swatch.pixels() > kSmallSwatch) return level == 0 ? 2 : 4;
  return 4;
}

// Into [0, size], forth and back.
float mirroredCoordinate(float value, float size) {
  const float twice = wrapCoordinate(value, 2 * size);
  return twice <= size ? twice : 2 * size - twice;
}

// As sampleSwatch() reads it, blurred for a level.
Swatch blurredView(const Swatch& swatch, int level) {
  Swatch view{.width = swatch.width, .height = swatch.height, .tileable = swatch.tileable};
  view.stack.push_back(level == 0 ? swatch.colours() : blurSwatch(swatch, std::ldexp(0.5, level)));
  return view;
}

// Where of the swatch is read what lies at `texel`, which may be outside.
vec2 readAt(const Swatch& swatch, const PlaceDomain& domain, vec2 texel) {
  const vec2 size(swatch.width, swatch.height);
  const bool inside = texel.x >= 0 && texel.y >= 0 && texel.x < size.x && texel.y < size.y;
  if (swatch.tileable || inside) return texel;
  const Place place = domain.continued(placeOf(texel));
  if (domain.contains(place)) return texelOf(place);
  return {mirroredCoordinate(texel.x, size.x), mirroredCoordinate(texel.y, size.y)};
}

// The swatch with a margin of samples around, blurred for the level.
template <int Colours>
Samples<Colours> sampleLevel(const Swatch& swatch, const AppearanceLevel& out, int perStep,
                             Monitor& monitor) {
  const Swatch view = blurredView(swatch, out.level);
  Swatch relief;
  if constexpr (Colours == 4) relief = blurredView(reliefAsColours(swatch), out.level);
  const int border = kTaps * perStep;
  Samples<Colours> samples{.perStep = perStep,
                           .border = border,
                           .stride = out.stride + 2 * border,
                           .rows = out.rows + 2 * border};
  const float pitch = static_cast<float>(1 << out.shift) / kPlaceScale;  // pixels
  samples.colours.resize(static_cast<std::size_t>(samples.stride) * samples.rows);
  const auto along = [&](int sample) {
    return (static_cast<float>(sample - out.margin - border) + 0.5f) * pitch;
  };
  const PlaceDomain domain = PlaceDomain::continuing(swatch);
  parallelFor(monitor, static_cast<std::size_t>(samples.rows), kRowGrain,
              [&](std::size_t begin, std::size_t end) {
                for (std::size_t y = begin; y < end; ++y)
                  for (int x = 0; x < samples.stride; ++x) {
                    const vec2 at = readAt(swatch, domain, {along(x), along(static_cast<int>(y))});
                    auto& sample =
                        samples.colours[y * static_cast<std::size_t>(samples.stride) + x];
                    if constexpr (Colours == 4)
                      sample = glm::vec4(sampleSwatch(view, at), sampleSwatch(relief, at).x);
                    else
                      sample = sampleSwatch(view, at);
                  }
              });
  return samples;
}

std::array<float, kSide * kSide> tapWeights() {
  std::array<float, kSide * kSide> weights;
  float sum = 0;
  for (int y = -kTaps; y <= kTaps; ++y)
    for (int x = -kTaps; x <= kTaps; ++x) {
      const float w = std::exp(-0.5f * static_cast<float>(x * x + y * y) / (kTapWidth * kTapWidth));
      weights[(y + kTaps) * kSide + x + kTaps] = w;
      sum += w;
    }
  for (float& w : weights) w = std::sqrt(w / sum);
  return weights;
}

// The weighted colours around sample (x, y).
template <int Colours>
Eigen::Matrix<float, kNumbers<Colours>, 1> surroundings(const Samples<Colours>& samples, int x,
                                                        int y) {
  static const auto weights = tapWeights();
  Eigen::Matrix<float, kNumbers<Colours>, 1> out;
  int n = 0;
  for (int ty = -kTaps; ty <= kTaps; ++ty)
    for (int tx = -kTaps; tx <= kTaps; ++tx) {
      const std::ptrdiff_t at =
          static_cast<std::ptrdiff_t>(y + ty * samples.perStep) * samples.stride + x +
          tx * samples.perStep;
      const float w = weights[static_cast<std::size_t>(n / Colours)];
      for (int c = 0; c < Colours; ++c) out[n++] = w * samples.colours[at][c];
    }
  return out;
}

template <int Colours>
struct Projection {
  Basis<Colours> basis;  // weights of the taps included
  Eigen::Matrix<float, kAppearanceNumbers, 1> mean;
  float unit;
};

template <int Colours>
Projection<Colours> principalComponents(const Samples<Colours>& samples, const PlaceDomain& domain,
                                        const AppearanceLevel& out) {
  const int border = samples.border;
  Eigen::MatrixXf all(kNumbers<Colours>, kSurroundings);
  for (std::size_t s = 0; s < kSurroundings; ++s) {
    const Place place = domain.random(0, s, 17);
    all.col(static_cast<Eigen::Index>(s)) =
        surroundings(samples, (place.x >> out.shift) + out.margin + border,
                     (place.y >> out.shift) + out.margin + border);
  }
  const Eigen::VectorXf mean = all.rowwise().mean();
  all.colwise() -= mean;
  const Eigen::MatrixXf covariance = all * all.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(covariance);
  Projection<Colours> projection;
  projection.basis = solver.eigenvectors().rightCols(kAppearanceNumbers).transpose();
  const float largest = (projection.basis * all).cwiseAbs().maxCoeff();
  projection.unit = largest > 0 ? kLargest / largest : 1;
  projection.mean = projection.basis * mean;
  return projection;
}

// By tap and colour, how it adds to each number: eight lanes at once.
template <int Colours>
using TapColumns = std::array<std::array<float, kAppearanceNumbers>, kNumbers<Colours>>;
template <int Colours>
struct TapTable {
  TapColumns<Colours> columns;
  std::array<float, kAppearanceNumbers> shifts;  // that bring the mean to 0
};

// Of what lies at tap (x, y) of a point whose axes are turned to the left by so many quarters, its
// neighbour sees at (-y, x) of the swatch, once for each quarter.
int turnedTap(int tap, int quarters) {
  int x = tap % kSide - kTaps, y = tap / kSide - kTaps;
  for (int q = 0; q < quarters; ++q) std::swap(x, y), x = -x;
  return (y + kTaps) * kSide + x + kTaps;
}

template <int Colours>
TapTable<Colours> tapTable(const Projection<Colours>& projection, int quarters) {
  const auto weights = tapWeights();
  TapTable<Colours> table;
  for (int tap = 0; tap < kSide * kSide; ++tap)
    for (int c = 0; c < Colours; ++c)
      for (int d = 0; d < kAppearanceNumbers; ++d)
        table.columns[turnedTap(tap, quarters) * Colours + c][d] =
            projection.unit * projection.basis(d, tap * Colours + c) * weights[tap];
  for (int d = 0; d < kAppearanceNumbers; ++d)
    table.shifts[d] = -projection.unit * projection.mean[d];
  return table;
}

template <int Colours>
[[gnu::always_inline]] inline void projectTexels(const Samples<Colours>& samples,
                                                 const TapTable<Colours>& table,
                                                 const glm::vec<Colours, float>* centre,
                                                 std::span<Appearance> out) {
  const TapColumns<Colours>& columns = table.columns;
  for (std::size_t x = 0; x < out.size(); ++x) {
    Float8 sum = *reinterpret_cast<const Float8*>(table.shifts.data());
    int n = 0;
    for (int ty = -kTaps; ty <= kTaps; ++ty) {
      const glm::vec<Colours, float>* row =
          centre + x + static_cast<std::ptrdiff_t>(ty * samples.perStep) * samples.stride;
      for (int tx = -kTaps; tx <= kTaps; ++tx)
        for (int c = 0; c < Colours; ++c, ++n)
          sum += *reinterpret_cast<const Float8*>(columns[n].data()) * row[tx * samples.perStep][c];
    }
    for (int d = 0; d < kAppearanceNumbers; ++d)
      out[x].number[d] = static_cast<std::int16_t>(
          std::floor(std::min(std::max(sum[d], -kClipped), kClipped) + 0.5f));
  }
}

// No templates: clones are made of functions only.
DAPPLE_CLONES void projectRow(const Samples<3>& samples, const TapTable<3>& table,
                              const vec3* centre, std::span<Appearance> out) {
  projectTexels(samples, table, centre, out);
}
DAPPLE_CLONES void projectRow(const Samples<4>& samples, const TapTable<4>& table,
                              const glm::vec4* centre, std::span<Appearance> out) {
  projectTexels(samples, table, centre, out);
}

// The first of the samples that appearances are made of, of a row of these.
template <int Colours>
const glm::vec<Colours, float>* rowOf(const Samples<Colours>& samples, std::size_t y) {
  const auto border = static_cast<std::size_t>(samples.border);
  return samples.colours.data() + (y + border) * static_cast<std::size_t>(samples.stride) + border;
}

template <int Colours>
std::vector<Appearance> project(const Samples<Colours>& samples, const TapTable<Colours>& table,
                                const AppearanceLevel& out, Monitor& monitor) {
  const auto rows = static_cast<std::size_t>(out.rows),
             stride = static_cast<std::size_t>(out.stride);
  std::vector<Appearance> all(rows * stride);
  parallelFor(monitor, rows, kRowGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      projectRow(samples, table, rowOf(samples, y), {&all[y * stride], stride});
  });
  return all;
}

template <int Colours>
struct TurnedLooks {
  Samples<Colours> samples;
  std::array<TapTable<Colours>, 3> tables;  // by quarters - 1
  std::int32_t stride;                      // of the appearances

  Appearance at(std::int32_t index, int quarters) const {
    Appearance out;
    const auto* row = rowOf(samples, static_cast<std::size_t>(index / stride));
    projectRow(samples, tables[static_cast<std::size_t>(quarters - 1)], row + index % stride,
               {&out, 1});
    return out;
  }
};

// What of a level its geometry is filled with.
template <int Colours>
void fillSamples(const Swatch& swatch, int perStep, bool turned, AppearanceLevel& out,
                 Monitor& monitor) {
  Samples<Colours> samples = sampleLevel<Colours>(swatch, out, perStep, monitor);
  const Projection<Colours> projection = principalComponents(samples, PlaceDomain(swatch), out);
  out.unit = projection.unit * std::sqrt(3.f);
  out.samples = project(samples, tapTable(projection, 0), out, monitor);
  if (!turned) return;
  const auto looks = std::make_shared<TurnedLooks<Colours>>(TurnedLooks<Colours>{
      std::move(samples),
      {tapTable(projection, 1), tapTable(projection, 2), tapTable(projection, 3)},
      out.stride});
  out.turnedBytes =
      sizeof(*looks) + looks->samples.colours.size() * sizeof(looks->samples.colours[0]);
  out.turned = [looks](std::int32_t index, int quarters) { return looks->at(index, quarters); };
}

}  // namespace

PlaceDomain::PlaceDomain(const Swatch& swatch)
    : width_(swatch.width << kPlaceBits), height_(swatch.height << kPlaceBits) {
  if (swatch.tileable) return;
  columns_ = swatch.width - 1, rows_ = swatch.height - 1;
  usable_.assign(static_cast<std::size_t>(columns_) * rows_, 1);
  if (!swatch.hasHoles) return;
  for (std::int32_t y = 0; y < rows_; ++y)
    for (std::int32_t x = 0; x < columns_; ++x) {
      const std::size_t texel = static_cast<std::size_t>(y) * swatch.width + x;
      const std::size_t below = texel + static_cast<std::size_t>(swatch.width);
      const std::size_t cell = static_cast<std::size_t>(y) * columns_ + x;
      usable_[cell] = swatch.opaque[texel] && swatch.opaque[texel + 1] && swatch.opaque[below] &&
                      swatch.opaque[below + 1];
      if (usable_[cell]) cells_.push_back(static_cast<Index>(cell));
    }
  empty_ = cells_.empty();
}

PlaceDomain PlaceDomain::continuing(const Swatch& swatch) {
  PlaceDomain domain(swatch);
  domain.continuation_ = *continuationOf(swatch);
  return domain;
}

Place PlaceDomain::continued(Place place) const {
  if (tileable()) return wrapped(place);
  if (continuation_.none()) return place;
  constexpr int kMostWays = 8;  // as each may lead out along the other axis
  constexpr std::int32_t kHalf = 1 << (kPlaceBits - 1);
  Place at = place;
  for (int ways = 0; ways <= kMostWays; ++ways) {
    if (contains(at)) return at;
    const std::size_t side = at.x < kHalf ? 0 : at.x >= width_ - kHalf ? 1 : at.y < kHalf ? 2 : 3;
    const ivec2 back = continuation_.back[side];
    at = {at.x + (back.x << kPlaceBits), at.y + (back.y << kPlaceBits)};
  }
  return place;
}

Place PlaceDomain::moved(Place from, Place way) const {
  if (tileable()) {
    const auto folded = [](std::int32_t value, std::int32_t size) {
      // Most ways are short, and dividing takes long.
      if (static_cast<std::uint32_t>(value) < static_cast<std::uint32_t>(size)) return value;
      value %= size;
      return value < 0 ? value + size : value;
    };
    return {folded(from.x + way.x, width_), folded(from.y + way.y, height_)};
  }
  const Place there = continued({from.x + way.x, from.y + way.y});
  const Place back{from.x - way.x, from.y - way.y};
  return contains(there) ? there : contains(back) ? back : from;
}

Place PlaceDomain::random(std::uint64_t seed, std::uint64_t id, std::uint64_t salt) const {
  constexpr std::int32_t kHalf = 1 << (kPlaceBits - 1);
  const auto below = [&](std::int32_t count, std::uint64_t axis) {
    return static_cast<std::int32_t>(
        hashBelow(static_cast<std::uint64_t>(count), seed, id, salt, axis));
  };
  if (tileable()) return {below(width_, 1), below(height_, 2)};
  const std::size_t cell = cells_.empty() ? hashBelow(usable_.size(), seed, id, salt, 0)
                                          : cells_[hashBelow(cells_.size(), seed, id, salt, 0)];
  const auto column = static_cast<std::int32_t>(cell % static_cast<std::size_t>(columns_));
  const auto row = static_cast<std::int32_t>(cell / static_cast<std::size_t>(columns_));
  return {(column << kPlaceBits) + kHalf + below(1 << kPlaceBits, 1),
          (row << kPlaceBits) + kHalf + below(1 << kPlaceBits, 2)};
}

std::int32_t appearanceReach(const Swatch& swatch, int level) {
  const std::int32_t least = std::min(swatch.width, swatch.height) << kPlaceBits;
  return std::min(kReachSteps << (kPlaceBits + level), least);
}

AppearanceLevel makeAppearance(const Swatch& swatch, int level, bool turned, Monitor& monitor) {
  AppearanceLevel out{.level = level};
  const int perStep = samplesPerStep(swatch, level);
  out.shift = kPlaceBits + level - std::countr_zero(static_cast<unsigned>(perStep));
  out.reach = appearanceReach(swatch, level);
  out.margin = (out.reach >> out.shift) + 2;
  const auto samplesAlong = [&](int size) {
    return (((size << kPlaceBits) - 1) >> out.shift) + 1 + 2 * out.margin;
  };
  out.stride = samplesAlong(swatch.width);
  out.rows = samplesAlong(swatch.height);
  if (swatch.relief.empty())
    fillSamples<3>(swatch, perStep, turned, out, monitor);
  else
    fillSamples<4>(swatch, perStep, turned, out, monitor);
  return out;
}

std::shared_ptr<const AppearanceLevel> appearanceOf(const Swatch& swatch, int level, bool turned,
                                                    Monitor& monitor) {
  const auto number = [&](bool also) { return 2 * static_cast<std::uint64_t>(level) + also; };
  // One that knows turned samples has all others as well.
  if (!turned)
    if (auto both = swatch.tables.find<AppearanceLevel>(number(true))) return both;
  return swatch.tables.get<AppearanceLevel>(
      number(turned), [&] { return makeAppearance(swatch, level, turned, monitor); });
}

std::int32_t appearanceDistance(const Appearance& a, const Appearance& b) {
  std::int32_t sum = 0;
  for (int d = 0; d < kAppearanceNumbers; ++d) {
    const std::int32_t difference = a.number[d] - b.number[d];
    sum += difference * difference;
  }
  return sum;
}

int appearanceLevels(const Swatch& swatch) {
  int levels = 1;
  while (3 << levels <= std::min(swatch.width, swatch.height)) ++levels;
  return levels;
}

}  // namespace dapple
