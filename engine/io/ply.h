// The PLY format: header of elements with typed properties, body in ascii or binary.
#pragma once

#include <string_view>

#include "io/input_file.h"
#include "io/output_file.h"
#include "io/record_table.h"

namespace dapple {

// True when a file that begins with `bytes` calls itself PLY.
bool looksLikePly(std::string_view bytes);

// Everything in the file, elements and properties in its order. No declared count is believed
// before it fits into the bytes that are left. Throws IoError, Cancelled.
RecordTable readPly(InputFile& file, Monitor& monitor);

// Binary little endian or ascii; counts every record with monitor.advance(). Throws IoError,
// Cancelled.
void writePly(OutputFile& file, const RecordTable& table, bool ascii, Monitor& monitor);

}  // namespace dapple
