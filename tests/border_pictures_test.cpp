// Two regions of unlike swatches, pictured with hard, blended and cut borders: to look at, and that
// the whole way from document to picture shows the difference.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <fstream>

#include "app/render/image_compare.h"
#include "cli_program.h"
#include "document/apply.h"
#include "io/image_io.h"

namespace dapple {
namespace {

using namespace testing;

Document applied(const Document& document, const Command& command) {
  Workers workers;
  Monitor monitor(workers);
  return apply(document, command, {.readImage = readImage}, monitor);
}

struct Scene {
  std::string scan;
  std::string view;
  vec3 axis;  // the border is where a point's place along it is the middle one, in waves
  std::string swatches[2];
};

Document parted(const Scene& scene) {
  Document d = applied(emptyDocument(), OpenScan{.path = scene.scan});
  const std::vector<vec3>& positions = d.points().positions;
  std::vector<Index> order(d.size());
  for (Index i = 0; i < d.size(); ++i) order[i] = i;
  const auto height = [&](Index i) {
    const vec3& p = positions[i];
    return glm::dot(p, scene.axis) + 0.04f * std::sin(9 * (p.x + p.z)) + 0.03f * std::sin(17 * p.x);
  };
  std::nth_element(order.begin(), order.begin() + d.size() / 2, order.end(),
                   [&](Index a, Index b) { return height(a) < height(b); });
  order.resize(d.size() / 2);
  std::sort(order.begin(), order.end());
  d = applied(d, Select{.points = order});
  d = applied(d, AddRegion{});
  d = applied(d, Select{});
  for (RegionId r = 0; r < 2; ++r)
    d = applied(d, SetSwatch{.region = r, .reference = {.path = scene.swatches[r]}});
  return applied(d, Synthesize{});
}

std::string picture(const Document& document, const Scene& scene, const std::string& name) {
  const std::string folder = DAPPLE_BORDER_PICTURES;
  fs::create_directories(folder);
  const std::string scan = folder + "/" + name + ".ply", out = folder + "/" + name + ".png";
  applied(document, ExportScan{.path = scan});
  const Run run = dapple({"render", scan, "-o", out, "--size", "900x700", "--view", scene.view,
                          "--shading", "headlight"});
  CHECK_MESSAGE(run.code == 0, run.err);
  return out;
}

Document with(Document document, BorderKind kind, double width) {
  for (RegionId r = 0; r < 2; ++r)
    document = applied(document, SetRegion{.region = r, .borderWidth = width, .borderKind = kind});
  return applied(document, BlendBorders{});
}

void compare(const Scene& scene, const std::string& name) {
  const Document made = parted(scene);
  const Document hard = with(made, BorderKind::Hard, 0);
  const std::string file = picture(hard, scene, name + "_hard");
  for (const double width : {8.0, 24.0})
    for (const auto& [kind, word] :
         {std::pair(BorderKind::Blend, "blend"), std::pair(BorderKind::Cut, "cut")})
      picture(with(hard, kind, width), scene, fmt::format("{}_{}_{}", name, word, width));
  // The same picture but for a narrow band.
  const double error = structuralSimilarityError(
      readImage(file), readImage(fmt::format("{}/{}_blend_8.png", DAPPLE_BORDER_PICTURES, name)));
  CHECK(error > 0.0005);
  CHECK(error < 0.04);
}

}  // namespace

TEST_CASE("blended borders of a sphere are pictured") {
  const TemporaryFolder folder;
  compare({.scan = folder.write("sphere.xyz", xyzText(spherePoints(60000, 1))),
           .view = "front",
           .axis = {0, 1, 0},
           .swatches = {asset("swatches/pebbles.png"), asset("swatches/leaves.png")}},
          "sphere");
}

TEST_CASE("blended borders of a creature are pictured") {
  compare({.scan = asset("scans/creature.ply"),
           .view = "front",
           .axis = {0, 1, 0},
           .swatches = {asset("swatches/scales.png"), asset("swatches/lichen.png")}},
          "creature");
}

}  // namespace dapple
