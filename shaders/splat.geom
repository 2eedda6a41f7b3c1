// The rectangle of a splat (centre and half size, pixels, in gl_Position) as two triangles: any
// size, and clipped by its corners, where a point sprite has a largest size and vanishes with its
// centre.

layout(points) in;
layout(triangle_strip, max_vertices = 4) out;

uniform vec4 viewport;  // lower left corner and size, pixels

#define SPLAT        \
  flat vec3 centre;  \
  flat float radius; \
  flat vec3 normal;  \
  flat float offset; \
  flat vec3 colour;  \
  flat float reach;  \
  flat vec2 pixel;   \
  flat vec2 texel;   \
  flat vec3 swatchS; \
  flat vec3 swatchT; \
  flat float light;

in Splat { SPLAT } given[];
out Splat { SPLAT } splat;

void corner(vec2 pixel) {
  splat.centre = given[0].centre;
  splat.radius = given[0].radius;
  splat.normal = given[0].normal;
  splat.offset = given[0].offset;
  splat.colour = given[0].colour;
  splat.reach = given[0].reach;
  splat.pixel = given[0].pixel;
  splat.texel = given[0].texel;
  splat.swatchS = given[0].swatchS;
  splat.swatchT = given[0].swatchT;
  splat.light = given[0].light;
  gl_Position = vec4((pixel - viewport.xy) / viewport.zw * 2.0 - 1.0, 0.0, 1.0);
  EmitVertex();
}

void main() {
  vec2 low = gl_in[0].gl_Position.xy - gl_in[0].gl_Position.zw;
  vec2 high = gl_in[0].gl_Position.xy + gl_in[0].gl_Position.zw;
  if (any(greaterThan(low, high)) || any(lessThan(high, viewport.xy)) ||
      any(greaterThan(low, viewport.xy + viewport.zw)))
    return;
  corner(low);
  corner(vec2(high.x, low.y));
  corner(vec2(low.x, high.y));
  corner(high);
  EndPrimitive();
}
