// Plain text with a point a line: .xyz, .txt, .asc, .csv, .pts.
#pragma once

#include "io/input_file.h"
#include "io/output_file.h"
#include "io/record_table.h"

namespace dapple {

// True when the first line that is neither comment nor heading nor count holds three numbers.
bool looksLikeXyz(std::string_view bytes);

// Element "vertex" with x y z as double, then nx ny nz (float) where three columns hold unit
// vectors, red green blue (bytes, or float within 0..1) where they hold colours, and column4,
// column5 ... (double) for the rest. Blanks, commas, semicolons and tabs part the numbers; lines
// that begin with # or // are comments; a heading and the count of a .pts file are skipped. Throws
// IoError, Cancelled.
RecordTable readXyz(InputFile& file, Monitor& monitor);

// The vertices' positions and, where there are, normals and colours, below a comment that names the
// columns. The rest of the table is left out. Throws IoError, Cancelled.
void writeXyz(OutputFile& file, const RecordTable& table, Monitor& monitor);

}  // namespace dapple
