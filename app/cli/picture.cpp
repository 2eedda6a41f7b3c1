#include "app/cli/picture.h"

#include <charconv>

#include "app/render/camera.h"
#include "app/render/legend.h"
#include "app/render/offscreen.h"
#include "app/render/splat_renderer.h"
#include "base/errors.h"

namespace dapple {
namespace {

constexpr int kLargest = 8192;
constexpr int kSupersampleUpTo = 2048;  // pixels a side; beyond, the outlines are fine enough

vec3 yUp(const vec3& v) {
  return {v.x, v.z, -v.y};
}

Camera cameraFor(const PictureInput& input, const std::vector<vec3>& positions,
                 const PictureOptions& options) {
  if (!options.eye || !options.target)
    return standardView(options.view, positions,
                        static_cast<float>(options.width) / static_cast<float>(options.height));
  auto local = [&](const vec3& model) {
    const vec3 p((dvec3(model) - input.points.origin) / input.points.modelUnits);
    return options.zUp ? yUp(p) : p;
  };
  return lookAt(local(*options.eye), local(*options.target), boundsOf(positions));
}

}  // namespace

Image drawPicture(const PictureInput& input, const PictureOptions& options) {
  std::vector<vec3> positions = input.points.positions, normals = input.points.normals;
  if (options.zUp) {
    for (vec3& p : positions) p = yUp(p);
    for (vec3& n : normals) n = yUp(n);
  }
  const ViewColours view = viewColours(options.show, input.columns);
  const Camera camera = cameraFor(input, positions, options);
  const OffscreenContext context;
  SplatRenderer renderer;
  renderer.update({.positions = positions,
                   .normals = normals,
                   .colours = view.colours,
                   .radii = splatRadii(input.localSpacing)});
  const bool small = std::max(options.width, options.height) <= kSupersampleUpTo;
  Image picture = renderer.draw(camera, options.width, options.height,
                                {.shading = options.shading, .samples = small ? 2 : 1});
  if (view.legend) drawLegend(picture, *view.legend);
  return picture;
}

void checkView(const PictureOptions& options) {
  if (!options.eye || !options.target) standardView(options.view, Bounds{}, 1);
}

void parseSize(const std::string& text, PictureOptions& options) {
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, options.width);
  bool good = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
  if (good) {
    const auto height = std::from_chars(width.ptr + 1, end, options.height);
    good = height.ec == std::errc() && height.ptr == end;
  }
  auto inRange = [](int size) { return size >= 1 && size <= kLargest; };
  if (!good || !inRange(options.width) || !inRange(options.height))
    throw InvalidInput(fmt::format(
        "--size: '{}' is not allowed; give WIDTHxHEIGHT in pixels, 1 to {} each", text, kLargest));
}

}  // namespace dapple
