#include "app/cli/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "app/render/camera.h"
#include "app/render/cpu_splatter.h"
#include "app/render/legend.h"
#include "app/render/offscreen.h"
#include "app/render/overlay.h"
#include "app/render/splat_renderer.h"
#include "base/errors.h"

namespace dapple {
namespace {

constexpr float kPlainHeight = 720;     // pixels: overlays grow with larger pictures
constexpr int kSupersampleUpTo = 2048;  // pixels a side; beyond, the outlines are fine enough

vec3 yUp(const vec3& v) {
  return {v.x, v.z, -v.y};
}

float aspectOf(const PictureOptions& options) {
  return static_cast<float>(options.width) / static_cast<float>(options.height);
}

Camera cameraFor(const PictureInput& input, const std::vector<vec3>& positions,
                 const PictureOptions& options) {
  const auto local = [&](const vec3& model) {
    const vec3 p((dvec3(model) - input.points.origin) / input.points.modelUnits);
    return options.zUp ? yUp(p) : p;
  };
  const Camera camera =
      options.eye && options.target
          ? lookAt(local(*options.eye), local(*options.target), boundsOf(positions))
          : standardView(options.view, positions, aspectOf(options));
  return options.orthographic ? orthographicView(camera, positions, aspectOf(options)) : camera;
}

// OpenGL without a display is OpenGL in software, which takes many times as long.
bool usesOpenGl(const std::string& renderer) {
  if (renderer == "gl") return true;
  if (renderer == "auto" || renderer == "cpu") return false;
  throw InvalidInput(
      fmt::format("--renderer: '{}' is not allowed; choose one of auto|gl|cpu", renderer));
}

void checkTexels(const PictureOptions& options) {
  const std::string& texels = options.texels;
  if (texels != "auto" && texels != "on" && texels != "off")
    throw InvalidInput(
        fmt::format("--texels: '{}' is not allowed; choose one of auto|on|off", texels));
  if (texels == "on" && options.show != View::Colour)
    throw InvalidInput(
        "--texels on: only --show colour can show the swatch; leave one of them out");
}

// Whether the swatch is shown inside the splats.
bool usesTexels(const PictureInput& input, const PictureOptions& options) {
  const bool possible = input.map && input.swatch && input.map->unit > 0 &&
                        options.show == View::Colour && !input.columns.colours.empty();
  if (options.texels == "on" && !possible)
    throw InvalidInput(
        "--texels on: the splats can show the swatch in the colours of a scan with a source map "
        "only; texture it with --source-map and give its --swatch");
  return possible && options.texels != "off";
}

// Either of the two, behind one function. What is drawn over the picture needs the points that the
// processor traces, whoever draws.
class Splatter {
 public:
  Splatter(const SplatColumns& columns, const PictureOptions& options, Workers& workers) {
    raster_.trace = options.overlay != Overlay::None;
    if (usesOpenGl(options.renderer)) {
      context_ = std::make_unique<OffscreenContext>();
      openGl_ = std::make_unique<SplatRenderer>();
      openGl_->update(columns);
    }
    if (openGl_ && !raster_.trace) return;
    cpu_ = std::make_unique<CpuSplatter>(workers);
    cpu_->update(columns);
  }

  Image draw(const Camera& camera, const PictureOptions& options) {
    const bool small = std::max(options.width, options.height) <= kSupersampleUpTo;
    const SplatOptions splats{
        .shading = options.shading, .background = options.background, .samples = small ? 2 : 1};
    if (cpu_) cpu_->draw(camera, options.width, options.height, splats, raster_);
    if (openGl_) return openGl_->draw(camera, options.width, options.height, splats);
    return toImage(raster_);
  }
  const Raster& traced() const { return raster_; }

 private:
  std::unique_ptr<OffscreenContext> context_;  // outlives what was made in it
  std::unique_ptr<SplatRenderer> openGl_;
  std::unique_ptr<CpuSplatter> cpu_;
  Raster raster_;
};

// What lies over the pictures of one scan.
class PictureOverlay {
 public:
  PictureOverlay(const PictureInput& input, const PictureOptions& options,
                 const std::vector<vec3>& positions, const std::vector<float>& radii)
      : options_(options), positions_(positions), regions_(input.columns.region) {
    if (options.overlay == Overlay::Directions && input.map)
      for (const TangentFrame& frame : input.map->frame)
        directions_.push_back(options.zUp ? yUp(frame.t) : frame.t);
    if (options.overlay == Overlay::Directions && directions_.empty())
      throw InvalidInput(
          "--overlay directions: the scan has none; texture it with --source-map first");
    if (options.overlay == Overlay::Regions && regions_.empty())
      throw InvalidInput("--overlay regions: the scan has no vertex property 'region'");
    std::vector<float> sorted = radii;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    radius_ = sorted.empty() ? 0 : *middle;
  }

  void draw(const Camera& camera, const Raster& traced, Image& picture) const {
    if (options_.overlay == Overlay::None) return;
    const auto size = static_cast<float>(std::min(picture.width, picture.height));
    const OverlayView view(camera, traced, radius_, std::max(1.f, size / kPlainHeight));
    drawLines(options_.overlay == Overlay::Directions
                  ? directionLines(view, positions_, directions_)
                  : outlineLines(view, regions_),
              picture);
  }

 private:
  const PictureOptions& options_;
  const std::vector<vec3>& positions_;
  std::span<const Index> regions_;
  std::vector<vec3> directions_;
  float radius_ = 0;
};

// The camera of picture `turn` (0..1) of a turntable: all of the scan is seen in all of them.
Camera turnedCamera(const PictureOptions& options, const std::vector<vec3>& positions, float turn) {
  const Bounds bounds = boundsOf(positions);
  const vec3 centre = 0.5f * (bounds.low + bounds.high);
  float radius = 0;
  for (const vec3& p : positions)
    radius = std::max(radius, std::hypot(p.x - centre.x, p.z - centre.z));
  constexpr int kSides = 32;
  std::vector<vec3> cylinder;
  for (int k = 0; k < kSides; ++k)
    for (const float y : {bounds.low.y, bounds.high.y}) {
      const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / kSides;
      cylinder.emplace_back(centre.x + radius * std::cos(angle), y,
                            centre.z + radius * std::sin(angle));
    }
  Camera camera = standardView(options.view, cylinder, aspectOf(options));
  if (options.orthographic) camera = orthographicView(camera, cylinder, aspectOf(options));
  const float angle = 2 * std::numbers::pi_v<float> * turn;
  const auto turned = [&](const vec3& v) {
    return vec3(std::cos(angle) * v.x + std::sin(angle) * v.z, v.y,
                std::cos(angle) * v.z - std::sin(angle) * v.x);
  };
  camera.eye = centre + turned(camera.eye - centre);
  camera.target = centre + turned(camera.target - centre);
  camera.up = turned(camera.up);
  return camera;
}

}  // namespace

void drawPictures(const PictureInput& input, const PictureOptions& options, Workers& workers,
                  const std::function<void(int, const Image&)>& take) {
  std::vector<vec3> positions = input.points.positions, normals = input.points.normals;
  if (options.zUp) {
    for (vec3& p : positions) p = yUp(p);
    for (vec3& n : normals) n = yUp(n);
  }
  const ViewColours view = viewColours(options.show, input.columns);
  const std::vector<float> radii = splatRadii(input.neighborhoods, input.points.positions);
  SplatColumns columns{
      .positions = positions, .normals = normals, .colours = view.colours, .radii = radii};
  std::vector<vec2> texels;
  std::vector<TangentFrame> frames;
  std::optional<SplatTexture> texture;
  if (usesTexels(input, options)) {
    const std::vector<float>& scale = input.map->scale;
    texels = plainTexels({input.map->texel, input.columns.colours,
                          localSpacing(input.neighborhoods, input.points.positions), scale},
                         *input.swatch, input.map->unit);
    frames = input.map->frame;
    if (options.zUp)
      for (TangentFrame& frame : frames) frame.s = yUp(frame.s), frame.t = yUp(frame.t);
    texture.emplace(SplatTexture{*input.swatch, texels, frames, input.map->unit});
    if (!scale.empty()) texture->scale = &scale;
    if (options.texels == "on") texture->longestStep = std::numeric_limits<float>::max();
    columns.texture = &*texture;
  }
  Splatter splatter(columns, options, workers);
  const PictureOverlay overlay(input, options, positions, radii);
  for (int k = 0; k < std::max(1, options.turntable); ++k) {
    const Camera camera =
        options.turntable == 0
            ? cameraFor(input, positions, options)
            : turnedCamera(options, positions,
                           static_cast<float>(k) / static_cast<float>(options.turntable));
    Image picture = splatter.draw(camera, options);
    overlay.draw(camera, splatter.traced(), picture);
    if (view.legend) drawLegend(picture, *view.legend);
    take(k, picture);
  }
}

Image drawPicture(const PictureInput& input, const PictureOptions& options, Workers& workers) {
  Image picture;
  drawPictures(input, options, workers, [&](int, const Image& drawn) { picture = drawn; });
  return picture;
}

void checkPicture(const PictureOptions& options) {
  usesOpenGl(options.renderer);
  checkTexels(options);
  if (!options.eye || !options.target) standardView(options.view, Bounds{}, 1);
}

}  // namespace dapple
