#include "app/render/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <span>
#include <string>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr float kMargin = 0.04f;        // of the picture, at each side
constexpr float kSmallestSize = 1e-4f;  // local units: a single point still gets a picture
constexpr int kHalvings = 14;           // to a fraction of a pixel
constexpr float kNearestPlane = 1e-3f;  // of the distance to the far plane

const ViewDirection kViews[] = {
    {"front", {0, 0, 1}, {0, 1, 0}}, {"back", {0, 0, -1}, {0, 1, 0}},
    {"left", {-1, 0, 0}, {0, 1, 0}}, {"right", {1, 0, 0}, {0, 1, 0}},
    {"top", {0, 1, 0}, {0, 0, -1}},  {"bottom", {0, -1, 0}, {0, 0, 1}},
    {"iso", {1, 1, 1}, {0, 1, 0}},
};

// Along one axis of the picture (x to the right, z towards the eye, k the frustum's slope) all
// points are inside when k (ez - z) >= |x - ex|: ex + k ez >= a = max(x + k z) and
// -ex + k ez >= b = max(-x + k z). The nearest such eye is at ez = (a + b) / 2k.
struct Fit {
  float slope;
  float a = -std::numeric_limits<float>::infinity(), b = a;

  void add(float x, float z) {
    a = std::max(a, x + slope * z);
    b = std::max(b, -x + slope * z);
  }
  float distance() const { return (a + b) / (2 * slope); }
};

// The eye is farther than one of the two directions needs: where it makes the picture's two margins
// equal in that direction too. To the right of that place the left margin is the smaller one.
vec2 centred(float distance, std::span<const vec3> points) {
  vec2 low(std::numeric_limits<float>::infinity()), high = -low;
  for (const vec3& q : points) {
    low = glm::min(low, vec2(q));
    high = glm::max(high, vec2(q));
  }
  for (int halving = 0; halving < kHalvings; ++halving) {
    const vec2 eye = 0.5f * (low + high);
    vec2 first(std::numeric_limits<float>::infinity()), last = -first;
    for (const vec3& q : points) {
      const vec2 seen = (vec2(q) - eye) / (distance - q.z);
      first = glm::min(first, seen);
      last = glm::max(last, seen);
    }
    for (int axis = 0; axis < 2; ++axis)
      (first[axis] + last[axis] > 0 ? low : high)[axis] = eye[axis];
  }
  return 0.5f * (low + high);
}

}  // namespace

Bounds boundsOf(const std::vector<vec3>& positions) {
  if (positions.empty()) return {};
  Bounds b{positions[0], positions[0]};
  for (const vec3& p : positions) {
    b.low = glm::min(b.low, p);
    b.high = glm::max(b.high, p);
  }
  return b;
}

const ViewDirection& viewDirection(std::string_view name) {
  for (const ViewDirection& v : kViews)
    if (v.name == name) return v;
  throw InvalidInput(fmt::format("There is no view named '{}'; choose one of {}.", name,
                                 viewDirectionNames(", ")));
}

std::string viewDirectionNames(std::string_view separator) {
  std::string names;
  for (const ViewDirection& v : kViews)
    names += fmt::format("{}{}", names.empty() ? "" : separator, v.name);
  return names;
}

std::vector<vec3> cornersOf(const Bounds& b) {
  std::vector<vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(
        {i & 1 ? b.high.x : b.low.x, i & 2 ? b.high.y : b.low.y, i & 4 ? b.high.z : b.low.z});
  return corners;
}

Camera framedView(const ViewDirection& direction, const std::vector<vec3>& points, float aspect,
                  float verticalFov) {
  const Bounds bounds = boundsOf(points);
  const vec3 back = glm::normalize(direction.back);
  const vec3 right = glm::normalize(glm::cross(direction.up, back));
  const vec3 up = glm::cross(back, right);
  const vec3 centre = 0.5f * (bounds.low + bounds.high);

  Camera camera{.verticalFov = verticalFov};
  const float slope = std::tan(0.5f * verticalFov) * (1 - 2 * kMargin);
  Fit across{slope * aspect}, upwards{slope};
  float nearest = -std::numeric_limits<float>::infinity(), farthest = -nearest;
  std::vector<vec3> turned;  // to the right, upwards, towards the eye
  turned.reserve(points.size());
  for (const vec3& p : points) {
    const vec3 d = p - centre;
    const vec3& q = turned.emplace_back(glm::dot(d, right), glm::dot(d, up), glm::dot(d, back));
    across.add(q.x, q.z);
    upwards.add(q.y, q.z);
    nearest = std::max(nearest, q.z);
    farthest = std::min(farthest, q.z);
  }
  const float distance = std::max({across.distance(), upwards.distance(), nearest + kSmallestSize});
  const vec2 shift = centred(distance, turned);
  const vec3 axis = centre + shift.x * right + shift.y * up;
  camera.eye = axis + distance * back;
  camera.target = axis;
  camera.up = up;
  camera.nearPlane = 0.5f * (distance - nearest);
  camera.farPlane = distance - farthest + 0.5f * (nearest - farthest) + camera.nearPlane;
  return camera;
}

Camera standardView(std::string_view name, const Bounds& bounds, float aspect) {
  return framedView(viewDirection(name), cornersOf(bounds), aspect);
}

Camera standardView(std::string_view name, const std::vector<vec3>& positions, float aspect) {
  if (positions.empty()) return standardView(name, Bounds{}, aspect);
  return framedView(viewDirection(name), positions, aspect);
}

Camera lookAt(vec3 eye, vec3 target, const Bounds& bounds) {
  if (!(glm::distance(eye, target) > 0))
    throw InvalidInput("The eye and the target are the same point; move one of them.");
  const vec3 forward = glm::normalize(target - eye);
  Camera camera{.eye = eye, .target = target};
  if (std::abs(forward.y) > 0.9999f) camera.up = {0, 0, forward.y < 0 ? -1.f : 1.f};

  float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
  for (const vec3& corner : cornersOf(bounds)) {
    const float z = glm::dot(corner - eye, forward);
    nearest = std::min(nearest, z);
    farthest = std::max(farthest, z);
  }
  camera.farPlane = std::max(1.05f * farthest, glm::distance(eye, target));
  camera.nearPlane = std::max(0.5f * nearest, kNearestPlane * camera.farPlane);
  return camera;
}

Camera orthographicView(const Camera& camera, const std::vector<vec3>& positions, float aspect) {
  const glm::mat4 view = viewMatrix(camera);
  vec3 low(std::numeric_limits<float>::infinity()), high = -low;
  for (const vec3& p : positions) {
    const vec3 q = view * glm::vec4(p, 1);
    low = glm::min(low, q);
    high = glm::max(high, q);
  }
  const vec3 size = high - low, middle = 0.5f * (low + high);
  const float height = std::max({size.y, size.x / aspect, kSmallestSize}) / (1 - 2 * kMargin);
  const float depth = std::max(size.z, height);
  const glm::mat3 axes(glm::transpose(glm::mat3(view)));  // right, up and back in local coordinates
  Camera out = camera;
  out.orthographicHeight = height;
  out.target = camera.eye + axes * middle;
  out.eye = out.target + axes * vec3(0, 0, depth);
  out.nearPlane = 0.4f * depth;
  out.farPlane = 1.6f * depth;
  return out;
}

glm::mat4 viewMatrix(const Camera& camera) {
  return glm::lookAt(camera.eye, camera.target, camera.up);
}

PixelView::PixelView(const Camera& camera, int pixelsWide, int pixelsHigh)
    : width(pixelsWide),
      height(pixelsHigh),
      eye(camera.eye),
      orthographic(camera.orthographicHeight > 0),
      nearest(camera.nearPlane),
      farthest(camera.farPlane) {
  const glm::mat4 m = viewMatrix(camera);
  right = {m[0][0], m[1][0], m[2][0]};
  down = {-m[0][1], -m[1][1], -m[2][1]};
  forward = {-m[0][2], -m[1][2], -m[2][2]};
  const auto high = static_cast<float>(height);
  focal = orthographic ? high / camera.orthographicHeight
                       : 0.5f * high / std::tan(0.5f * camera.verticalFov);
  unit = 1 / focal;
}

vec3 PixelView::project(const vec3& p) const {
  const vec3 d = p - eye;
  const float depth = glm::dot(d, forward), scale = pixelsPerUnit(depth);
  return {0.5f * static_cast<float>(width) + scale * glm::dot(d, right),
          0.5f * static_cast<float>(height) + scale * glm::dot(d, down), depth};
}

vec3 PixelView::unproject(vec2 pixel, float depth) const {
  const vec2 across = (pixel - 0.5f * vec2(width, height)) / pixelsPerUnit(depth);
  return eye + across.x * right + across.y * down + depth * forward;
}

Ray PixelView::rayThrough(vec2 pixel) const {
  if (orthographic) return {unproject(pixel, 0), forward};
  return {eye, glm::normalize(unproject(pixel, 1) - eye)};
}

vec3 PixelView::towardsEye(const vec3& p) const {
  return orthographic ? -forward : glm::normalize(eye - p);
}

}  // namespace dapple
