// Where a picture is taken from.
#pragma once

#include <glm/glm.hpp>
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

// A standard view ("front", "back", "left", "right", "top", "iso") as near as the bounds fit into
// a picture of the given aspect (width / height), with a margin of 4 % of the picture. y is up;
// front looks along -z (x to the right), right along -x, top along -y with the front below, iso
// from (1, 1, 1). Throws InvalidInput for another name.
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

}  // namespace dapple
