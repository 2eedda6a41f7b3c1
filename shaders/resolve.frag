// What was added up, divided by its weights, over the background.
uniform sampler2D accumulated;
uniform int samples;  // a picture's pixel is samples x samples of these
uniform vec3 background;

layout(location = 0) out vec4 colour;

void main() {
  vec3 sum = vec3(0.0);
  ivec2 corner = ivec2(gl_FragCoord.xy) * samples;
  for (int y = 0; y < samples; ++y)
    for (int x = 0; x < samples; ++x) {
      vec4 a = texelFetch(accumulated, corner + ivec2(x, y), 0);
      sum += a.a > 0.0 ? a.rgb / a.a : background;
    }
  colour = vec4(sum / float(samples * samples), 1.0);
}
