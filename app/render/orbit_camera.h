// The window's camera, a value: it turns around a pivot, and what the hand holds stays under the
// cursor. Pixels are those of the picture (framebuffer pixels, not scaled by the user interface),
// from its upper left corner, y down.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "app/render/camera.h"

namespace dapple {

struct Viewport {
  int width = 1, height = 1;  // pixels
};

// Turntable keeps the horizon level and stops at the poles; Trackball turns freely.
enum class OrbitStyle { Turntable, Trackball };

struct OrbitCamera {
  vec3 pivot{0};                      // local coordinates
  glm::quat orientation{1, 0, 0, 0};  // from the camera's axes (x right, y up, z back) to local
  vec3 offset{0, 0, 3};               // of the eye from the pivot, the camera's axes; z > 0
  vec3 up{0, 1, 0};                   // unit: the turntable's axis and the scan's vertical
  float verticalFov = Camera{}.verticalFov;  // radians
  bool orthographic = false;                 // then what lies as deep as the pivot keeps its size

  // Turns around the pivot, whose pixel stays. A drag as long as the picture is high is half a
  // turn.
  void orbit(vec2 drag, Viewport viewport, OrbitStyle style = OrbitStyle::Turntable);
  // Clockwise turn of the picture around its centre, radians.
  void roll(float angle);
  // Moves the eye and the pivot: what lies as deep as the pivot moves with the cursor.
  void pan(vec2 drag, Viewport viewport);
  // One step comes nearer by a tenth (negative: away). `surface`, or else the point under the
  // cursor as deep as the pivot, keeps its pixel and is never passed.
  void zoom(float steps, vec2 cursor, Viewport viewport, std::optional<vec3> surface = {});

  // Turns around the pivot to one of camera.h's directions, with `up` as their y. Throws
  // InvalidInput.
  void setView(std::string_view name);
  // Comes as near as the positions or the bounds fit into the picture, in the same direction; their
  // middle becomes the pivot. Nothing happens without positions.
  void frame(const std::vector<vec3>& positions, Viewport viewport);
  void frame(const Bounds& bounds, Viewport viewport);
  // Another point to turn around, in front of the eye: the picture stays as it is.
  void setPivot(const vec3& point);
  // Perspective or not: what lies as deep as the pivot keeps its pixel and size.
  void toggleProjection() { orthographic = !orthographic; }

  // The picture's camera, with planes around the bounds: of what lies before the eye nothing is
  // cut off, but in perspective what is much nearer than the pivot.
  Camera camera(const Bounds& bounds) const;
  // Where the cursor points, as deep as the pivot.
  vec3 pointAtPivotDepth(vec2 cursor, Viewport viewport) const;
};

// From a (t = 0) to b (t = 1): directions at an even rate, distances by even factors, and a zoom to
// a point keeps the point's pixel all the way. The projection is b's from t > 0 on.
OrbitCamera interpolate(const OrbitCamera& a, const OrbitCamera& b, float t);

}  // namespace dapple
