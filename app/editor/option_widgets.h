// Widgets for the options table: what the command line can be told, the mouse can set.
#pragma once

#include <string>

#include "document/options_table.h"

namespace dapple {

// What the method auto has chosen: a short line, and its reasons, one a line. Empty: not known.
struct ChoiceShown {
  std::string text, reasons;
};

// A row for every option of a synthesis, with its range, help and, by the right mouse button, a way
// back to the default; under the method what auto has chosen (mark "option.method.chosen"). Options
// are always in range. True: one has changed.
bool optionWidgets(TextureOptions& options, const ChoiceShown& chosen);

}  // namespace dapple
