#include "points/tangent_frames.h"

#include <cmath>
#include <numbers>

#include "base/hash_rng.h"

namespace dapple {
namespace {

constexpr float kTooSteep = 0.15f;  // shortest projection of an axis that still gives a direction

}  // namespace

TangentFrame orthonormalFrame(const vec3& n, const vec3& t) {
  TangentFrame frame;
  frame.n = n * (1 / glm::length(n));
  vec3 flat = t - frame.n * glm::dot(frame.n, t);
  if (!(glm::dot(flat, flat) > 1e-12f * glm::dot(t, t))) {
    const vec3 axis = std::abs(frame.n.x) < 0.6f ? vec3(1, 0, 0) : vec3(0, 1, 0);
    flat = axis - frame.n * glm::dot(frame.n, axis);
  }
  frame.t = flat * (1 / glm::length(flat));
  frame.s = glm::cross(frame.t, frame.n);
  return frame;
}

std::vector<TangentFrame> framesTowards(const PointSet& points, const vec3& up) {
  const vec3 axes[] = {up / glm::length(up), vec3(0, 0, 1), vec3(1, 0, 0)};
  std::vector<TangentFrame> frames(points.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const vec3 n = points.normals[i];
    for (const vec3& axis : axes) {
      frames[i] = orthonormalFrame(n, axis);
      if (glm::length(glm::cross(axis, n)) > kTooSteep) break;
    }
  }
  return frames;
}

std::vector<TangentFrame> randomFrames(const PointSet& points, std::uint64_t seed) {
  std::vector<TangentFrame> frames(points.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const TangentFrame any = orthonormalFrame(points.normals[i], vec3(0, 1, 0));
    const float angle = 2 * std::numbers::pi_v<float> * hashUniform(seed, i, 7);
    frames[i].n = any.n;
    frames[i].t = std::cos(angle) * any.t + std::sin(angle) * any.s;
    frames[i].s = glm::cross(frames[i].t, any.n);
  }
  return frames;
}

vec3 transported(const vec3& t, const vec3& from, const vec3& to) {
  const vec3 axis = glm::cross(from, to);
  const vec3 turned = glm::cross(axis, t);
  return t + turned + glm::cross(axis, turned) / (1 + glm::dot(from, to));
}

}  // namespace dapple
