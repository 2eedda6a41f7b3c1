// Carries a point's flattened position and frame to a neighbour: [Zhang] Appendix A, corrected.
//
// The printed formulas are wrong in three places. (1) q: the position of P itself is missing, and
// the step is not stretched to |FP| although the text says that it is: steps across a bend come out
// short. (2) T_f as printed has length c, so that axes shrink from step to step; it is built here
// from two unit vectors perpendicular to N_f. (3) The sum that D_pos divides by is not that of the
// weights it sums with. The formulas hold for S x T = N only, which is not said anywhere.
#pragma once

#include <cmath>

#include "points/point_set.h"

namespace dapple {

// Steps steeper than this against the tangent plane (cosine of the angle to it) carry nothing.
inline constexpr float kSteepest = 0.01f;

struct Transfer {
  vec2 offset{0};   // from P to F, local units, x along the swatch's rows, y down (-t)
  vec3 n{0}, t{0};  // P's axes carried to F; s = t x n
  bool valid = true;
};

// `step` = F - P, of length `length` > 0.
inline Transfer transferAcross(const TangentFrame& at, const vec3& step, float length) {
  // V0 unit step, h its height over P's plane, c its cosine to that plane: the letters of the
  // paper.
  const vec3 V0 = step / length;
  const float h = glm::dot(V0, at.n);
  const float c = std::sqrt(std::max(0.f, 1 - h * h));
  Transfer out;
  if (!(c >= kSteepest)) {
    out.valid = false;
    return out;
  }
  const float alongS = glm::dot(V0, at.s), alongT = glm::dot(V0, at.t);
  const float stretch = length / c;
  out.offset = {stretch * alongS, -stretch * alongT};
  out.n = (at.n - h * V0) / c;
  const vec3 M = glm::cross(out.n, V0);
  out.t = (alongT * V0 + alongS * M) / c;
  return out;
}

// Right-handed orthonormal axes nearest to the given normal first and t second.
inline TangentFrame orthonormalFrame(const vec3& n, const vec3& t) {
  TangentFrame frame;
  frame.n = n / glm::length(n);
  const vec3 flat = t - frame.n * glm::dot(frame.n, t);
  frame.t = flat / glm::length(flat);
  frame.s = glm::cross(frame.t, frame.n);
  return frame;
}

}  // namespace dapple
