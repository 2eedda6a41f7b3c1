#include "app/cli/picture.h"

#include <charconv>
#include <cmath>
#include <limits>

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

// Where the map says more than the colour: the texel of each point whose colour is the swatch's
// there, filtered or not. Blends, and points of another swatch, show their colours.
std::vector<vec2> plainTexels(const PictureInput& input) {
  constexpr float kSame = 2.5f / 255;  // files hold 8 bits
  const vec2 none(std::numeric_limits<float>::quiet_NaN());
  const std::vector<float> spacing = localSpacing(input.neighborhoods);
  std::vector<vec2> texels(input.map->texel);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const float blur = std::log2(std::max(1.f, spacing[i] / input.map->scale));
    const auto same = [&](float level) {
      const vec3 d =
          glm::abs(sampleSwatch(*input.swatch, texels[i], level) - input.columns.colours[i]);
      return std::max({d.r, d.g, d.b}) < kSame;
    };
    if (!same(0) && !same(blur)) texels[i] = none;
  }
  return texels;
}

// Whether the swatch is shown inside the splats.
bool usesTexels(const PictureInput& input, const PictureOptions& options) {
  if (options.texels != "auto" && options.texels != "on" && options.texels != "off")
    throw InvalidInput(
        fmt::format("--texels: '{}' is not allowed; choose one of auto|on|off", options.texels));
  const bool possible = input.map && input.swatch && input.map->scale > 0 &&
                        options.show == View::Colour && !input.columns.colours.empty();
  if (options.texels == "on" && !possible)
    throw InvalidInput(
        "--texels on: the splats can show the swatch in the colours of a scan with a source map "
        "only; texture it with --source-map and give its --swatch");
  return possible && options.texels != "off";
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
  const std::vector<float> radii = splatRadii(input.neighborhoods);
  SplatColumns columns{
      .positions = positions, .normals = normals, .colours = view.colours, .radii = radii};
  std::vector<vec2> texels;
  std::vector<TangentFrame> frames;
  std::optional<SplatTexture> texture;
  if (usesTexels(input, options)) {
    texels = plainTexels(input);
    frames = input.map->frame;
    if (options.zUp)
      for (TangentFrame& frame : frames) frame.s = yUp(frame.s), frame.t = yUp(frame.t);
    texture.emplace(SplatTexture{*input.swatch, texels, frames, input.map->scale});
    if (options.texels == "on") texture->longestStep = std::numeric_limits<float>::max();
    columns.texture = &*texture;
  }
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
