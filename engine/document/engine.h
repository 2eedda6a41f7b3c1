// The thread that owns the document: commands in, immutable snapshots out.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "document/apply.h"
#include "document/document_identity.h"

namespace dapple {

// Parts of a snapshot that change by themselves.
enum class Part {
  Scan,
  Labels,
  Regions,
  Selection,
  Colour,
  State,
  Patch,
  Error,
  Order,
  Texel,
  History,
  Preview
};
inline constexpr std::size_t kParts = 12;

// A document as a file has it.
struct DocumentFile {
  std::string project;  // path; empty: it is a scan as it was opened
  DocumentIdentity document;
};

struct Snapshot {
  Document document;
  // The last one that was opened or saved, by command; null: none.
  std::shared_ptr<const DocumentFile> file;
  std::shared_ptr<const std::vector<std::string>> history;  // labels, oldest first
  std::size_t cursor = 0;                                   // of the present document
  // While a synthesis runs, what it has so far: n elements each; else null.
  Column<vec3> previewColour;
  Column<PointState> previewState;  // Free: not reached yet, or not part of this synthesis
  // While a scan is being opened, as soon as its file is read: its points in their final order,
  // normals and colours only if the file has them. Else null.
  std::shared_ptr<const PointSet> opening;
  // Grow by one whenever the part changes: a viewer uploads what differs from what it has.
  std::array<std::uint64_t, kParts> version{};

  std::uint64_t of(Part part) const { return version[static_cast<std::size_t>(part)]; }
};

struct EngineStatus {
  bool busy = false;        // a command is carried out or waits
  bool paused = false;      // jobs wait
  std::string job;          // label of what runs; empty: nothing that takes long
  Progress progress;        // of the job; all regions of a synthesis together
  std::size_t waiting = 0;  // commands
  // The last command that failed, which, and how many have.
  std::string error, failed;
  std::size_t errors = 0;
  // The last thing that the user should know, and how many there were.
  std::string note;
  std::size_t notes = 0;
  std::size_t historyBytes = 0;
};

struct EngineOptions {
  unsigned threads = 0;                              // of jobs; 0: one a processor
  std::size_t historyBudget = std::size_t{1} << 30;  // bytes
  std::function<Image(const std::filesystem::path&)> readImage;
  // Something new is to be seen. Called from the engine's threads, at most about 20 times a second
  // while a job runs; must return at once and not call the engine.
  std::function<void()> changed;
};

// All functions may be called from any thread, and return at once but for finish().
//
// Quick commands are carried out in the order of their arrival on one thread, which owns the
// document. Jobs (isJob()) read the document on a second thread, one after another; a quick command
// that touches nothing that the job reads is carried out meanwhile, one that does stops the job
// first, and anything else waits (meeting()). What only reads (saving, exporting) works on a third
// thread, from the document as it was when its turn came, beside anything else.
//
// An Undo while a job works that will be the next step of the history only cancels it, unless
// something was edited beside it: then that is undone, and the job goes on.
class Engine {
 public:
  explicit Engine(EngineOptions options = {});
  ~Engine();  // stops what runs
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  void submit(Command command);
  std::shared_ptr<const Snapshot> snapshot() const;
  EngineStatus status() const;

  // Live: after each edit the regions that it touches are synthesized again by themselves
  // (touchedRegions()), as a part of that edit in the history. What the user stops or cancels stays
  // so until the next edit.
  void setLive(bool live);

  // Of the job that runs, if any; cancel() without one, of the saving or exporting. Only a job that
  // changes something can be paused.
  void pause();
  void resume();
  void stop();    // keeps what is done so far, as an edit of its own
  void cancel();  // leaves the document as before the job

  // Waits until all that was submitted is done. For programs without a window, and tests.
  void finish();

 private:
  struct Core;
  std::unique_ptr<Core> core_;
};

}  // namespace dapple
