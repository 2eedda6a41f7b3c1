// What was added up, divided by its weights, over the background. SAMPLES: a picture's pixel is
// SAMPLES x SAMPLES of those.
uniform sampler2D accumulated;
uniform ivec2 corner;  // of the picture in what is drawn into
uniform vec3 background;

layout(location = 0) out vec4 colour;

vec3 shown(ivec2 sample) {
  vec4 a = texelFetch(accumulated, sample, 0);
  return a.a > 0.0 ? a.rgb / a.a : background;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy) - corner;
#if SAMPLES == 1
  colour = vec4(shown(pixel), 1.0);
#else
  vec3 sum = vec3(0.0);
  for (int y = 0; y < SAMPLES; ++y)
    for (int x = 0; x < SAMPLES; ++x) sum += shown(pixel * SAMPLES + ivec2(x, y));
  colour = vec4(sum / float(SAMPLES * SAMPLES), 1.0);
#endif
}
