// ImGui's triangles: pixels from the top left to clip space.

uniform vec2 toClip;  // 2 / width, -2 / height

layout(location = 0) in vec2 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 colour;

out vec2 textureUv;
out vec4 tint;

void main() {
  textureUv = uv;
  tint = colour;
  gl_Position = vec4(position * toClip + vec2(-1, 1), 0, 1);
}
