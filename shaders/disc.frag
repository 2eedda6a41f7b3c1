// A fragment of a disc.geom. VISIBILITY leaves the depth alone, which lies behind the disc;
// otherwise (colour * weight, weight) is added up.

in vec2 onDisc;
flat in vec2 middle;
uniform float perLowPass2;
#ifndef VISIBILITY
flat in vec3 tint;
#ifdef TEXTURED
in vec2 texel;
flat in float shown;
uniform sampler2D swatch;
uniform vec2 perSwatchSize;
#endif
layout(location = 0) out vec4 accumulated;
#endif

void main() {
  vec2 d = gl_FragCoord.xy - middle;
  float squared = min(dot(onDisc, onDisc), dot(d, d) * perLowPass2);
#ifdef VISIBILITY
  if (squared > 1.0) discard;
#else
  vec3 shownColour = tint;
#ifdef TEXTURED
  if (shown > 0.0) shownColour *= textureLod(swatch, texel * perSwatchSize, 0.0).rgb;
#endif
  accumulated = vec4(shownColour, 1.0) * kernel(squared);
#endif
}
