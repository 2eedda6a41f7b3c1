// What was added up, divided by its weights, over the background. SAMPLES: a picture's pixel is
// SAMPLES x SAMPLES of those.
uniform sampler2D accumulated;

in vec2 pixel;
flat in vec3 behind;

layout(location = 0) out vec4 colour;

vec3 shown(ivec2 place) {
  vec4 a = texelFetch(accumulated, place, 0);
  return a.a > 0.0 ? a.rgb / a.a : behind;
}

void main() {
  ivec2 at = ivec2(pixel);
#if SAMPLES == 1
  colour = vec4(shown(at), 1.0);
#else
  vec3 sum = vec3(0.0);
  for (int y = 0; y < SAMPLES; ++y)
    for (int x = 0; x < SAMPLES; ++x) sum += shown(at * SAMPLES + ivec2(x, y));
  colour = vec4(sum / float(SAMPLES * SAMPLES), 1.0);
#endif
}
