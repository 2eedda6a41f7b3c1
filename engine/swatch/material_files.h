// Which files of a folder make one material: told by how their names end, in any case, as ambientCG
// (Bricks001_1K-JPG_NormalGL.jpg), Poly Haven (bricks_nor_gl_1k.exr), textures.com
// (Bricks_2x2_1K_albedo.tif) and most others have it; or by endings alone (albedo.png).
#pragma once

#include <filesystem>
#include <vector>

#include "swatch/material_maps.h"

namespace dapple {

// The files beside a swatch that are called as it is but for the usual endings: wood.png or
// wood_diff.png, wood_nor_gl.exr, wood_rough.png. Never throws: a folder that cannot be read holds
// none.
ChannelPaths findChannels(const std::filesystem::path& swatch);

// The images of a folder that are swatches, by name: all but the maps and previews that belong to
// another one of them. Images of a folder that has none are looked for in its folder "textures".
// Never throws.
std::vector<std::filesystem::path> swatchesIn(const std::filesystem::path& folder);

// Those of them that are not called as a map is: more than one make a collection, not a material.
std::vector<std::filesystem::path> colourImagesIn(const std::filesystem::path& folder);

// The image of a swatch that may be given as the folder of one material; any other path as it is.
// Throws InvalidInput that lists what the folder holds when it has no colour image, or several.
std::filesystem::path swatchFile(const std::filesystem::path& path);

}  // namespace dapple
