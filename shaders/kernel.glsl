// How much a fragment counts at a squared distance from the splat's centre, 1 at the rim.

// exp(-2.5 d) - exp(-2.5) within 0.0013, which with radii of 1.2 spacings has a standard deviation
// of half a spacing: about as narrow as it can be before the single points show.
const vec4 kKernel = vec4(0.91664182, -1.54443346, 1.29660787, -0.47839974);
const float kLeast = 1e-3;  // so that a disc alone is seen to its rim

float kernel(float d) {
  float weight = (1.0 - d) * ((kKernel.x + kKernel.y * d) + d * d * (kKernel.z + kKernel.w * d));
  return d <= 1.0 ? max(weight, kLeast) : 0.0;
}
