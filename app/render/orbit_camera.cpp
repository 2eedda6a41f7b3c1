#include "app/render/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace dapple {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kPerStep = 0.9f;  // of the distance that one zoom step leaves
// Of the eye from the pivot's plane, local units: nearer, floats are coarser than half a pixel;
// farther, a scan (1 to 2 across) is less than a pixel.
constexpr float kNearest = 5e-4f, kFarthest = 1e4f;
constexpr float kNearestFrame = 0.02f;  // of one point and its neighbours, not of one splat
constexpr float kUpsideDown = -1e-3f;   // along the vertical: at a pole it is 0 but for rounding
// Of the distance to the pivot: what is nearer to the eye is cut off. The depth buffer of OpenGL
// has floats, which bear that.
constexpr float kNearPlane = 0.01f;

glm::quat turn(float angle, const vec3& axis) {
  return glm::angleAxis(angle, axis);
}

// The smallest turn that brings y to `up`; half a turn around x when that is -y.
glm::quat fromYTo(const vec3& up) {
  if (up.y < -0.99999f) return turn(kPi, {1, 0, 0});
  const vec3 axis(up.z, 0, -up.x);  // y x up
  return glm::normalize(glm::quat(1 + up.y, axis.x, axis.y, axis.z));
}

// A turn by `angle` around the camera's right axis, stopped where its up axis becomes level: over
// the pole everything would be upside down. With a = up of the camera and b = back, each along the
// vertical, its up has a cos(angle) + b sin(angle) along it.
float stoppedAtPole(float angle, float a, float b) {
  if (std::hypot(a, b) < 1e-4f) return angle;  // rolled onto its side: there is no pole to reach
  const float middle = a < kUpsideDown ? std::atan2(-b, -a) : std::atan2(b, a);
  const float lowest = std::min(0.f, middle - kPi / 2), highest = std::max(0.f, middle + kPi / 2);
  return std::clamp(angle, lowest, highest);
}

float unitsPerPixel(const OrbitCamera& c, Viewport viewport) {
  return 2 * c.offset.z * std::tan(0.5f * c.verticalFov) / static_cast<float>(viewport.height);
}

}  // namespace

void OrbitCamera::orbit(vec2 drag, Viewport viewport, OrbitStyle style) {
  // The surface follows the hand: the camera turns the other way.
  const vec2 angles = -drag * (kPi / static_cast<float>(viewport.height));
  if (style == OrbitStyle::Trackball) {
    const float angle = glm::length(angles);
    if (!(angle > 0)) return;
    orientation = glm::normalize(orientation * turn(angle, vec3(angles.y, angles.x, 0) / angle));
    return;
  }
  const vec3 cameraUp = orientation * vec3(0, 1, 0), back = orientation * vec3(0, 0, 1);
  const float a = glm::dot(cameraUp, up), b = glm::dot(back, up);
  const float yaw = a < kUpsideDown ? -angles.x : angles.x;  // upside down too, it follows the hand
  const float pitch = stoppedAtPole(angles.y, a, b);
  orientation = glm::normalize(turn(yaw, up) * orientation * turn(pitch, {1, 0, 0}));
}

void OrbitCamera::roll(float angle) {
  orientation = glm::normalize(orientation * turn(angle, {0, 0, 1}));
  // Seen from the centre of the picture, not from the pivot: its pixel turns, too.
  const vec2 across(offset);
  offset.x = std::cos(angle) * across.x + std::sin(angle) * across.y;
  offset.y = std::cos(angle) * across.y - std::sin(angle) * across.x;
}

void OrbitCamera::pan(vec2 drag, Viewport viewport) {
  pivot += orientation * vec3(-drag.x, drag.y, 0) * unitsPerPixel(*this, viewport);
}

void OrbitCamera::zoom(float steps, vec2 cursor, Viewport viewport, std::optional<vec3> surface) {
  const vec3 fixed = surface ? *surface : pointAtPivotDepth(cursor, viewport);
  const float wanted = offset.z * std::pow(kPerStep, steps);
  const float factor = std::clamp(wanted, kNearest, kFarthest) / offset.z;
  // All distances from the fixed point shrink alike, so that its direction from the eye stays.
  pivot = fixed + factor * (pivot - fixed);
  offset *= factor;
}

void OrbitCamera::setView(std::string_view name) {
  const ViewDirection& view = viewDirection(name);
  const vec3 back = glm::normalize(view.back);
  const vec3 right = glm::normalize(glm::cross(view.up, back));
  const glm::mat3 axes(right, glm::cross(back, right), back);
  orientation = glm::normalize(fromYTo(up) * glm::quat_cast(axes));
}

void OrbitCamera::frame(const std::vector<vec3>& positions, Viewport viewport) {
  if (positions.empty()) return;
  const float aspect = static_cast<float>(viewport.width) / static_cast<float>(viewport.height);
  const ViewDirection direction{{}, orientation * vec3(0, 0, 1), orientation * vec3(0, 1, 0)};
  Camera fitted = framedView(direction, positions, aspect, verticalFov);
  float distance = glm::distance(fitted.eye, fitted.target);
  if (orthographic) {
    fitted = orthographicView(fitted, positions, aspect);
    distance = 0.5f * fitted.orthographicHeight / std::tan(0.5f * verticalFov);
  }
  pivot = fitted.target;
  offset = {0, 0, std::clamp(distance, kNearestFrame, kFarthest)};
}

void OrbitCamera::frame(const Bounds& bounds, Viewport viewport) {
  frame(cornersOf(bounds), viewport);
}

void OrbitCamera::setPivot(const vec3& point) {
  const float distance = offset.z;
  offset = glm::conjugate(orientation) * (pivot + orientation * offset - point);
  // Without perspective the eye may slide along its axis, and what counts is the scale.
  offset.z = orthographic ? distance : std::clamp(offset.z, kNearest, kFarthest);
  pivot = point;
}

Camera OrbitCamera::camera(const Bounds& bounds) const {
  const vec3 back = orientation * vec3(0, 0, 1);
  Camera out{.eye = pivot + orientation * offset, .verticalFov = verticalFov};
  float nearest = std::numeric_limits<float>::infinity(), farthest = -nearest;
  for (const vec3& corner : cornersOf(bounds)) {
    const float depth = glm::dot(out.eye - corner, back);
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  if (orthographic) {
    out.orthographicHeight = 2 * offset.z * std::tan(0.5f * verticalFov);
    // Where the eye lies along its axis is not seen: it stands back from all of the scan.
    const float room = std::max(farthest - nearest, offset.z);
    const float step = room - nearest;
    out.eye += step * back;
    nearest += step, farthest += step;
  }
  out.target = out.eye - std::max(offset.z, 1.f) * back;  // near, rounding would turn the camera
  out.up = orientation * vec3(0, 1, 0);
  const float least = kNearPlane * offset.z;
  out.nearPlane = std::max(0.5f * nearest, least);
  out.farPlane = std::max(1.05f * farthest, 2 * out.nearPlane);
  return out;
}

vec3 OrbitCamera::pointAtPivotDepth(vec2 cursor, Viewport viewport) const {
  const vec2 fromCentre = cursor - 0.5f * vec2(viewport.width, viewport.height);
  const float unit = unitsPerPixel(*this, viewport);
  return pivot +
         orientation * (vec3(fromCentre.x, -fromCentre.y, 0) * unit + vec3(offset.x, offset.y, 0));
}

OrbitCamera interpolate(const OrbitCamera& a, const OrbitCamera& b, float t) {
  if (!(t > 0)) return a;
  if (t >= 1) return b;
  OrbitCamera c = b;
  const float ratio = b.offset.z / a.offset.z, factor = std::pow(ratio, t);
  // Along the distances: a zoom moves pivot and eye in proportion to what is left of the distance.
  const float w = std::abs(ratio - 1) < 1e-3f ? t : (factor - 1) / (ratio - 1);
  c.orientation = glm::slerp(a.orientation, b.orientation, t);
  c.pivot = glm::mix(a.pivot, b.pivot, w);
  c.offset = glm::mix(a.offset, b.offset, w);
  c.verticalFov = glm::mix(a.verticalFov, b.verticalFov, t);
  c.up = glm::dot(a.up, b.up) > -0.99f ? glm::normalize(glm::mix(a.up, b.up, t)) : b.up;
  return c;
}

}  // namespace dapple
