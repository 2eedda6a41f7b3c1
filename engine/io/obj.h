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
// them) and normals; the faces. The rest of the table is left out. Throws IoError, Cancelled.
void writeObj(OutputFile& file, const RecordTable& table, Monitor& monitor);

}  // namespace dapple
