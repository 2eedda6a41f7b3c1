#include "app/cli/picture.h"

#include <charconv>

#include "app/render/camera.h"
#include "app/render/cpu_splatter.h"
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

// OpenGL without a display is OpenGL in software, which takes ten times as long.
bool usesOpenGl(const std::string& renderer) {
  if (renderer == "gl") return true;
  if (renderer == "auto" || renderer == "cpu") return false;
  throw InvalidInput(
      fmt::format("--renderer: '{}' is not allowed; choose one of auto|gl|cpu", renderer));
}

}  // namespace

Image drawPicture(const PictureInput& input, const PictureOptions& options, Workers& workers) {
  std::vector<vec3> positions = input.points.positions, normals = input.points.normals;
  if (options.zUp) {
    for (vec3& p : positions) p = yUp(p);
    for (vec3& n : normals) n = yUp(n);
  }
  const ViewColours view = viewColours(options.show, input.columns);
  const Camera camera = cameraFor(input, positions, options);
  const std::vector<float> radii = splatRadii(input.localSpacing);
  const SplatColumns columns{
      .positions = positions, .normals = normals, .colours = view.colours, .radii = radii};
  const bool small = std::max(options.width, options.height) <= kSupersampleUpTo;
  const SplatOptions splats{.shading = options.shading, .samples = small ? 2 : 1};
  Image picture;
  if (usesOpenGl(options.renderer)) {
    const OffscreenContext context;
    SplatRenderer renderer;
    renderer.update(columns);
    picture = renderer.draw(camera, options.width, options.height, splats);
  } else {
    CpuSplatter splatter(workers);
    splatter.update(columns);
    Raster raster;
    splatter.draw(camera, options.width, options.height, splats, raster);
    picture = toImage(raster);
  }
  if (view.legend) drawLegend(picture, *view.legend);
  return picture;
}

void checkPicture(const PictureOptions& options) {
  usesOpenGl(options.renderer);
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
