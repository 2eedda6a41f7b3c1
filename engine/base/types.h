// Scalars, vectors and ids that every part of the engine shares.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

namespace dapple {

using glm::dvec3;
using glm::ivec2;
using glm::vec2;
using glm::vec3;

// A point's position in its PointSet. Sizes and offsets are size_t (64 bits); only stored ids are
// 32 bits wide, so that n x k neighbour tables stay small. Loaders refuse larger scans by name.
using Index = std::uint32_t;
inline constexpr Index kNone = std::numeric_limits<Index>::max();

}  // namespace dapple
