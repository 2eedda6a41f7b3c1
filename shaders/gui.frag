// ImGui's triangles: one texture times one colour.

uniform sampler2D image;

in vec2 textureUv;
in vec4 tint;

out vec4 result;

void main() {
  result = tint * texture(image, textureUv);
}
