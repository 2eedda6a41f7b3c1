// A small splat as a point sprite: the image of its disc is taken to be an ellipse, with the
// perspective of its centre. Pixels are counted from the view axis, upwards and to the right, in
// 1/1024 so that taking a tile's origin away is exact.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;  // of any length; (0, 0, 0): faces the eye
layout(location = 2) in vec4 colour;  // alpha 0: plain, even with a texel
layout(location = 3) in float radius;
#ifdef TEXTURED
layout(location = 4) in vec2 texel;    // swatch pixels; NaN: shows its colour
layout(location = 5) in vec3 swatchS;  // the swatch's axes, divided by a pixel's length
layout(location = 6) in vec3 swatchT;
#endif

uniform vec4 viewport;    // lower left corner and size, pixels
uniform vec2 tileOrigin;  // pixels

// Software OpenGL reads a uniform sixteen times as slowly as these.
flat out vec4 ellipse;  // centre in the tile; of the squared distance (1 at the rim): x x, 2 x y
flat out vec4 plane;    // y y; the low-pass's; depth per pixel to the right and upwards
#ifndef VISIBILITY
flat out vec3 tint;
#ifdef TEXTURED
flat out vec4 texelSteps;  // by which the texel moves to the right, and upwards
flat out vec3 texelAt;     // z: 0 where the splat shows its colour
#endif
#endif

const float kGrid = 1024.0;

void main() {
  vec3 c = (localToView * vec4(position, 1.0)).xyz;
  float r = radius * enlarge;
  float away = orthographic ? 1.0 : -c.z;
  vec3 ray = orthographic ? vec3(0.0, 0.0, -1.0) : c / away;
  vec3 toEye = -normalize(ray);
  vec3 n = mat3(localToView) * normal;
  n = dot(n, n) > 0.0 ? normalize(n) : toEye;

  // Covariance of the image over the radius squared: J (I - n n^T) J^T; its determinant is q^2.
  float q = -dot(n, ray);
  q = abs(q) < kEdgeOn ? (q < 0.0 ? -kEdgeOn : kEdgeOn) : q;
  vec2 s = ray.xy, e = n.xy + s * n.z;
  vec2 variance = max(1.0 + s * s - e * e, 0.0);
  float covariance = s.x * s.y - e.x * e.y;
  float scale = focal.y * r / away;
  vec3 conic = vec3(variance.y, -2.0 * covariance, variance.x) / (scale * scale * q * q);

  vec2 centre = floor(focal * c.xy / away * kGrid + 0.5) / kGrid;
  vec2 halfSize = max(scale * sqrt(variance), lowPass) + kSlack;
  float facing = abs(q) * inversesqrt(dot(ray, ray));
  float perDepth = 1.0 / (depthRange.y - depthRange.x);
  vec2 slope = n.xy * (away / (focal.y * q)) * perDepth;
  // Beyond the disc its plane says nothing: seen edge-on it would come far too near, and hide what
  // belongs there (dark cracks). So the depth moves no further than it does on the disc.
  float reach = r * sqrt(max(1.0 - n.z * n.z, 0.0)) * perDepth;
  slope *= min(1.0, reach / max(length(slope) * lowPass, 1e-20));
  float depth = depthIn(-c.z);
  ellipse = vec4(centre - tileOrigin, conic.xy);
  plane = vec4(conic.z, 1.0 / (lowPass * lowPass), slope);
#ifdef VISIBILITY
  depth += depthOffset(r, facing, away / focal.y) * perDepth;
#else
  vec3 light = lightOn(n, toEye);
  tint = colour.rgb * light;
#ifdef TEXTURED
  Steps steps = discSteps(n, ray, away);
  vec3 sAxis = mat3(localToView) * swatchS, tAxis = mat3(localToView) * swatchT;
  texelSteps = vec4(texelStep(steps.x, sAxis, tAxis), texelStep(steps.y, sAxis, tAxis));
  bool shown = colour.a > 0.5 && showsSwatch(texel, steps, sAxis, tAxis);
  texelAt = vec3(shown ? texel : vec2(0.0), shown ? 1.0 : 0.0);
  if (shown) tint = light;
#endif
#endif

  bool seen = -c.z >= depthRange.x && -c.z <= depthRange.y && radius > 0.0;
  gl_Position = seen ? vec4((centre - viewport.xy) / viewport.zw * 2.0 - 1.0,
                            2.0 * min(depth, 1.0) - 1.0, 1.0)
                     : kNowhere;
  gl_PointSize = 2.0 * max(halfSize.x, halfSize.y);
}
