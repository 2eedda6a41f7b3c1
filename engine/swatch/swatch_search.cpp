// Exhaustive search by polyphase planes and 8-bit arithmetic (methods: section 3.2).
//
// [Zhang] section 4 compares against a swatch supersampled 8 times and takes the nearest sample.
// Here the phases of the supersampled swatch are separate planes, so that the samples one term
// meets while the place moves by whole pixels are neighbours in memory.
#include "swatch/swatch_search.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "swatch/search_kernels.h"

namespace dapple {
namespace {

using detail::Kernel;
using detail::KernelArea;
using detail::KernelBest;
using detail::KernelTerm;

constexpr int kOverread = 64;    // pixels that a kernel may read past the last place
constexpr float kFar = 1 << 20;  // pixels; further offsets are off every swatch
constexpr std::size_t kMaxTerms = std::size_t{1} << 16;

int wrapped(int i, int size) {
  i %= size;
  return i < 0 ? i + size : i;
}

std::uint32_t packed(glm::vec4 texel) {
  std::uint32_t word = 0;
  for (int c = 0; c < 4; ++c) {
    const float level = std::clamp(texel[c], 0.0f, 1.0f) * 127.0f + 0.5f;
    word |= static_cast<std::uint32_t>(level) << (8 * c);
  }
  return word;
}

std::uint32_t packed(const SearchTerm& term) {
  return packed(glm::vec4(term.colour, term.relief));
}

Kernel kernelOf(SimdPath path) {
#if defined(__x86_64__)
  switch (std::min(path, bestSimdPath())) {
    case SimdPath::Avx512Vnni:
      return detail::searchAvx512Vnni;
    case SimdPath::Avx2:
      return detail::searchAvx2;
    case SimdPath::Scalar:
      break;
  }
#else
  (void)path;
#endif
  return detail::searchScalar;
}

// Colours and relief.
std::vector<glm::vec4> texelsOf(const Swatch& swatch, std::size_t level) {
  std::vector<glm::vec4> texels;
  texels.reserve(swatch.pixels());
  for (std::size_t i = 0; i < swatch.pixels(); ++i)
    texels.emplace_back(swatch.stack[level][i],
                        swatch.relief.empty() ? 0 : swatch.relief[level][i]);
  return texels;
}

// A term's offset in whole pixels and phases.
struct Shift {
  int x, y, a, b;
};

// Places that the terms allow in a swatch that does not tile.
struct Range {
  int x0, x1, y0, y1;
};

}  // namespace

SimdPath bestSimdPath() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vnni")) {
    return SimdPath::Avx512Vnni;
  }
  if (__builtin_cpu_supports("avx2")) return SimdPath::Avx2;
#endif
  return SimdPath::Scalar;
}

struct SwatchSearch::Planes {
  int width, height, phases, layers;
  bool tileable, holes;
  int left;               // pixels before x = 0 on a plane's row: half a period when tileable
  std::ptrdiff_t stride;  // pixels from row to row
  std::vector<std::uint32_t> pixels;  // layers x phases x phases planes of height x stride
  // By (a > 0) + 2 (b > 0): bit x of row y is set where a bilinear read there touches a transparent
  // texel.
  std::vector<std::uint64_t> transparent[4];
  std::ptrdiff_t words;  // of a row of bits

  Planes(const Swatch& swatch, int level, int phaseCount, int layerCount);
  void fillLayer(const std::vector<glm::vec4>& image, int layer);
  void fillTransparent(const Swatch& swatch);

  // Coarser layers are blurred by a pixel and more: two phases show all that is in them, and fewer
  // planes stay in the cache, which is what limits the search.
  int phasesOf(int layer) const { return layer == 0 ? phases : std::min(phases, 2); }

  std::uint32_t* plane(int layer, int a, int b) {
    const int count = phasesOf(layer);
    const int before = layer == 0 ? 0 : phases * phases + (layer - 1) * count * count;
    return pixels.data() + (before + b * count + a) * (height * stride);
  }
  const std::uint32_t* plane(int layer, int a, int b) const {
    return const_cast<Planes*>(this)->plane(layer, a, b);
  }

  Shift shiftOf(const SearchTerm& term) const;
  Range rangeOf(std::span<const Shift> shifts) const;
  std::vector<std::uint64_t> blockedPlaces(std::span<const Shift> shifts, const Range& range) const;
  KernelBest searchTiled(std::span<const SearchTerm> terms, std::span<const Shift> shifts,
                         Kernel kernel) const;
  KernelBest searchInside(std::span<const SearchTerm> terms, std::span<const Shift> shifts,
                          Kernel kernel) const;
};

SwatchSearch::Planes::Planes(const Swatch& swatch, int level, int phaseCount, int layerCount)
    : width(swatch.width),
      height(swatch.height),
      phases(phaseCount),
      layers(layerCount),
      tileable(swatch.tileable),
      holes(swatch.hasHoles && !swatch.tileable) {
  left = tileable ? width / 2 : 0;
  stride = (left + width + (tileable ? (width + 1) / 2 : 0) + kOverread + 15) / 16 * 16;
  words = (width + 63) / 64 + 1;
  const int coarse = phasesOf(1) * phasesOf(1);
  const auto planes = static_cast<std::size_t>(phases * phases + (layers - 1) * coarse);
  pixels.resize(planes * height * stride);
  const int last = static_cast<int>(swatch.stack.size()) - 1;
  for (int layer = 0; layer < layers; ++layer) {
    fillLayer(texelsOf(swatch, static_cast<std::size_t>(std::min(level + layer, last))), layer);
  }
  if (holes) fillTransparent(swatch);
}

void SwatchSearch::Planes::fillLayer(const std::vector<glm::vec4>& image, int layer) {
  const auto texel = [&](int x, int y) {
    x = tileable ? wrapped(x, width) : std::clamp(x, 0, width - 1);
    y = tileable ? wrapped(y, height) : std::clamp(y, 0, height - 1);
    return image[static_cast<std::size_t>(y) * width + x];
  };
  const int count = phasesOf(layer);
  for (int b = 0; b < count; ++b) {
    for (int a = 0; a < count; ++a) {
      const float u = static_cast<float>(a) / count, v = static_cast<float>(b) / count;
      for (int y = 0; y < height; ++y) {
        std::uint32_t* row = plane(layer, a, b) + y * stride + left;
        for (int x = 0; x < width; ++x) {
          const glm::vec4 upper = texel(x, y) * (1 - u) + texel(x + 1, y) * u;
          const glm::vec4 lower = texel(x, y + 1) * (1 - u) + texel(x + 1, y + 1) * u;
          row[x] = packed(upper * (1 - v) + lower * v);
        }
        for (int x = -left; x < stride - left; ++x) {
          if (x < 0 || x >= width) row[x] = row[tileable ? wrapped(x, width) : width - 1];
        }
      }
    }
  }
}

void SwatchSearch::Planes::fillTransparent(const Swatch& swatch) {
  const auto hidden = [&](int x, int y) {
    x = std::min(x, width - 1);
    y = std::min(y, height - 1);
    return swatch.opaque[static_cast<std::size_t>(y) * width + x] == 0;
  };
  for (int kind = 0; kind < 4; ++kind) {
    const int right = kind & 1, below = kind >> 1;
    transparent[kind].assign(static_cast<std::size_t>(height) * words, 0);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const bool any = hidden(x, y) || hidden(x + right, y) || hidden(x, y + below) ||
                         hidden(x + right, y + below);
        if (any) transparent[kind][y * words + x / 64] |= std::uint64_t{1} << (x % 64);
      }
    }
  }
}

Shift SwatchSearch::Planes::shiftOf(const SearchTerm& term) const {
  const vec2 offset = glm::clamp(term.offset, -kFar, kFar);
  const int count = phasesOf(term.layer);
  const int x = static_cast<int>(std::floor(static_cast<double>(offset.x) * count + 0.5));
  const int y = static_cast<int>(std::floor(static_cast<double>(offset.y) * count + 0.5));
  Shift shift{0, 0, wrapped(x, count), wrapped(y, count)};
  shift.x = (x - shift.a) / count;
  shift.y = (y - shift.b) / count;
  if (tileable) {
    shift.x = wrapped(shift.x + left, width) - left;
    shift.y = wrapped(shift.y, height);
  }
  return shift;
}

Range SwatchSearch::Planes::rangeOf(std::span<const Shift> shifts) const {
  Range range{0, width, 0, height};
  for (const Shift& s : shifts) {
    range.x0 = std::max(range.x0, -s.x);
    range.y0 = std::max(range.y0, -s.y);
    range.x1 = std::min(range.x1, width - s.x - (s.a > 0));
    range.y1 = std::min(range.y1, height - s.y - (s.b > 0));
  }
  return range;
}

// One bit for each place, set where a term or the place itself is transparent.
std::vector<std::uint64_t> SwatchSearch::Planes::blockedPlaces(std::span<const Shift> shifts,
                                                               const Range& range) const {
  std::vector<std::uint64_t> blocked(transparent[0]);
  for (const Shift& s : shifts) {
    const std::vector<std::uint64_t>& bits = transparent[(s.a > 0) + 2 * (s.b > 0)];
    const std::ptrdiff_t whole = s.x >= 0 ? s.x / 64 : -((-s.x + 63) / 64);
    const int part = static_cast<int>(s.x - whole * 64);
    for (int y = range.y0; y < range.y1; ++y) {
      const std::uint64_t* from = bits.data() + (y + s.y) * words;
      const auto word = [&](std::ptrdiff_t i) { return i < 0 || i >= words ? 0 : from[i]; };
      for (std::ptrdiff_t i = 0; i < words; ++i) {
        std::uint64_t moved = word(i + whole) >> part;
        if (part > 0) moved |= word(i + whole + 1) << (64 - part);
        blocked[y * words + i] |= moved;
      }
    }
  }
  return blocked;
}

KernelBest SwatchSearch::Planes::searchInside(std::span<const SearchTerm> terms,
                                              std::span<const Shift> shifts, Kernel kernel) const {
  const Range range = rangeOf(shifts);
  if (range.x0 >= range.x1 || range.y0 >= range.y1) return {};
  std::vector<KernelTerm> rows(terms.size());
  for (std::size_t t = 0; t < terms.size(); ++t) {
    const Shift& s = shifts[t];
    rows[t] = {plane(terms[t].layer, s.a, s.b) + s.y * stride + s.x, packed(terms[t])};
  }
  std::vector<std::uint64_t> blocked;
  if (holes) blocked = blockedPlaces(shifts, range);
  return kernel({rows.data(), rows.size(), stride, range.x0, range.x1, range.y0, range.y1,
                 holes ? blocked.data() : nullptr, words, KernelBest{}.error});
}

// Rows wrap by pointer: the places are cut into bands of rows in which no term crosses the lower
// border, so that only columns need a second copy.
KernelBest SwatchSearch::Planes::searchTiled(std::span<const SearchTerm> terms,
                                             std::span<const Shift> shifts, Kernel kernel) const {
  std::vector<KernelTerm> rows(terms.size());
  for (std::size_t t = 0; t < terms.size(); ++t) rows[t].colour = packed(terms[t]);
  KernelBest best;
  for (int y0 = 0, y1; y0 < height; y0 = y1) {
    y1 = height;
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const Shift& s = shifts[t];
      const bool crossed = y0 + s.y >= height;
      if (!crossed) y1 = std::min(y1, height - s.y);
      const std::ptrdiff_t firstRow = crossed ? s.y - height : s.y;
      rows[t].row = plane(terms[t].layer, s.a, s.b) + firstRow * stride + left + s.x;
    }
    const KernelBest band =
        kernel({rows.data(), rows.size(), stride, 0, width, y0, y1, nullptr, 0, best.error});
    if (band.x >= 0) best = band;
  }
  return best;
}

SwatchSearch::SwatchSearch(const Swatch& swatch, int level, int phases, int layers) {
  DAPPLE_CHECK(swatch.stack.empty(), ==, false);
  DAPPLE_CHECK(level, >=, 0);
  DAPPLE_CHECK(layers, >=, 1);
  DAPPLE_CHECK(std::max(swatch.width, swatch.height), <, 1 << 15);
  DAPPLE_CHECK(phases == 1 || phases == 2 || phases == 4 || phases == 8, ==, true);
  planes_ = std::make_unique<Planes>(swatch, level, phases, layers);
}

SwatchSearch::~SwatchSearch() = default;
SwatchSearch::SwatchSearch(SwatchSearch&&) noexcept = default;

std::size_t SwatchSearch::bytes() const {
  std::size_t sum = planes_->pixels.size() * sizeof(std::uint32_t);
  for (const auto& bits : planes_->transparent) sum += bits.size() * sizeof(std::uint64_t);
  return sum;
}

SearchResult SwatchSearch::search(std::span<const SearchTerm> terms, SimdPath path) const {
  DAPPLE_CHECK(terms.size(), <=, kMaxTerms);
  std::vector<Shift> shifts(terms.size());
  for (std::size_t t = 0; t < terms.size(); ++t) shifts[t] = planes_->shiftOf(terms[t]);
  const Kernel kernel = kernelOf(path);
  const KernelBest best = planes_->tileable ? planes_->searchTiled(terms, shifts, kernel)
                                            : planes_->searchInside(terms, shifts, kernel);
  if (best.x < 0) return {};
  return {{static_cast<float>(best.x) + 0.5f, static_cast<float>(best.y) + 0.5f}, best.error, true};
}

SearchResult SwatchSearch::search(std::span<const SearchTerm> terms) const {
  return search(terms, bestSimdPath());
}

std::shared_ptr<const SwatchSearch> searchOf(const Swatch& swatch, int level, int phases,
                                             int layers) {
  const auto number = static_cast<std::uint64_t>((level * 16 + phases) * 16 + layers);
  return swatch.tables.get<SwatchSearch>(
      number, [&] { return SwatchSearch(swatch, level, phases, layers); });
}

}  // namespace dapple
