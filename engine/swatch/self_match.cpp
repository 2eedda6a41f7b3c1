// Pieces are compared by their principal components; a piece never counts as a match of itself or
// of what lies over it.
#include "swatch/self_match.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/hash_rng.h"
#include "base/simd.h"
#include "swatch/gaussian_blur.h"
#include "swatch/swatch_relief.h"

namespace dapple {
namespace {

constexpr int kSide = 5, kNodes = kSide * kSide;
constexpr int kCodeNumbers = 16;
constexpr std::size_t kMostPlaces = 8192;  // that are searched
constexpr std::size_t kPieces = 200;       // that are searched for
constexpr double kPlaceSteps = 0.5;        // between places
constexpr double kApart = 3;               // steps between the centres of a piece and of its match
constexpr int kTrainingStride = 5;         // of places
constexpr float kNothing = 1e30f;          // in place of a distance
constexpr std::size_t kReadGrain = 512, kSearchGrain = 8;
constexpr std::uint64_t kSeed = 7;

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The swatch, read through squares of nodes.
class PieceReader {
 public:
  PieceReader(const Swatch& swatch, double step)
      : blurred_{.width = swatch.width,
                 .height = swatch.height,
                 .tileable = swatch.tileable,
                 .stack = {blurSwatch(swatch, 0.5 * step)}},
        step_(static_cast<float>(step)) {
    if (swatch.relief.empty()) return;
    std::vector<float>& relief = blurred_.relief.emplace_back();
    for (const vec3& h : blurSwatch(reliefAsColours(swatch), 0.5 * step)) relief.push_back(h.x);
  }

  vec2 size() const { return {blurred_.width, blurred_.height}; }
  // Of a piece: 3 a node, or 4 where there is relief.
  int numbers() const { return kNodes * (blurred_.relief.empty() ? 3 : 4); }
  bool wraps() const { return blurred_.tileable; }
  // How far from the border a piece lies that may be turned.
  float margin() const {
    return wraps() ? 0.5f : step_ * (kSide / 2) * std::numbers::sqrt2_v<float> + 0.5f;
  }

  // Colours and relief at the nodes around `centre`, less their mean; the rows turned by `angle`
  // (radians).
  void read(vec2 centre, float angle, float* numbers) const {
    const vec2 right = step_ * vec2(std::cos(angle), std::sin(angle)), down(-right.y, right.x);
    std::array<glm::vec4, kNodes> values;
    glm::vec4 sum(0);
    for (int n = 0; n < kNodes; ++n) {
      const vec2 node(n % kSide - kSide / 2, n / kSide - kSide / 2);
      const vec2 at = centre + node.x * right + node.y * down;
      values[n] = glm::vec4(sampleSwatch(blurred_, at), sampleRelief(blurred_, at));
      sum += values[n];
    }
    const int each = this->numbers() / kNodes;
    for (int n = 0; n < kNodes; ++n)
      for (int c = 0; c < each; ++c) numbers[each * n + c] = values[n][c] - sum[c] / kNodes;
  }

 private:
  Swatch blurred_;
  float step_;
};

struct Area {
  vec2 low, size;
};

std::vector<vec2> searchedPlaces(const Area& area, double step) {
  const double texels = static_cast<double>(area.size.x) * area.size.y;
  const double spacing = std::max(kPlaceSteps * step, std::sqrt(texels / kMostPlaces));
  const ivec2 cells = glm::max(ivec2(1), ivec2(area.size / static_cast<float>(spacing)));
  std::vector<vec2> places;
  for (int y = 0; y < cells.y; ++y)
    for (int x = 0; x < cells.x; ++x)
      places.push_back(area.low + area.size * (vec2(x, y) + 0.5f) / vec2(cells));
  return places;
}

// One in each cell of a grid, at random in it.
std::vector<vec2> piecePlaces(const Area& area) {
  const double across = std::sqrt(static_cast<double>(kPieces) * area.size.x / area.size.y);
  const auto columns = static_cast<std::size_t>(std::clamp(across, 1.0, double{kPieces}));
  const std::size_t rows = std::max<std::size_t>(1, kPieces / columns);
  std::vector<vec2> places;
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x) {
      const vec2 inCell(hashUniform(kSeed, x, y, 0), hashUniform(kSeed, x, y, 1));
      places.push_back(area.low + area.size * (vec2(x, y) + inCell) / vec2(columns, rows));
    }
  return places;
}

Matrix readAll(const PieceReader& reader, const std::vector<vec2>& places, float angle,
               Monitor& monitor) {
  Matrix out(static_cast<Eigen::Index>(places.size()), reader.numbers());
  parallelFor(monitor, places.size(), kReadGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      reader.read(places[i], angle, out.row(static_cast<Eigen::Index>(i)).data());
  });
  return out;
}

// Columns: the principal components of the rows.
Matrix componentsOf(const Matrix& rows) {
  const Matrix some = rows(Eigen::seq(0, Eigen::last, kTrainingStride), Eigen::all);
  const Eigen::RowVectorXf mean = some.colwise().mean();
  const Matrix centred = some.rowwise() - mean;
  const Eigen::MatrixXf covariance = centred.transpose() * centred;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(covariance);
  return solver.eigenvectors().rightCols(kCodeNumbers);
}

// All places that are searched, a column for each number, padded with places that never match.
struct SearchedColumns {
  SearchedColumns(const std::vector<vec2>& places, const Matrix& codes)
      : count(paddedToLanes(places.size())), x(count), y(count), numbers(count * kCodeNumbers) {
    for (std::size_t p = 0; p < places.size(); ++p) {
      x[p] = places[p].x, y[p] = places[p].y;
      for (int d = 0; d < kCodeNumbers; ++d)
        numbers[static_cast<std::size_t>(d) * count + p] = codes(static_cast<Eigen::Index>(p), d);
    }
    for (std::size_t p = places.size(); p < count; ++p) numbers[p] = kNothing;
  }

  std::size_t count;
  std::vector<float> x, y, numbers;
  float apart = 0;        // of a piece from its match, at least, pixels
  vec2 period{kNothing};  // the swatch's size where it tiles
};

struct Wanted {
  vec2 centre;
  const float* code;  // kCodeNumbers
};

[[gnu::always_inline]] inline void wrappedDistance(const Float8& from, float to, float period,
                                                   Float8& distance) {
  const Float8 d = from - to, positive = d < 0 ? -d : d, other = period - positive;
  distance = positive < other ? positive : other;
}

// Squared distance of the nearest code of a place far enough away; kNothing or more: none is.
DAPPLE_CLONES float nearestCode(const SearchedColumns& searched, const Wanted& wanted) {
  Float8 best = Float8{} + kNothing;
  for (std::size_t p = 0; p < searched.count; p += kLanes) {
    Float8 squares{};
    for (std::size_t d = 0; d < kCodeNumbers; ++d) {
      const auto& number =
          *reinterpret_cast<const Float8*>(searched.numbers.data() + d * searched.count + p);
      const Float8 difference = number - wanted.code[d];
      squares += difference * difference;
    }
    const auto& x = *reinterpret_cast<const Float8*>(searched.x.data() + p);
    const auto& y = *reinterpret_cast<const Float8*>(searched.y.data() + p);
    Float8 dx, dy;
    wrappedDistance(x, wanted.centre.x, searched.period.x, dx);
    wrappedDistance(y, wanted.centre.y, searched.period.y, dy);
    const Float8 larger = dx > dy ? dx : dy;
    squares = larger < searched.apart ? Float8{} + kNothing : squares;
    best = squares < best ? squares : best;
  }
  float least = best[0];
  for (std::size_t l = 1; l < kLanes; ++l) least = best[l] < least ? best[l] : least;
  return least;
}

// Mean over the pieces of the squared distance to the best match.
double meanBest(const std::vector<vec2>& pieces, const Matrix& codes,
                const SearchedColumns& searched, Monitor& monitor) {
  std::vector<float> best(pieces.size());
  parallelFor(monitor, pieces.size(), kSearchGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      best[i] = nearestCode(searched, {pieces[i], codes.row(static_cast<Eigen::Index>(i)).data()});
  });
  double sum = 0, found = 0;
  for (const float b : best)
    if (b < kNothing) sum += b, ++found;
  return found > 0 ? sum / found : 0;
}

}  // namespace

SelfMatch selfMatch(const Swatch& swatch, double step, Monitor& monitor) {
  const PieceReader reader(swatch, step);
  const Area area{vec2(reader.margin()), reader.size() - 2 * reader.margin()};
  const auto apart = static_cast<float>(kApart * step);
  if (std::min(area.size.x, area.size.y) < 1 || std::max(area.size.x, area.size.y) < 2 * apart)
    return {};
  const std::vector<vec2> places = searchedPlaces(area, step), pieces = piecePlaces(area);
  const Matrix rows = readAll(reader, places, 0, monitor);
  const Matrix basis = componentsOf(rows);
  monitor.checkpoint();
  SearchedColumns searched(places, rows * basis);
  searched.apart = apart;
  if (reader.wraps()) searched.period = reader.size();
  // So that a swatch of one colour, or one that repeats exactly, divides by something.
  const double least = 1e-6 * rows.squaredNorm() / static_cast<double>(rows.rows()) + 1e-12;
  const auto at = [&](double degrees) {
    const auto angle = static_cast<float>(degrees * std::numbers::pi / 180);
    const Matrix codes = readAll(reader, pieces, angle, monitor) * basis;
    return meanBest(pieces, codes, searched, monitor) + least;
  };
  const double unturned = at(0);
  const auto ratio = [&](double degrees) { return std::sqrt(at(degrees) / unturned); };
  return {.half = ratio(180), .quarter = ratio(90), .eighth = ratio(45)};
}

}  // namespace dapple
