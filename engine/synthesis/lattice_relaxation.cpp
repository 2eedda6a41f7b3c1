// [Soler] section on relaxation: a mass-spring lattice is moved until features match; here the sum
// of squared differences along the border, of differences between nodes, and of displacements is
// minimised by Gauss and Newton's method, first between blurred colours, so that features some
// pixels apart are seen (methods: section 6, step 5).
#include "synthesis/lattice_relaxation.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

constexpr int kMostCells = 8;          // along each side
constexpr int kSteps = 3;              // of each of the two phases
constexpr float kGradientStep = 0.5f;  // pixels to either side
constexpr float kSettled = 0.02f;      // pixels: a step that moves no node further is the last

// Where a swatch that does not tile has nothing the border is read.
Float4 readAt(const TexelReader& reader, vec2 texel) {
  const vec2 place = reader.nearest(texel - 0.5f);
  return reader.read(place.x, place.y);
}

// The normal equations of one step.
struct Equations {
  explicit Equations(std::size_t nodes)
      : matrix(Eigen::MatrixXf::Zero(static_cast<Eigen::Index>(2 * nodes),
                                     static_cast<Eigen::Index>(2 * nodes))),
        right(Eigen::VectorXf::Zero(static_cast<Eigen::Index>(2 * nodes))) {}

  Eigen::MatrixXf matrix;
  Eigen::VectorXf right;
};

// Sums of products of a sample's colour derivatives along x and y, and with its difference.
struct Slope {
  float xx, xy, yy, x, y;
};

Slope slopeAt(const TexelReader& reader, vec2 texel, const Float4& wanted) {
  const float h = kGradientStep;
  const Float4 dx = readAt(reader, texel + vec2(h, 0)) - readAt(reader, texel - vec2(h, 0));
  const Float4 dy = readAt(reader, texel + vec2(0, h)) - readAt(reader, texel - vec2(0, h));
  const Float4 off = readAt(reader, texel) - wanted;  // dx, dy are over 2 h = 1 pixel
  return {sumOf(dx * dx), sumOf(dx * dy), sumOf(dy * dy), sumOf(dx * off), sumOf(dy * off)};
}

void addSample(const DisplacementLattice::Weights& at, const Slope& slope, Equations& out) {
  for (int a = 0; a < 4; ++a) {
    const auto row = static_cast<Eigen::Index>(2 * at.node[a]);
    out.right(row) -= at.weight[a] * slope.x;
    out.right(row + 1) -= at.weight[a] * slope.y;
    for (int b = 0; b < 4; ++b) {
      const auto column = static_cast<Eigen::Index>(2 * at.node[b]);
      const float w = at.weight[a] * at.weight[b];
      out.matrix(row, column) += w * slope.xx;
      out.matrix(row, column + 1) += w * slope.xy;
      out.matrix(row + 1, column) += w * slope.xy;
      out.matrix(row + 1, column + 1) += w * slope.yy;
    }
  }
}

// A spring of the given stiffness between two nodes, or from a node to where it would be.
void addSpring(std::span<const vec2> nodes, std::size_t a, std::size_t b, float stiffness,
               Equations& out) {
  const vec2 apart = b == a ? nodes[a] : nodes[a] - nodes[b];
  for (int axis = 0; axis < 2; ++axis) {
    const auto i = static_cast<Eigen::Index>(2 * a) + axis,
               j = static_cast<Eigen::Index>(2 * b) + axis;
    out.matrix(i, i) += stiffness;
    out.right(i) -= stiffness * apart[axis];
    if (b == a) continue;
    out.matrix(j, j) += stiffness;
    out.matrix(i, j) -= stiffness;
    out.matrix(j, i) -= stiffness;
    out.right(j) += stiffness * apart[axis];
  }
}

void addSprings(const DisplacementLattice& lattice, float smoothness, float decay, Equations& out) {
  const auto columns = static_cast<std::size_t>(lattice.columns());
  const auto rows = static_cast<std::size_t>(lattice.rows());
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x) {
      const std::size_t node = y * columns + x;
      addSpring(lattice.nodes(), node, node, decay, out);
      if (x + 1 < columns) addSpring(lattice.nodes(), node, node + 1, smoothness, out);
      if (y + 1 < rows) addSpring(lattice.nodes(), node, node + columns, smoothness, out);
    }
}

// A border on one level of the swatch's stack.
class BorderFit {
 public:
  BorderFit(const TexelReader& reader, std::span<const BorderSample> samples, vec2 placement)
      : reader_(reader), samples_(samples), placement_(placement) {
    wanted_.reserve(samples.size());
    for (const BorderSample& sample : samples) wanted_.push_back(readAt(reader, sample.texel));
  }

  // Root mean square per channel; 0 of no samples.
  float difference(const DisplacementLattice& lattice) const {
    if (samples_.empty()) return 0;
    float sum = 0;
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      const vec2 place = samples_[s].place;
      const Float4 off = readAt(reader_, placement_ + place + lattice.at(place)) - wanted_[s];
      sum += sumOf(off * off);
    }
    return std::sqrt(sum / (3 * static_cast<float>(samples_.size())));
  }

  float step(const RelaxationOptions& options, DisplacementLattice& lattice) const;

 private:
  const TexelReader& reader_;
  const std::span<const BorderSample> samples_;
  const vec2 placement_;
  std::vector<Float4> wanted_;
};

// How far the node that moved most did, pixels. The springs are as stiff as options say when the
// samples of each node have, on the mean, the slopes that all have.
float BorderFit::step(const RelaxationOptions& options, DisplacementLattice& lattice) const {
  const std::span<vec2> nodes = lattice.nodes();
  Equations equations(nodes.size());
  float trace = 0;
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    const DisplacementLattice::Weights at = lattice.weightsAt(samples_[s].place);
    const vec2 texel = placement_ + samples_[s].place + lattice.at(samples_[s].place);
    const Slope slope = slopeAt(reader_, texel, wanted_[s]);
    trace += slope.xx + slope.yy;
    addSample(at, slope, equations);
  }
  if (!(trace > 0)) return 0;
  const float scale = trace / (2 * static_cast<float>(nodes.size()));
  addSprings(lattice, options.smoothness * scale, options.decay * scale, equations);
  const Eigen::VectorXf moves = equations.matrix.llt().solve(equations.right);
  float most = 0;
  for (std::size_t node = 0; node < nodes.size(); ++node) {
    const auto row = static_cast<Eigen::Index>(2 * node);
    const vec2 to =
        glm::clamp(nodes[node] + vec2(moves(row), moves(row + 1)), -options.most, options.most);
    most = std::max({most, std::abs(to.x - nodes[node].x), std::abs(to.y - nodes[node].y)});
    nodes[node] = to;
  }
  return most;
}

PlacementBox boxOf(std::span<const BorderSample> samples) {
  PlacementBox box{samples[0].place, samples[0].place};
  for (const BorderSample& sample : samples)
    box.low = glm::min(box.low, sample.place), box.high = glm::max(box.high, sample.place);
  return box;
}

}  // namespace

DisplacementLattice::DisplacementLattice(const PlacementBox& box, float cell) : low_(box.low) {
  const vec2 size = glm::max(box.high - box.low, vec2(1e-3f));
  const vec2 cells = glm::clamp(glm::ceil(size / cell), vec2(1), vec2(kMostCells));
  perPixel_ = cells / size;
  columns_ = static_cast<int>(cells.x) + 1, rows_ = static_cast<int>(cells.y) + 1;
  nodes_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), vec2(0));
}

DisplacementLattice::Weights DisplacementLattice::weightsAt(vec2 place) const {
  const vec2 last(columns_ - 1, rows_ - 1);
  const vec2 at = glm::clamp((place - low_) * perPixel_, vec2(0), last);
  const vec2 whole = glm::min(glm::floor(at), last - 1.f);
  const vec2 part = at - whole;
  const std::size_t first = static_cast<std::size_t>(whole.y) * static_cast<std::size_t>(columns_) +
                            static_cast<std::size_t>(whole.x);
  const std::size_t below = first + static_cast<std::size_t>(columns_);
  return {
      {first, first + 1, below, below + 1},
      {(1 - part.x) * (1 - part.y), part.x * (1 - part.y), (1 - part.x) * part.y, part.x * part.y}};
}

vec2 DisplacementLattice::at(vec2 place) const {
  if (nodes_.empty()) return vec2(0);
  const Weights w = weightsAt(place);
  vec2 sum(0);
  for (int a = 0; a < 4; ++a) sum += w.weight[a] * nodes_[w.node[a]];
  return sum;
}

Relaxation relaxBorder(const TexelReader& coarse, const TexelReader& fine,
                       std::span<const BorderSample> samples, vec2 placement,
                       const RelaxationOptions& options) {
  Relaxation out;
  if (samples.empty()) return out;
  const BorderFit seen(fine, samples, placement), blurred(coarse, samples, placement);
  out.before = out.after = seen.difference({});
  DisplacementLattice lattice(boxOf(samples), options.cell);
  for (const BorderFit* fit : {&blurred, &seen})
    for (int s = 0; s < kSteps; ++s) {
      const float moved = fit->step(options, lattice);
      const float error = seen.difference(lattice);
      if (error < out.after) out.after = error, out.lattice = lattice;
      if (moved < kSettled) break;
    }
  return out;
}

}  // namespace dapple
