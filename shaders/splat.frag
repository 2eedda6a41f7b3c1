// A fragment of a splat: where its ray meets the disc, how much it counts, how deep it lies.
// VISIBILITY writes the depth alone, moved back; otherwise (colour * weight, weight) is added up.

in Splat {
  flat vec3 centre;
  flat float radius;
  flat vec3 normal;
  flat float offset;
  flat vec3 colour;
  flat float reach;
  flat vec2 pixel;
  flat vec2 texel;
  flat vec3 swatchS;
  flat vec3 swatchT;
  flat float light;
}
splat;

uniform vec2 focal;
uniform bool orthographic;
uniform vec2 tileOrigin;  // of the frame, pixels from the view axis
uniform vec2 depthRange;
uniform float lowPass;
uniform sampler2D swatch;
uniform vec2 swatchSize;  // pixels

#ifndef VISIBILITY
layout(location = 0) out vec4 accumulated;
#endif

// The Gaussian's exponent at the disc's rim: with radii of 1.2 spacings its standard deviation is
// half a spacing, which is about as narrow as it can be before the single points show.
const float kFalloff = 2.5;
const float kRim = exp(-kFalloff);
const float kLeast = 1e-3;  // so that a disc alone is seen to its rim
const float kNever = 1e30;

void main() {
  vec2 pixel = gl_FragCoord.xy + tileOrigin;
  vec3 from = orthographic ? vec3(pixel / focal, 0.0) : vec3(0.0);
  vec3 ray = orthographic ? vec3(0.0, 0.0, -1.0) : vec3(pixel / focal, -1.0);
  float centreDepth = -splat.centre.z;

  float along = dot(splat.normal, ray);
  float t = abs(along) > 1e-9 ? dot(splat.normal, splat.centre - from) / along : -1.0;
  vec3 fromCentre = (from + t * ray - splat.centre) / splat.radius;
  float inDisc = t > 0.0 ? dot(fromCentre, fromCentre) : kNever;
  vec2 fromPixel = (pixel - splat.pixel) / lowPass;
  float onScreen = dot(fromPixel, fromPixel);
  float d = min(inDisc, onScreen);
  if (!(d <= 1.0)) discard;

  // Beyond the disc its plane says nothing: seen edge-on it would come far too near, and hide
  // what belongs there (dark cracks).
  float depth = t > 0.0 ? clamp(t, centreDepth - splat.reach, centreDepth + splat.reach)
                        : centreDepth;
#ifdef VISIBILITY
  depth += splat.offset;
#else
  vec3 colour = splat.colour;
  if (splat.light >= 0.0 && t > 0.0) {
    vec3 there = from + t * ray - splat.centre;
    // Image rows run down.
    vec2 texel = splat.texel + vec2(dot(there, splat.swatchS), -dot(there, splat.swatchT));
    colour = splat.light * textureLod(swatch, texel / swatchSize, 0.0).rgb;
  }
  accumulated = vec4(colour, 1.0) * max(exp(-kFalloff * d) - kRim, kLeast);
#endif
  gl_FragDepth = clamp((depth - depthRange.x) / (depthRange.y - depthRange.x), 0.0, 1.0);
}
