// Wavefront OBJ: vertices, vertex normals and faces.
#pragma once

#include "io/input_file.h"
#include "io/output_file.h"
#include "io/record_table.h"

namespace dapple {

// Element "vertex" (x y z as double; nx ny nz and red green blue as float when every vertex has
// them), and "face" with vertex_indices when there are faces. Everything else in the file is left
// out. Throws IoError, Cancelled.
RecordTable readObj(InputFile& file, Monitor& monitor);

// The vertices' positions and, where there are, colours (after the position, as most programs read
// them) and normals; the faces and, where these have them (texcoord, texnumber), the texture
// coordinates of their corners, with materials of the file `materials` when it is named. The rest
// of the table is left out. Throws IoError, Cancelled.
void writeObj(OutputFile& file, const RecordTable& table, const std::string& materials,
              Monitor& monitor);

// Of a PLY comment that names the image which texture coordinates are for.
inline constexpr std::string_view kTextureComment = "TextureFile ";

// The materials, one for each image that a comment of the table names (kTextureComment), and one
// for faces without. Empty: there is no image.
std::string objMaterials(const RecordTable& table);

}  // namespace dapple
