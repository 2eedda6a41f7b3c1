// Tangent directions as complex numbers: x + iy in a basis that the normal alone determines. A
// direction that counts as the same after an N-th of a turn is its N-th power, so that sums of
// such powers are sums of N-fold directions, whichever of the N is at hand.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace dapple {

struct TangentBasis {
  vec3 x, y;  // x cross y is the normal
};

// Without a branch, for any unit normal (Duff et al., Building an Orthonormal Basis, Revisited).
inline TangentBasis tangentBasis(const vec3& n) {
  const float sign = std::copysign(1.f, n.z);
  const float a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

inline vec2 product(const vec2& a, const vec2& b) {
  return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x};
}

inline vec2 conjugate(const vec2& a) {
  return {a.x, -a.y};
}

// `folds` is 1, 2 or 4.
inline vec2 power(vec2 a, int folds) {
  for (; folds > 1; folds /= 2) a = product(a, a);
  return a;
}

// Unit length; (0, 0) stays.
inline vec2 unit(const vec2& a) {
  const float length = std::sqrt(a.x * a.x + a.y * a.y);
  return length > 0 ? a * (1 / length) : a;
}

// The root of a unit power whose direction is nearest to a given one.
inline vec2 nearestRoot(const vec2& powered, int folds, const vec2& direction) {
  const float angle = std::atan2(powered.y, powered.x) / static_cast<float>(folds);
  vec2 root(std::cos(angle), std::sin(angle)), best = root;
  for (int turn = 1; turn < folds; ++turn) {
    root = folds == 2 ? -root : vec2(-root.y, root.x);
    if (glm::dot(root, direction) > glm::dot(best, direction)) best = root;
  }
  return best;
}

inline vec2 tangentNumber(const TangentBasis& basis, const vec3& direction) {
  return {glm::dot(basis.x, direction), glm::dot(basis.y, direction)};
}

inline vec2 tangentNumber(const vec3& normal, const vec3& direction) {
  return tangentNumber(tangentBasis(normal), direction);
}

inline vec3 tangentDirection(const vec3& normal, const vec2& number) {
  const TangentBasis basis = tangentBasis(normal);
  return number.x * basis.x + number.y * basis.y;
}

// The factor that carries directions at the normal `from` to `to`. The smallest rotation between
// them takes a tangent v to v - (v . to) (from + to) / (1 + from . to).
inline vec2 transport(const vec3& from, const vec3& to) {
  constexpr float kLeast = 1e-3f;  // opposite normals: any rotation is as good
  const TangentBasis a = tangentBasis(from), b = tangentBasis(to);
  const float leaning = glm::dot(a.x, to) / std::max(1 + glm::dot(from, to), kLeast);
  const vec2 turn(glm::dot(a.x, b.x) - leaning * glm::dot(from, b.x),
                  glm::dot(a.x, b.y) - leaning * glm::dot(from, b.y));
  const float length = std::sqrt(turn.x * turn.x + turn.y * turn.y);
  return length > 0 ? turn * (1 / length) : vec2(1, 0);
}

}  // namespace dapple
