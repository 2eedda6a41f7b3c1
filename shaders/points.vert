// Bare points of one pixel: what the benchmark compares splats with.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 colour;

uniform mat4 localToView;  // rigid
uniform vec2 focal;        // of half the picture's width and height
uniform vec2 depthRange;   // near, far

flat out vec3 shown;

void main() {
  vec3 c = (localToView * vec4(position, 1.0)).xyz;
  float depth = (-c.z - depthRange.x) / (depthRange.y - depthRange.x);
  gl_Position = vec4(focal * c.xy, (2.0 * depth - 1.0) * -c.z, -c.z);
  shown = colour;
}
