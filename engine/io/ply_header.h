// What stands before a PLY file's body.
#pragma once

#include <string>

#include "io/input_file.h"
#include "io/record_table.h"

namespace dapple {

enum class PlyFormat { Ascii, LittleEndian, BigEndian };

struct PlyHeader {
  PlyFormat format = PlyFormat::Ascii;
  RecordTable table;  // elements with counts and properties, but without values
};

// Leaves `file` at the first byte of the body. Throws IoError.
PlyHeader readPlyHeader(InputFile& file);

std::string writePlyHeader(const RecordTable& table, PlyFormat format);

}  // namespace dapple
