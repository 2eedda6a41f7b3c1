// Borders in a project file: element "border" (a record for each point: its own colour and
// the number of its terms) and "border_term". Projects from before there were any have neither.
#pragma once

#include "document/results.h"
#include "io/record_table.h"

namespace dapple::project {

// Adds nothing for null.
void addBorder(RecordTable& table, const BorderMix* border);

// Throws InvalidInput when terms do not fit points or sources; `file` is for the message.
std::shared_ptr<const BorderMix> readBorder(const RecordTable& table, std::size_t points,
                                            std::size_t sources, const std::string& file);

}  // namespace dapple::project
