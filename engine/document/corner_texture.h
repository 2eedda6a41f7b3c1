// Texture coordinates for the corners of a scan's faces, so that programs that know nothing of a
// source map show the swatch itself on the mesh.
#pragma once

#include <filesystem>

#include "document/results.h"
#include "io/point_io.h"

namespace dapple {

struct CornerTexture {
  // By corner of the faces, in the file's order: u to the right and v up, 1 for a whole swatch.
  // Beyond 0..1 where a face lies across the border of a swatch that tiles.
  std::vector<vec2> coordinates;
  std::vector<std::int32_t> texture;   // by face: position in `sources`; -1: none
  std::vector<std::uint16_t> sources;  // by texture: position in Results::sources

  bool empty() const { return sources.empty(); }
};

// All corners of a face belong to one place of the swatch: that of the corner which explains the
// others best, carried on by its frame. A corner whose own place is near that has its own, so that
// coordinates go on across edges wherever the source map does; of a blended one the heaviest.
// Hence a face is at most twice as large in the swatch as in space. Empty without faces, or when
// none has a source. Throws Cancelled.
CornerTexture cornersOf(const Results& results, const Scan& scan, Monitor& monitor);

// The image of each texture, as a file beside `output` names it: by the way from there where there
// is one. A part of an image is written beside `output`. Throws IoError.
std::vector<std::string> textureFiles(const CornerTexture& corners, const Results& results,
                                      const std::filesystem::path& output);

// As MeshLab reads it: of the faces texcoord (list of float, u and v of each corner) and, of
// several textures, texnumber (int, -1: none); a comment "TextureFile NAME" each. Takes the place
// of such that the file had.
void addCorners(RecordTable& table, const CornerTexture& corners,
                const std::vector<std::string>& files);

}  // namespace dapple
