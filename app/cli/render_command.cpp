#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <sstream>

#include "app/cli/cli.h"
#include "app/cli/picture.h"
#include "app/cli/report.h"
#include "app/render/camera.h"
#include "base/errors.h"
#include "document/channels.h"
#include "document/texture_job.h"
#include "document/textured_scan.h"
#include "io/image_io.h"

namespace dapple {
namespace {

constexpr int kNeighbours = 16;
constexpr float kPlainGrey = 0.7f;  // of a scan without colours

struct RenderArguments {
  std::string scan, output, size = "1280x720", show = "colour", swatch, overlay = "none";
  std::vector<float> eye, target;
  DrawingArguments drawing;
  int perSecond = 12;
  PictureOptions picture;
};

std::optional<vec3> toVector(const std::vector<float>& numbers) {
  if (numbers.size() != 3) return std::nullopt;
  return vec3(numbers[0], numbers[1], numbers[2]);
}

// OUT.png: OUT_000.png.
std::string numbered(const std::filesystem::path& path, int k) {
  std::filesystem::path name = path.stem();
  name += fmt::format("_{:03}", k);
  name += path.extension();
  return path.parent_path() / name;
}

// One file for the picture, for each of a turntable's, or for all of them.
class PictureFiles {
 public:
  PictureFiles(const RenderArguments& a) : a_(a) {
    if (a.picture.turntable > 0 && isAnimation(a.output))
      animation_ = std::make_unique<AnimationWriter>(a.output, a.picture.turntable, a.perSecond);
  }
  void take(int k, const Image& picture) {
    if (animation_)
      animation_->add(picture);
    else
      writeImage(a_.picture.turntable == 0 ? a_.output : numbered(a_.output, k), picture);
  }
  void finish() {
    if (animation_) animation_->finish();
  }

 private:
  const RenderArguments& a_;
  std::unique_ptr<AnimationWriter> animation_;
};

void parsePicture(RenderArguments& a) {
  parseSize(a.size, a.picture);
  a.picture.show = viewNamed(a.show);
  a.picture.eye = toVector(a.eye);
  a.picture.target = toVector(a.target);
  a.picture.renderer = a.drawing.renderer;
  a.picture.texels = a.drawing.texels;
  if (!a.drawing.shading.empty()) a.picture.shading = shadingNamed(a.drawing.shading);
  a.picture.background = parseColour(a.drawing.background);
  a.picture.overlay = overlayNamed(a.overlay);
  checkPicture(a.picture);
}

void runRender(RenderArguments& a, const TextureOptions& table, Monitor& monitor) {
  parsePicture(a);
  checkWritable(a.output);
  checkImageName(a.output);
  PreparedScan prepared = prepareScan(a.scan, {}, kNeighbours, {}, monitor);
  PointSet& points = prepared.scan.points;
  if (points.colours.empty()) {
    points.colours.assign(points.size(), vec3(kPlainGrey));
    // Flat grey would show nothing of the shape.
    if (a.drawing.shading.empty()) a.picture.shading = Shading::Headlight;
  }
  const SourceMap map = readSourceMap(prepared.scan).value_or(SourceMap{});
  const std::vector<Index> regions = readRegions(prepared.scan).value_or(std::vector<Index>{});
  std::optional<Swatch> swatch;
  if (!a.swatch.empty()) swatch = readSwatch(a.swatch, table.tileable, stackLevels(table));
  const PointChannels channels = readChannels(prepared.scan);
  const auto scalar = [&](Channel channel) -> std::span<const float> {
    return channels.scalar[static_cast<std::size_t>(channel)];
  };
  const ViewColumns columns{.colours = points.colours,
                            .normals = points.normals,
                            .state = map.state,
                            .patch = map.patch,
                            .error = map.error,
                            .order = map.order,
                            .region = regions,
                            .texel = map.texel,
                            .swatchSize = swatch ? ivec2(swatch->width, swatch->height) : ivec2(0),
                            .roughness = scalar(Channel::Roughness),
                            .height = scalar(Channel::Height),
                            .metallic = scalar(Channel::Metallic),
                            .occlusion = scalar(Channel::Occlusion),
                            .mappedNormals = channels.normal};
  monitor.begin(Stage::Render, 0);
  PictureFiles files(a);
  drawPictures({.points = points,
                .neighborhoods = prepared.neighborhoods,
                .columns = columns,
                .map = map.texel.empty() ? nullptr : &map,
                .swatch = swatch ? &*swatch : nullptr},
               a.picture, monitor.workers(), [&](int k, const Image& picture) {
                 monitor.checkpoint();
                 files.take(k, picture);
               });
  files.finish();
}

}  // namespace

Subcommand addRenderCommand(CLI::App& app, CommonOptions& common) {
  CLI::App* sub = app.add_subcommand("render", "Draw a scan into a picture, without a display.");
  auto a = std::make_shared<RenderArguments>();
  sub->add_option("scan", a->scan, "point cloud or mesh: PLY, OBJ, XYZ")->required();
  sub->add_option("-o,--output", a->output, "image to write")->required();
  sub->add_option("--size", a->size, "WIDTHxHEIGHT, 1 to 8192 pixels each")->capture_default_str();
  sub->add_option("--view", a->picture.view, viewDirectionNames("|"))->capture_default_str();
  auto* eye = sub->add_option("--eye", a->eye, "x,y,z: where to look from, in place of --view")
                  ->delimiter(',')
                  ->expected(3);
  auto* target =
      sub->add_option("--target", a->target, "x,y,z: where to look")->delimiter(',')->expected(3);
  eye->needs(target);
  target->needs(eye);
  sub->add_flag("--orthographic", a->picture.orthographic,
                "no perspective: the scan as large as it fits, seen along --view or from --eye");
  sub->add_option("--turntable", a->picture.turntable,
                  "draw this many pictures round the vertical axis: OUT_000.png, OUT_001.png, "
                  "...; one animated file when OUT ends in .gif")
      ->check(CLI::Range(2, 720))
      ->excludes(eye);
  sub->add_option("--fps", a->perSecond, "pictures a second of an animated file")
      ->check(CLI::Range(1, 50))
      ->capture_default_str();
  sub->add_option("--show", a->show,
                  viewNames("|") +
                      "; state to coordinates need a scan that was saved with --source-map, "
                      "regions one with a vertex property 'region', the last five one that was "
                      "saved with --channel")
      ->capture_default_str();
  sub->add_option("--overlay", a->overlay,
                  "none|directions|regions: drawn over the picture; directions of a scan that was "
                  "saved with --source-map, outlines of regions")
      ->capture_default_str();
  sub->add_option("--swatch", a->swatch,
                  "the image that the scan was textured from, for --texels; needs a scan that was "
                  "saved with --source-map");
  addTableOption(*sub, "tileable", common);
  addDrawingOptions(*sub, a->drawing);
  sub->add_flag("--z-up", a->picture.zUp, "the scan's z axis points up");
  addCommonOptions(*sub, common);
  return {sub, &common, [a, &common](Monitor& monitor) { runRender(*a, common.table, monitor); }};
}

}  // namespace dapple
