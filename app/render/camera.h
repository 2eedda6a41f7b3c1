// Where a picture is taken from.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "points/point_set.h"

namespace dapple {

struct Camera {
  glm::vec3 eye{0, 0, 3}, target{0}, up{0, 1, 0};  // local coordinates of the PointSet
  float verticalFov = 0.6f;                        // radians
  // Above 0 the projection is orthographic and this much of the scene is seen from the picture's
  // bottom to its top, local units; verticalFov is not used then.
  float orthographicHeight = 0;
  float nearPlane = 0.01f, farPlane = 100.f;  // distances along the view axis

  bool operator==(const Camera&) const = default;
};

struct Bounds {
  glm::vec3 low{0}, high{0};
};
// Zero when there are no positions.
Bounds boundsOf(const std::vector<vec3>& positions);

// "front", "back", "left", "right", "top", "bottom", "iso": y is up; front looks along -z (x to the
// right), right along -x, top along -y with the front below, bottom along y with the front above,
// iso from (1, 1, 1).
struct ViewDirection {
  std::string_view name;
  vec3 back;  // from the target to the eye
  vec3 up;    // not along back
};
// Throws InvalidInput for another name.
const ViewDirection& viewDirection(std::string_view name);
// All names with `separator` between them.
std::string viewDirectionNames(std::string_view separator);

// As near as the positions (at least one) fit into a picture of the given aspect (width / height),
// with a margin of 4 % of the picture; seen from where direction.back points, by perspective.
Camera framedView(const ViewDirection& direction, const std::vector<vec3>& positions, float aspect,
                  float verticalFov = Camera{}.verticalFov);

// The view of that name, so that the bounds' corners fit. Throws InvalidInput.
Camera standardView(std::string_view name, const Bounds& bounds, float aspect);
// The same, fitted to the positions themselves: nearer where they leave the bounds' corners empty.
Camera standardView(std::string_view name, const std::vector<vec3>& positions, float aspect);

// From eye towards target, y up unless that is the direction of view (then -z, or z from below),
// with planes that enclose the bounds. Throws InvalidInput when eye and target are the same.
Camera lookAt(vec3 eye, vec3 target, const Bounds& bounds);

// The same direction without perspective, as near as the positions (at least one) fit, with the
// margin of standardView().
Camera orthographicView(const Camera& camera, const std::vector<vec3>& positions, float aspect);

// Rigid: the eye at the origin, x to the right, y up, looking along -z.
glm::mat4 viewMatrix(const Camera& camera);

std::vector<vec3> cornersOf(const Bounds& bounds);

struct Ray {
  vec3 origin;     // the eye; without perspective beside it
  vec3 direction;  // unit length
};

// A camera and the picture that it takes, ready for many points. Pixels are the picture's own
// (framebuffer pixels, whatever the scale of the user interface), from its upper left corner, x to
// the right and y down: the first pixel's centre is (0.5, 0.5). Depths are along the view axis.
struct PixelView {
  PixelView(const Camera& camera, int pixelsWide, int pixelsHigh);

  // x, y: pixel, z: depth. What lies at or behind the eye has a depth of 0 or less and no pixel.
  vec3 project(const vec3& p) const;
  vec3 unproject(vec2 pixel, float depth) const;
  Ray rayThrough(vec2 pixel) const;
  // Of what lies across the view axis at that depth.
  float pixelsPerUnit(float depth) const { return orthographic ? focal : focal / depth; }
  float unitsPerPixel(float depth) const { return orthographic ? unit : unit * depth; }
  // Unit vector from p towards the eye.
  vec3 towardsEye(const vec3& p) const;

  int width, height;
  vec3 eye, right, down, forward;
  float focal, unit;  // pixels at depth 1, or orthographic: pixels per local unit; 1 / focal
  bool orthographic;
  float nearest, farthest;
};

// The same for one point or pixel.
inline vec3 projectPoint(const Camera& camera, int width, int height, const vec3& p) {
  return PixelView(camera, width, height).project(p);
}
inline Ray rayThrough(const Camera& camera, int width, int height, vec2 pixel) {
  return PixelView(camera, width, height).rayThrough(pixel);
}

}  // namespace dapple
