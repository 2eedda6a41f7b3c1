// Images from a swatch: `synth2d` any, `tile` those that repeat without a seam.
#include <fmt/format.h>

#include <chrono>
#include <memory>

#include "app/cli/cli.h"
#include "app/cli/picture.h"
#include "app/cli/report.h"
#include "base/errors.h"
#include "io/image_io.h"
#include "synthesis/grid_blend.h"

namespace dapple {
namespace {

struct ImageArguments {
  std::string swatch, output, size;
  bool torus = false;
};

void runImage(const ImageArguments& a, const CommonOptions& common, Monitor& monitor) {
  validate(common.table);
  checkWritable(a.output);
  checkImageName(a.output);
  PictureOptions size;
  if (!a.size.empty()) parseSize(a.size, size);
  const Swatch swatch = readSwatch(a.swatch, common.table.tileable, 1);
  const CoordinateGrid grid{.width = a.size.empty() ? swatch.width : size.width,
                            .height = a.size.empty() ? swatch.height : size.height,
                            .torus = a.torus};
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Place> places = synthesizeGrid(
      swatch, grid, {.quality = common.table.passes, .seed = common.table.seed}, monitor);
  const Image image = blendedImage(swatch, grid, places, monitor);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  writeImage(a.output, image);
  if (!common.quiet)
    fmt::print("{} x {} pixels in {:.2f} s\n{}\n", grid.width, grid.height, seconds.count(),
               a.output);
}

Subcommand addImageCommand(CLI::App* sub, const ImageArguments& defaults, CommonOptions& common) {
  auto a = std::make_shared<ImageArguments>(defaults);
  sub->add_option("image", a->swatch, "sample image, 2 to 16384 pixels a side")->required();
  CLI::Option* size =
      sub->add_option("--size", a->size,
                      a->torus ? "WIDTHxHEIGHT in pixels [the image's]" : "WIDTHxHEIGHT, pixels");
  size->required(!a->torus);
  sub->add_option("-o,--output", a->output, "image to write: .png, .jpg, .tif, ...")->required();
  for (const char* name : {"tileable", "passes", "seed"}) addTableOption(*sub, name, common);
  addCommonOptions(*sub, common);
  return {sub, &common, [a, &common](Monitor& monitor) { runImage(*a, common, monitor); }};
}

}  // namespace

Subcommand addSynth2dCommand(CLI::App& app, CommonOptions& common) {
  return addImageCommand(app.add_subcommand("synth2d", "Make a larger image that looks like one."),
                         {}, common);
}

Subcommand addTileCommand(CLI::App& app, CommonOptions& common) {
  return addImageCommand(
      app.add_subcommand("tile", "Make an image that looks like one and repeats without a seam."),
      {.torus = true}, common);
}

}  // namespace dapple
