// One triangle over the whole frame.

uniform vec2 size;  // pixels
uniform vec3 background;

out vec2 pixel;  // in what was added up, not in what is drawn into
flat out vec3 behind;

void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
  pixel = size * corner;
  behind = background;
}
