// Where a picture is taken from.
#pragma once

#include <glm/glm.hpp>
#include <string_view>

#include "points/point_set.h"

namespace dapple {

struct Camera {
  glm::vec3 eye{0, 0, 3}, target{0}, up{0, 1, 0};  // local coordinates of the PointSet
  float verticalFov = 0.6f;                        // radians
  float nearPlane = 0.01f, farPlane = 100.f;
};

struct Bounds {
  glm::vec3 low{0}, high{0};
};
Bounds boundsOf(const std::vector<vec3>& positions);

// A standard view ("front", "back", "left", "right", "top", "iso") that fits the bounds into a
// picture of the given aspect (width / height). y is up; front looks along -z. Throws InvalidInput
// for another name.
Camera standardView(std::string_view name, const Bounds& bounds, float aspect);

}  // namespace dapple
