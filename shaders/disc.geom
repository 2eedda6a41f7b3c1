// The square round a disc, in the disc's own plane: its corners are exact in any perspective and
// clipped one by one, where a point sprite has a largest size and vanishes with its centre.

layout(points) in;
layout(triangle_strip, max_vertices = 4) out;

in Disc {
  vec3 centre;
  float radius;
  vec3 normal;
  vec3 tint;
#ifdef TEXTURED
  vec3 texel;
  vec3 swatchS;
  vec3 swatchT;
#endif
}
disc[];

uniform vec4 viewport;    // lower left corner and size, pixels
uniform vec2 tileOrigin;  // pixels

out vec2 onDisc;       // 1: the rim
flat out vec2 middle;  // of the disc, pixels of the tile
#ifndef VISIBILITY
flat out vec3 tint;
#ifdef TEXTURED
out vec2 texel;
flat out float shown;
#endif
#endif

const float kFarOut = 30.0;  // on a disc: its rim is nowhere near

float across(vec2 a, vec2 b) { return abs(a.x * b.y - a.y * b.x); }

void main() {
  vec3 c = disc[0].centre, n = disc[0].normal;
  float r = disc[0].radius;
  if (r <= 0.0) return;
  float away = orthographic ? 1.0 : -c.z;
  vec3 ray = orthographic ? vec3(0.0, 0.0, -1.0) : c / away;
  vec2 centre = focal * c.xy / away;

  // v lies across the view axis: the disc's depth changes along u alone.
  float flatness = dot(n.xy, n.xy);
  vec3 v = r * (flatness > 1e-12 ? vec3(-n.y, n.x, 0.0) * inversesqrt(flatness)
                                 : vec3(1.0, 0.0, 0.0));
  vec3 u = cross(v, n);
  // How they look; where one is narrower than the low-pass, the square is made longer on the
  // screen alone: beyond the disc its plane says nothing, and edge-on it would come far too near.
  vec2 s = orthographic ? vec2(0.0) : ray.xy;
  vec2 imageU = focal / away * (u.xy + s * u.z), imageV = focal / away * v.xy;
  float area = across(imageU, imageV);
  float lengthU = length(imageU), lengthV = max(length(imageV), 1e-20);
  float least = lowPass + kSlack;
  float longerU = 1.0, longerV = 1.0;
  bool extended = area < least * max(lengthU, lengthV);
  if (extended) {
    if (lengthV < least) {
      imageV *= least / lengthV;
      longerV = least / lengthV;
      area *= longerV;
      lengthV = least;
    }
    if (area < least * lengthV) {
      if (area * kFarOut < least * lengthV) {
        imageU = vec2(-imageV.y, imageV.x) * (least / lengthV);
        longerU = kFarOut;
      } else {
        longerU = least * lengthV / area;
        imageU *= longerU;
      }
    }
  }

  float perDepth = 1.0 / (depthRange.y - depthRange.x), offset = 0.0;
#ifdef VISIBILITY
  offset = depthOffset(r, abs(dot(n, ray)) * inversesqrt(dot(ray, ray)), away / focal.y);
#endif
  for (int k = 0; k < 4; ++k) {
    vec2 side = vec2(k & 1, k >> 1) * 2.0 - 1.0;
    vec3 corner = c + side.x * u + side.y * v;
    float w = orthographic || extended ? 1.0 : -corner.z;
    vec2 pixel = extended ? centre + side.x * imageU + side.y * imageV : focal * corner.xy;
    vec2 clip = ((pixel - viewport.xy * w) / viewport.zw) * 2.0 - w;
    float depth = (-corner.z + offset - depthRange.x) * perDepth;
    gl_Position = vec4(clip, (2.0 * depth - 1.0) * w, w);
    onDisc = side * vec2(longerU, longerV);
    middle = centre - tileOrigin;
#ifndef VISIBILITY
    tint = disc[0].tint;
#ifdef TEXTURED
    vec3 there = onDisc.x * u + onDisc.y * v;
    // Image rows run down.
    texel = disc[0].texel.xy +
            vec2(dot(there, disc[0].swatchS), -dot(there, disc[0].swatchT));
    shown = disc[0].texel.z;
#endif
#endif
    EmitVertex();
  }
  EndPrimitive();
}
