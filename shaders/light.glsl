// What every splat's vertex shader shares: the camera, and the light on a splat.

uniform mat4 localToView;  // rigid
uniform vec2 focal;        // pixels; orthographic: pixels per local unit
uniform bool orthographic;
uniform vec2 depthRange;  // near, far
uniform float lowPass;    // radius, pixels
uniform int shading;      // 0 off, 1 headlight, 2 studio
uniform float skyBelow;
uniform vec3 towardsKey, keyLight, skyLight, rimLight;  // StudioLight, the direction of unit length
uniform float enlarge;    // of the radii
uniform float longestStep;  // swatch pixels from pixel to pixel: where it is longer, the splat
                            // shows its colour

const float kDepthOffset = 1.0;  // radii
const float kSteepest = 4.0;     // slope up to which a pixel's own depth is allowed for
const float kEdgeOn = 1e-4;      // least cosine between the disc's plane and the ray
const float kSlack = 0.0625;     // pixels, for the rasteriser that rounds corners
const float kAmbient = 0.25;

const vec4 kNowhere = vec4(2.0, 2.0, 2.0, 1.0);

// n: view space, either side; toEye: unit.
vec3 lightOn(vec3 n, vec3 toEye) {
  float facing = abs(dot(n, toEye));
  if (shading == 0) return vec3(1.0);
  if (shading == 1) return vec3(mix(kAmbient, 1.0, facing));
  n = dot(n, toEye) < 0.0 ? -n : n;
  float key = max(0.0, dot(n, towardsKey)), sky = mix(skyBelow, 1.0, 0.5 + 0.5 * n.y);
  float away = 1.0 - facing;
  return skyLight * sky + keyLight * key + rimLight * (away * away * away);
}

float depthIn(float depth) { return (depth - depthRange.x) / (depthRange.y - depthRange.x); }

// How much deeper visibility takes a disc to be, so that all splats of its surface pass.
float depthOffset(float radius, float facing, float pixelSize) {
  float tilt = sqrt(max(1.0 - facing * facing, 0.0));
  return kDepthOffset * radius + lowPass * pixelSize * min(tilt / max(facing, 1e-3), kSteepest);
}

// How the place seen on a disc's plane moves with the pixel: a step to the right, a step upwards.
struct Steps {
  vec3 x, y;
};
Steps discSteps(vec3 n, vec3 ray, float away) {
  float q = -dot(n, ray);
  q = abs(q) < kEdgeOn ? (q < 0.0 ? -kEdgeOn : kEdgeOn) : q;
  return Steps(away / focal.x * (vec3(1.0, 0.0, 0.0) + n.x / q * ray),
               away / focal.y * (vec3(0.0, 1.0, 0.0) + n.y / q * ray));
}

// Swatch pixels for a step; image rows run down.
vec2 texelStep(vec3 step, vec3 s, vec3 t) { return vec2(dot(step, s), -dot(step, t)); }

// Not where it has no texel (NaN), nor where a step from pixel to pixel is longer than allowed.
bool showsSwatch(vec2 texel, Steps steps, vec3 s, vec3 t) {
  vec2 x = texelStep(steps.x, s, t), y = texelStep(steps.y, s, t);
  float longest = longestStep * longestStep;
  return texel.x == texel.x && dot(x, x) <= longest && dot(y, y) <= longest;
}
