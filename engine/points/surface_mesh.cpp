#include "points/surface_mesh.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "base/hash_rng.h"

namespace dapple {
namespace {

// The uses of a sample's id as a source of randomness.
enum Draw : std::uint64_t { kOffset, kAlong, kAcross };

template <class Vector>
dvec3 doubledArea(const std::vector<Vector>& positions, const std::array<Index, 3>& triangle) {
  const dvec3 a(positions[triangle[0]]), b(positions[triangle[1]]), c(positions[triangle[2]]);
  return glm::cross(b - a, c - a);
}

// cumulative[i] is the area of the first i triangles.
std::vector<double> cumulativeAreas(const std::vector<dvec3>& positions, const SurfaceMesh& mesh) {
  std::vector<double> cumulative{0};
  cumulative.reserve(mesh.triangles.size() + 1);
  for (const auto& triangle : mesh.triangles)
    cumulative.push_back(cumulative.back() + glm::length(doubledArea(positions, triangle)) / 2);
  return cumulative;
}

// Uniform in the triangle (Turk 1990: the square root makes thin rows near the corner as rare as
// they are short).
dvec3 pointInside(const std::vector<dvec3>& positions, const std::array<Index, 3>& triangle,
                  double along, double across) {
  const dvec3 &a = positions[triangle[0]], &b = positions[triangle[1]], &c = positions[triangle[2]];
  return a + std::sqrt(along) * ((b - a) + across * (c - b));
}

}  // namespace

std::vector<vec3> vertexNormals(const std::vector<vec3>& positions, const SurfaceMesh& mesh) {
  std::vector<dvec3> sums(positions.size(), dvec3(0));
  for (const auto& triangle : mesh.triangles) {
    const dvec3 weighted = doubledArea(positions, triangle);
    for (const Index corner : triangle) sums[corner] += weighted;
  }
  std::vector<vec3> normals(positions.size(), vec3(0));
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double length = glm::length(sums[i]);
    if (length > 0) normals[i] = vec3(sums[i] / length);
  }
  return normals;
}

SurfaceSamples sampleMesh(const std::vector<dvec3>& positions, const SurfaceMesh& mesh,
                          std::size_t count, std::uint64_t seed) {
  const std::vector<double> cumulative = cumulativeAreas(positions, mesh);
  const double total = cumulative.back();
  if (!(total > 0) || !std::isfinite(total))
    throw InvalidInput(
        "the surface cannot be sampled: no triangle has an area. Leave out --samples to work on "
        "the vertices.");
  SurfaceSamples samples;
  samples.positions.reserve(count);
  samples.normals.reserve(count);
  // One offset for all strata: a triangle's share is then off by less than one sample.
  const double offset = hashUniform(seed, 0, kOffset);
  std::size_t t = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double target = (static_cast<double>(i) + offset) / static_cast<double>(count) * total;
    while (t + 1 < mesh.triangles.size() && cumulative[t + 1] <= target) ++t;
    const auto& triangle = mesh.triangles[t];
    samples.positions.push_back(pointInside(positions, triangle, hashUniform(seed, i, kAlong),
                                            hashUniform(seed, i, kAcross)));
    samples.normals.push_back(vec3(glm::normalize(doubledArea(positions, triangle))));
  }
  return samples;
}

}  // namespace dapple
