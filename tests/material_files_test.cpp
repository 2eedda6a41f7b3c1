#include "swatch/material_files.h"

#include <doctest/doctest.h>

#include <fstream>

#include "base/errors.h"
#include "document_fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

namespace fs = std::filesystem;

void put(const TestFolder& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) std::ofstream(folder / name) << "x";
}

std::vector<std::string> namesOf(const std::vector<fs::path>& paths) {
  std::vector<std::string> names;
  for (const fs::path& path : paths) names.push_back(path.filename().string());
  return names;
}

using Names = std::vector<std::string>;

std::string refusal(const TestFolder& folder) {
  try {
    swatchFile(folder / "");
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("channels are found beside a swatch by the usual endings") {
  const TestFolder folder;
  for (const char* name :
       {"Wood_Diff.png", "wood_nor_dx.png", "wood_nor_gl.exr", "wood_Roughness.jpg",
        "wood_metal.png", "woods_ao.png", "wood_displacement.tif", "wood.txt"})
    std::ofstream(folder / name) << "x";
  const ChannelPaths found = findChannels(folder / "Wood_Diff.png");
  CHECK(found[Channel::Normal] == folder / "wood_nor_gl.exr");
  CHECK(!found.greenDown);
  CHECK(found[Channel::Roughness] == folder / "wood_Roughness.jpg");
  CHECK(found[Channel::Metallic] == folder / "wood_metal.png");
  CHECK(found[Channel::Height] == folder / "wood_displacement.tif");
  CHECK(found[Channel::Occlusion].empty());
  std::filesystem::remove(folder / "wood_nor_gl.exr");
  CHECK(findChannels(folder / "Wood_Diff.png").greenDown);
  CHECK(findChannels(folder / "no/such/folder.png").empty());
  CHECK(channelNamed("ao") == Channel::Occlusion);
  CHECK_THROWS_AS(channelNamed("shine"), InvalidInput);
}

TEST_CASE("a folder of one material is known, whoever named its files") {
  const auto check = [](std::initializer_list<const char*> names, const char* colour,
                        const char* height) {
    const TestFolder folder;
    put(folder, names);
    CHECK(swatchFile(folder / "") == folder / colour);
    CHECK(findChannels(folder / colour)[Channel::Height] == folder / height);
    CHECK(namesOf(swatchesIn(folder / "")) == Names{colour});
  };
  // ambientCG
  check({"Bricks001_1K-JPG_Color.jpg", "Bricks001_1K-JPG_NormalGL.jpg",
         "Bricks001_1K-JPG_NormalDX.jpg", "Bricks001_1K-JPG_Displacement.jpg",
         "Bricks001_1K-JPG_AmbientOcclusion.jpg", "Bricks001.png", "Bricks001_1K-JPG.mtlx"},
        "Bricks001_1K-JPG_Color.jpg", "Bricks001_1K-JPG_Displacement.jpg");
  // Poly Haven
  check({"mud_02_diff_1k.jpg", "mud_02_nor_gl_1k.exr", "mud_02_disp_1k.png", "mud_02_arm_1k.jpg"},
        "mud_02_diff_1k.jpg", "mud_02_disp_1k.png");
  // textures.com
  check({"TexturesCom_Wall_2x2_1K_albedo.tif", "TexturesCom_Wall_2x2_1K_height.tif",
         "TexturesCom_Wall_2x2_1K_normal.tif"},
        "TexturesCom_Wall_2x2_1K_albedo.tif", "TexturesCom_Wall_2x2_1K_height.tif");
  check({"Base Color.png", "Height.png", "Normal.png"}, "Base Color.png", "Height.png");
  check({"wood.png", "wood-height.png", "wood_gloss.png"}, "wood.png", "wood-height.png");
}

TEST_CASE("a map of another resolution is not that of the swatch") {
  const TestFolder folder;
  put(folder, {"mud_diff_1k.jpg", "mud_rough_2k.jpg", "mud_rough_1k.jpg"});
  CHECK(findChannels(folder / "mud_diff_1k.jpg")[Channel::Roughness] ==
        folder / "mud_rough_1k.jpg");
}

TEST_CASE("images of a folder named textures are those of the folder that has none") {
  const TestFolder folder;
  fs::create_directory(folder / "textures");
  put(folder, {"textures/mud_diff_2k.jpg", "textures/mud_ao_2k.jpg", "mud_2k.blend"});
  const fs::path colour = fs::path(folder / "textures") / "mud_diff_2k.jpg";
  CHECK(swatchFile(folder / "") == colour);
  CHECK(!findChannels(colour)[Channel::Occlusion].empty());
}

TEST_CASE("a folder of several swatches is a collection, without the maps of any") {
  const TestFolder folder;
  put(folder, {"metal.png", "rusty_metal.png", "wood.png", "wood_rough.png", "mud_diff.png",
               "mud_nor_gl.png", "mud.jpg", "notes.txt"});
  CHECK(namesOf(swatchesIn(folder / "")) ==
        Names{"metal.png", "mud_diff.png", "rusty_metal.png", "wood.png"});
  CHECK(namesOf(colourImagesIn(folder / "")) == Names{"mud_diff.png", "wood.png"});
  const std::string why = refusal(folder);
  CHECK(why.find("2 colour images (mud_diff.png, wood.png)") != why.npos);
  CHECK(why.find("name the image in place of the folder") != why.npos);
}

TEST_CASE("a folder without a colour image says what it holds") {
  const TestFolder folder;
  CHECK(refusal(folder).find("no colour image (nor any other)") != std::string::npos);
  put(folder, {"mud_nor_gl.png", "mud_rough.png"});
  CHECK(refusal(folder).find("only mud_nor_gl.png, mud_rough.png") != std::string::npos);
  CHECK(swatchFile(folder / "mud_rough.png") == folder / "mud_rough.png");
  CHECK(swatchesIn(folder / "none").empty());
}
