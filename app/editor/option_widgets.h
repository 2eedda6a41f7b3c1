// Widgets for the options table: what the command line can be told, the mouse can set.
#pragma once

#include "document/options_table.h"

namespace dapple {

// A row for every option of a synthesis, with its range, help and, by the right mouse button, a way
// back to the default. Options are always in range. True: one has changed.
bool optionWidgets(TextureOptions& options);

}  // namespace dapple
