// Commands carried out: pure functions from document to document.
#pragma once

#include "document/commands.h"

namespace dapple {

class RegionField;

// Who looks on while regions are synthesized. All may be empty.
struct SynthesisWatch {
  // The synthesis of these points begins (empty: all); `before` of `total` points are done. The
  // previews that follow are of these points, in this order.
  std::function<void(std::span<const Index>, std::size_t before, std::size_t total)> begins;
  // These points have their final colours and states, in the order of begins().
  std::function<void(const SourceMap&)> ends;
  // Asked after Cancelled: keep what is done?
  std::function<bool()> keepsDone;
  // What begins(), the previews and ends() have shown so far: n elements.
  std::function<Preview()> shown;
};

struct CommandContext {
  std::function<Image(const std::filesystem::path&)> readImage;  // image_io, or a test's
  std::function<void(const std::string&)> note;  // what the user should know although it worked
  // A scan that is being opened, as soon as its file is read. May be empty.
  std::function<void(const PointSet&)> loaded;
  SynthesisWatch watch;
  // Kept for the next Synthesize{.onlyChanged}; may be null. It holds some 300 bytes a point.
  std::unique_ptr<RegionField>* field = nullptr;
};

// For the history list: "Select 1,204 points", "Synthesize Roof".
std::string label(const Command& command, const Document& document);

// Commands that take long: they read a document and give the change to make, so that others can be
// carried out meanwhile.
bool isJob(const Command& command);

// What becomes of a command that is given while a job works.
enum class Meeting {
  Beside,  // carried out at once: neither touches what the other reads
  Waits,   // until the job has ended
  Stops,   // the job, for it changes what the job started from
};
Meeting meeting(const Command& command, const Command& job, const Document& document);

// True when a command leaves the document as it is: SaveProject, ExportScan.
bool onlyReads(const Command& command);

using Change = std::function<Document(const Document&)>;

// The work of a command. The change may be made to any document that has come from this one by
// commands beside it. Throws InvalidInput, IoError, Cancelled.
Change compute(const Document& document, const Command& command, const CommandContext& context,
               Monitor& monitor);

// Both at once. Not for Undo, Redo, GoTo, which a history carries out. Throws InvalidInput,
// IoError, Cancelled; the document is a value and stays as it was.
Document apply(const Document& document, const Command& command, const CommandContext& context,
               Monitor& monitor);

}  // namespace dapple
