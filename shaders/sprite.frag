// A fragment of a sprite.vert. VISIBILITY writes the depth alone, moved back; otherwise
// (colour * weight, weight) is added up.

flat in vec4 ellipse;
flat in vec4 plane;
#ifndef VISIBILITY
flat in vec3 tint;
#ifdef TEXTURED
flat in vec4 texelSteps;
flat in vec3 texelAt;
uniform sampler2D swatch;
uniform vec2 perSwatchSize;
#endif
layout(location = 0) out vec4 accumulated;
#endif

void main() {
  vec2 d = gl_FragCoord.xy - ellipse.xy;
  float inDisc = (ellipse.z * d.x + ellipse.w * d.y) * d.x + plane.x * d.y * d.y;
  float squared = min(inDisc, dot(d, d) * plane.y);
#ifdef PLANE
  float depth = gl_FragCoord.z + dot(plane.zw, d);
#endif
#ifdef VISIBILITY
#ifdef PLANE
  gl_FragDepth = squared <= 1.0 ? depth : 1.0;
#else
  if (squared > 1.0) discard;
#endif
#else
#ifdef PLANE
  gl_FragDepth = depth;
#endif
  vec3 shownColour = tint;
#ifdef TEXTURED
  if (texelAt.z > 0.0) {
    vec2 texel = texelAt.xy + texelSteps.xy * d.x + texelSteps.zw * d.y;
    shownColour *= textureLod(swatch, texel * perSwatchSize, 0.0).rgb;
  }
#endif
  accumulated = vec4(shownColour, 1.0) * kernel(squared);
#endif
}
