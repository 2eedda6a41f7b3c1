// A large splat, into view space; disc.geom makes its corners.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;  // of any length; (0, 0, 0): faces the eye
layout(location = 2) in vec4 colour;  // alpha 0: plain, even with a texel
layout(location = 3) in float radius;
#ifdef TEXTURED
layout(location = 4) in vec2 texel;    // swatch pixels; NaN: shows its colour
layout(location = 5) in vec3 swatchS;  // the swatch's axes, divided by a pixel's length
layout(location = 6) in vec3 swatchT;
#endif

out Disc {
  vec3 centre;
  float radius;  // negative: not drawn
  vec3 normal;
  vec3 tint;
#ifdef TEXTURED
  vec3 texel;  // z: 0 where the splat shows its colour
  vec3 swatchS;
  vec3 swatchT;
#endif
}
disc;

void main() {
  vec3 c = (localToView * vec4(position, 1.0)).xyz;
  vec3 ray = orthographic ? vec3(0.0, 0.0, -1.0) : c / -c.z;
  vec3 toEye = -normalize(ray);
  vec3 n = mat3(localToView) * normal;
  n = dot(n, n) > 0.0 ? normalize(n) : toEye;
  bool seen = -c.z >= depthRange.x && -c.z <= depthRange.y && radius > 0.0;
  disc.centre = c;
  disc.radius = seen ? radius * enlarge : -1.0;
  disc.normal = n;
  vec3 light = lightOn(n, toEye);
  disc.tint = colour.rgb * light;
#ifdef TEXTURED
  disc.swatchS = mat3(localToView) * swatchS;
  disc.swatchT = mat3(localToView) * swatchT;
  bool shown = colour.a > 0.5 && showsSwatch(texel, discSteps(n, ray, orthographic ? 1.0 : -c.z), disc.swatchS,
                           disc.swatchT);
  disc.texel = vec3(shown ? texel : vec2(0.0), shown ? 1.0 : 0.0);
  if (shown) disc.tint = light;
#endif
}
