// One splat a vertex: into view space, its rectangle in the picture, and what its fragments share.
// Pixels are counted from the view axis, upwards and to the right; a frame may draw a tile only.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;  // (0, 0, 0): faces the eye
layout(location = 2) in vec3 colour;
layout(location = 3) in float radius;
layout(location = 4) in vec2 texel;    // swatch pixels; NaN: shows its colour
layout(location = 5) in vec3 swatchS;  // the swatch's axes, divided by a pixel's length
layout(location = 6) in vec3 swatchT;

uniform mat4 localToView;  // rigid
uniform vec2 focal;        // pixels; orthographic: pixels per local unit
uniform bool orthographic;
uniform vec4 viewport;     // lower left corner and size, pixels
uniform vec2 depthRange;   // near, far
uniform float lowPass;     // radius, pixels
uniform bool headlight;
uniform float longestStep;  // swatch pixels from pixel to pixel: where it is longer, the splat
                            // shows its colour; negative: all do

out Splat {
  flat vec3 centre;  // view space
  flat float radius;
  flat vec3 normal;  // view space
  flat float offset;  // by which visibility lies deeper
  flat vec3 colour;
  flat float reach;  // how far the disc's depth may lie from its centre's
  flat vec2 pixel;   // of the centre
  flat vec2 texel;
  flat vec3 swatchS;  // view space
  flat vec3 swatchT;
  flat float light;  // negative: shows its colour
}
splat;

const float kDepthOffset = 1.0;  // radii
const float kSteepest = 4.0;     // slope up to which a pixel's own depth is allowed for
const float kAmbient = 0.25;
const float kSlack = 0.0625;     // pixels, for the rasteriser that rounds corners

const vec4 kNowhere = vec4(2.0, 2.0, 2.0, 1.0);

// Centre and half size of the rectangle round the disc, pixels. Seen along x (y likewise), the
// plane through the eye and the picture's column s = s0 + d, where s0 is the centre's, touches the
// disc when (d c.z)^2 = r^2 |m - n (n.m)|^2 with m = (1, 0, s), the plane's normal. Solving for d
// instead of s keeps small far discs free of cancellation.
vec4 discBox(vec3 c, vec3 n, float r) {
  if (orthographic) return vec4(focal * c.xy, focal * r * sqrt(max(1.0 - n.xy * n.xy, 0.0)));
  vec2 s0 = c.xy / -c.z;
  float a = c.z * c.z - r * r * (1.0 - n.z * n.z);
  if (a <= 0.0) return vec4(viewport.xy + 0.5 * viewport.zw, 0.5 * viewport.zw);  // round the eye
  vec2 e = n.xy + s0 * n.z;
  vec2 b = r * r * (s0 - e * n.z);
  vec2 k = r * r * max(1.0 + s0 * s0 - e * e, 0.0);
  return vec4(focal * (s0 + b / a), focal * sqrt(b * b + a * k) / a);
}

vec4 withLowPass(vec4 box, vec2 pixel) {
  vec2 low = min(box.xy - box.zw, pixel - lowPass) - kSlack;
  vec2 high = max(box.xy + box.zw, pixel + lowPass) + kSlack;
  return vec4(0.5 * (low + high), 0.5 * (high - low));
}

// True when no step from pixel to pixel on the disc is longer than that.
bool showsSwatch(vec3 c, vec3 n, vec3 s, vec3 t) {
  vec3 ray = orthographic ? vec3(0.0, 0.0, -1.0) : c / -c.z;
  float far = orthographic ? 1.0 : -c.z;
  float nRay = dot(n, ray);
  nRay = abs(nRay) < 1e-4 ? 1e-4 : nRay;
  // How the depth of the plane, and with it the place on it, moves with the ray.
  vec3 x = far / focal.x * (vec3(1.0, 0.0, 0.0) - n.x / nRay * ray);
  vec3 y = far / focal.y * (vec3(0.0, 1.0, 0.0) - n.y / nRay * ray);
  vec2 perX = vec2(dot(x, s), dot(x, t)), perY = vec2(dot(y, s), dot(y, t));
  float longest = longestStep * longestStep;
  return longestStep >= 0.0 && dot(perX, perX) <= longest && dot(perY, perY) <= longest;
}

void main() {
  vec3 c = (localToView * vec4(position, 1.0)).xyz;
  vec3 toEye = orthographic ? vec3(0.0, 0.0, 1.0) : normalize(-c);
  vec3 n = mat3(localToView) * normal;
  n = dot(n, n) > 0.25 ? normalize(n) : toEye;

  float facing = abs(dot(n, toEye));
  float tilt = sqrt(max(1.0 - facing * facing, 0.0));
  float pixelSize = (orthographic ? 1.0 : -c.z) / focal.y;
  splat.centre = c;
  splat.radius = radius;
  splat.normal = n;
  splat.offset = kDepthOffset * radius +
                 lowPass * pixelSize * min(tilt / max(facing, 1e-3), kSteepest);
  float light = headlight ? mix(kAmbient, 1.0, facing) : 1.0;
  splat.colour = colour * light;
  splat.texel = texel;
  splat.swatchS = mat3(localToView) * swatchS;
  splat.swatchT = mat3(localToView) * swatchT;
  bool shown = texel.x == texel.x && showsSwatch(c, n, splat.swatchS, splat.swatchT);
  splat.light = shown ? light : -1.0;
  splat.reach = radius * sqrt(max(1.0 - n.z * n.z, 0.0));
  splat.pixel = orthographic ? focal * c.xy : focal * c.xy / -c.z;

  bool seen = -c.z >= depthRange.x && -c.z <= depthRange.y && radius > 0.0;
  vec4 box = withLowPass(discBox(c, n, radius), splat.pixel);
#ifdef SPRITES
  gl_Position = seen ? vec4((box.xy - viewport.xy) / viewport.zw * 2.0 - 1.0, 0.0, 1.0) : kNowhere;
  gl_PointSize = 2.0 * max(box.z, box.w);
#else
  gl_Position = seen ? box : vec4(viewport.xy, -1.0, -1.0);  // splat.geom makes the corners
#endif
}
