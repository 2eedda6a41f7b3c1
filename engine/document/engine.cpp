#include "document/engine.h"

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

#include "base/errors.h"
#include "document/edit_history.h"
#include "document/live_regions.h"
#include "document/preview_board.h"
#include "document/region_field.h"

namespace dapple {
namespace {

template <class F>
class AtExit {
 public:
  explicit AtExit(F run) : run_(std::move(run)) {}
  ~AtExit() { run_(); }
  AtExit(const AtExit&) = delete;
  AtExit& operator=(const AtExit&) = delete;

 private:
  F run_;
};

enum class Ending { Natural, Keep, Discard };

void bumpVersions(const Snapshot& before, Snapshot& now) {
  const auto differs = [&](Part part, const auto& a, const auto& b) {
    if (a != b) ++now.version[static_cast<std::size_t>(part)];
  };
  const Document &a = before.document, &b = now.document;
  differs(Part::Scan, a.scan, b.scan);
  differs(Part::Labels, a.labels, b.labels);
  differs(Part::Regions, a.regions, b.regions);
  differs(Part::Selection, a.selection, b.selection);
  differs(Part::Colour, a.results.colour, b.results.colour);
  differs(Part::State, a.results.state, b.results.state);
  differs(Part::Patch, a.results.patch, b.results.patch);
  differs(Part::Error, a.results.error, b.results.error);
  differs(Part::Order, a.results.order, b.results.order);
  differs(Part::Texel, a.results.texel, b.results.texel);
  differs(Part::History, before.history, now.history);
  differs(Part::Preview, before.previewColour, now.previewColour);
}

unsigned gestureOf(const Command& command) {
  if (const auto* set = std::get_if<SetRegion>(&command)) return set->gesture;
  if (const auto* set = std::get_if<SetSwatch>(&command)) return set->gesture;
  if (const auto* set = std::get_if<SetStroke>(&command)) return set->gesture;
  return 0;
}

}  // namespace

struct Engine::Core {
  // A job and its thread. The engine thread makes it and takes its outcome after join().
  struct Job {
    Command command;
    std::string label;
    Document document;
    std::unique_ptr<PreviewBoard> board;  // of a synthesis
    std::stop_source stop;
    std::atomic<Ending> ending{Ending::Natural};
    std::size_t base = 0;        // step of the history that it started from
    bool kept = false;           // stopped on the way, with an outcome
    bool byItself = false;       // live: a part of the edit before it
    bool byUser = false;         // ended by the user; under `mutex`
    Change change;               // the outcome, unless
    std::exception_ptr failure;  // it failed
    std::thread thread;

    void end(Ending how) {
      ending = how;
      stop.request_stop();
    }
  };

  explicit Core(EngineOptions given)
      : options(std::move(given)),
        jobWorkers(options.threads, Priority::Background),
        quickWorkers(options.threads),
        openWorkers(options.threads),
        readerWorkers(1),
        history(emptyDocument(), "New", options.historyBudget),
        current(firstSnapshot()) {
    thread = std::thread([this] { serve(); });
  }

  ~Core() {
    {
      const std::lock_guard lock(mutex);
      quit = true;
      if (job) job->end(Ending::Discard);
      if (reader) reader->end(Ending::Discard);
    }
    wake.notify_all();
    thread.join();
  }

  // ---- engine thread -----------------------------------------------------------------------

  void serve() {
    for (;;) {
      Wake reason = Wake::Quit;
      {
        std::unique_lock lock(mutex);
        // A command that waits for the job holds up those behind it.
        const auto ready = [&] {
          if (quit && !job && !reader)
            reason = Wake::Quit;
          else if (jobDone)
            reason = Wake::JobDone;
          else if (readerDone)
            reason = Wake::ReaderDone;
          else if (!quit && !waiting && !queue.empty())
            reason = Wake::NewCommand;
          else if (!quit && !job && !head && live && (!touched.empty() || borders))
            reason = Wake::Touched;
          else
            return false;
          return true;
        };
        wake.wait(lock, ready);
        handling = true;
        if (reason == Wake::NewCommand) head = std::move(queue.front()), queue.pop_front();
      }
      if (reason == Wake::Quit) return;
      if (reason == Wake::JobDone) endJob();
      if (reason == Wake::ReaderDone) endReader();
      if (reason == Wake::Touched) startLive();
      if (head) meetJobs();
      tellStatus();
    }
  }

  void meetJobs() {
    waiting = false;
    for (Job* other : {job.get(), reader.get()}) {
      if (!other) continue;
      if (undoesJob(*other)) {
        endByUser(Ending::Discard);
        head.reset();
        return;
      }
      const Meeting m =
          staysAfter(*other) ? Meeting::Beside : meeting(*head, other->command, history.document());
      // What ends already keeps its way of ending.
      if (m == Meeting::Stops && other->ending == Ending::Natural) other->end(Ending::Discard);
      waiting = waiting || m != Meeting::Beside;
    }
    if (waiting) return;
    const Command command = std::move(*head);
    head.reset();
    if (isJob(command))
      start(command, onlyReads(command) ? reader : job);
    else
      carryOut(command);
  }

  // Steps of the history ever made up to the present one.
  std::size_t step() const { return history.dropped() + history.cursor(); }

  // An undo while a job that would be the last step works: the job is what is undone.
  bool undoesJob(const Job& other) const {
    return std::holds_alternative<Undo>(*head) && isStep(other) &&
           other.ending == Ending::Natural && step() == other.base;
  }

  // An undo or redo among steps that were made beside the job, which touch nothing that it reads.
  bool staysAfter(const Job& other) const {
    if (!isStep(other) || other.ending != Ending::Natural) return false;
    if (std::holds_alternative<Undo>(*head)) return step() > other.base;
    if (!editedBeside) return false;
    if (std::holds_alternative<Redo>(*head)) return true;
    const auto* to = std::get_if<GoTo>(&*head);
    return to && history.dropped() + to->entry >= other.base;
  }

  static bool opens(const Command& command) {
    return std::holds_alternative<OpenScan>(command) ||
           std::holds_alternative<OpenProject>(command);
  }
  // What ends as a step of its own. A live synthesis is a part of the edit before it.
  static bool isStep(const Job& other) {
    return !onlyReads(other.command) && !opens(other.command) && !other.byItself;
  }

  void carryOut(const Command& command) {
    const std::string name = label(command, history.document());
    try {
      if (std::holds_alternative<Undo>(command))
        history.undo(), untouch();
      else if (std::holds_alternative<Redo>(command))
        history.redo(), untouch();
      else if (const auto* to = std::get_if<GoTo>(&command))
        history.goTo(to->entry), untouch();
      else {
        Monitor monitor(quickWorkers);
        Document next = apply(history.document(), command, contextOf(nullptr), monitor);
        touch(next);
        history.push(name, std::move(next), gestureOf(command));
        editedBeside = true;
      }
    } catch (const std::exception& error) {
      return fail(name, error.what());
    }
    publishDocument();
  }

  // Remembers what the edit touches.
  void touch(const Document& next) {
    for (const RegionId id : touchedRegions(history.document(), next)) touched.insert(id);
    borders |= bordersTouched(history.document(), next);
  }

  void untouch() {
    touched.clear();
    borders = false;
  }

  void startLive() {
    if (touched.empty()) return start(BlendBorders{}, job, true);
    const RegionId region = *touched.begin();
    if (canSynthesize(history.document(), region))
      start(Synthesize{.region = region, .onlyChanged = true}, job, true);
    else
      touched.erase(region);
  }

  // Into `slot`, which is empty: of the job, or of the one that only reads.
  void start(const Command& command, std::unique_ptr<Job>& slot, bool byItself = false) {
    auto next = std::make_unique<Job>();
    next->command = command;
    next->byItself = byItself;
    next->document = history.document();
    next->label = label(command, next->document);
    next->base = step();
    if (&slot == &job) editedBeside = false;
    Job& started = *next;
    {
      const std::lock_guard lock(mutex);
      slot = std::move(next);
      if (&slot == &job || !job) status.progress = {};
      nameJob();
      if (quit) started.end(Ending::Discard);
    }
    started.thread = std::thread([this, &started] {
      // The window wins, but for what the user waits to see in it.
      if (!opens(started.command)) setPriority(Priority::Background);
      work(started);
    });
  }

  void endJob() {
    std::unique_ptr<Job> ended;
    job->thread.join();
    {
      const std::lock_guard lock(mutex);
      ended = std::move(job);
      jobDone = false;
      nameJob();
      status.progress = {};
      status.paused = false;
    }
    gate.resume();
    waiting = false;
    try {
      if (ended->failure) std::rethrow_exception(ended->failure);
      // Stopped too late to notice: the wish counts.
      if (ended->ending == Ending::Discard) throw Cancelled();
      take(*ended);
      noteFile(*ended);
    } catch (const Cancelled&) {
    } catch (const std::exception& error) {
      fail(ended->label, error.what());
      untouch();
    }
    if (ended->byUser) untouch();
    publishDocument();
  }

  // The outcome of a job that ended well.
  void take(const Job& ended) {
    Document next = ended.change(history.document());
    if (const auto* synthesis = std::get_if<Synthesize>(&ended.command)) {
      borders = false;
      if (synthesis->region)
        touched.erase(*synthesis->region);
      else
        touched.clear();
    } else if (std::holds_alternative<BlendBorders>(ended.command)) {
      borders = false;
    } else {
      touch(next);
      if (next.scan != history.document().scan) untouch();
    }
    if (ended.byItself)
      history.amend(std::move(next));
    else
      history.push(ended.label + (ended.kept ? " (stopped)" : ""), std::move(next));
  }

  void endReader() {
    std::unique_ptr<Job> ended;
    reader->thread.join();
    {
      const std::lock_guard lock(mutex);
      ended = std::move(reader);
      readerDone = false;
      nameJob();
    }
    waiting = false;
    try {
      if (ended->failure) std::rethrow_exception(ended->failure);
      // Not of a scan that has been closed meanwhile.
      if (ended->document.scan == history.document().scan) noteFile(*ended);
    } catch (const Cancelled&) {
    } catch (const std::exception& error) {
      fail(ended->label, error.what());
    }
    publishDocument();
  }

  // Under `mutex`.
  void nameJob() { status.job = job ? job->label : reader ? reader->label : ""; }

  // What was opened or saved is now as its file has it.
  void noteFile(const Job& ended) {
    DocumentFile now;
    if (const auto* save = std::get_if<SaveProject>(&ended.command))
      now = {save->path, DocumentIdentity(ended.document)};
    else if (const auto* project = std::get_if<OpenProject>(&ended.command))
      now = {project->path, DocumentIdentity(history.document())};
    else if (std::holds_alternative<OpenScan>(ended.command))
      now = {{}, DocumentIdentity(history.document())};
    else
      return;
    file = std::make_shared<const DocumentFile>(std::move(now));
  }

  void publishDocument() {
    auto labels = std::make_shared<std::vector<std::string>>();
    for (std::size_t e = 0; e < history.size(); ++e) labels->push_back(history.label(e));
    replaceSnapshot([&](Snapshot& next) {
      next.document = history.document();
      next.history = std::move(labels);
      next.cursor = history.cursor();
      next.file = file;
      if (!job) next.previewColour = nullptr, next.previewState = nullptr, next.opening = nullptr;
    });
  }

  void tellStatus() {
    {
      const std::lock_guard lock(mutex);
      status.historyBytes = history.bytes();
      handling = head.has_value();
      somethingTouched = !touched.empty() || borders;
    }
    idle.notify_all();
    if (options.changed) options.changed();
  }

  void fail(const std::string& name, const std::string& what) {
    const std::lock_guard lock(mutex);
    status.error = what;
    status.failed = name;
    ++status.errors;
  }

  // ---- the jobs' threads -------------------------------------------------------------------

  void work(Job& now) {
    const bool reads = onlyReads(now.command);
    const AtExit tell([&] {
      {
        const std::lock_guard lock(mutex);
        (reads ? readerDone : jobDone) = true;
      }
      wake.notify_all();
    });
    try {
      const auto* synthesis = std::get_if<Synthesize>(&now.command);
      if (synthesis) now.board = std::make_unique<PreviewBoard>(now.document);
      if (!reads && !(synthesis && synthesis->onlyChanged)) regionField.reset();
      MonitorCallbacks callbacks{.progress = [&](const Progress& p) { tellProgress(now, p); }};
      if (now.board) callbacks.preview = [&](const Preview& p) { showPreview(now, p); };
      // What only reads is not held up with a synthesis that is paused.
      Workers& workers = reads ? readerWorkers : opens(now.command) ? openWorkers : jobWorkers;
      Monitor monitor(workers, now.stop.get_token(), callbacks, reads ? nullptr : &gate);
      now.change = compute(now.document, now.command, contextOf(&now), monitor);
    } catch (...) {
      now.failure = std::current_exception();
    }
  }

  CommandContext contextOf(Job* now) {
    CommandContext context{.readImage = options.readImage};
    context.note = [this](const std::string& text) {
      const std::lock_guard lock(mutex);
      status.note = text;
      ++status.notes;
    };
    if (now) context.loaded = [this](const PointSet& points) { showOpening(points); };
    if (!now || !now->board) return context;
    context.field = &regionField;
    PreviewBoard& board = *now->board;
    context.watch.begins = [&board](auto points, std::size_t before, std::size_t total) {
      board.begins(points, before, total);
    };
    context.watch.ends = [this, now, &board](const SourceMap& map) {
      board.ends(map);
      publishPreview(*now);
    };
    context.watch.keepsDone = [now] { return now->kept = now->ending == Ending::Keep; };
    context.watch.shown = [&board] { return Preview{board.colours(), board.states()}; };
    return context;
  }

  void tellProgress(const Job& now, const Progress& progress) {
    {
      const std::lock_guard lock(mutex);
      if (job && job.get() != &now) return;
      status.progress = now.board ? now.board->overall(progress) : progress;
    }
    if (options.changed) options.changed();
  }

  void showPreview(Job& now, const Preview& preview) {
    now.board->show(preview);
    publishPreview(now);
  }

  void showOpening(const PointSet& points) {
    auto copy = std::make_shared<const PointSet>(points);
    replaceSnapshot([&](Snapshot& next) { next.opening = std::move(copy); });
    if (options.changed) options.changed();
  }

  void publishPreview(const Job& now) {
    auto colour = std::make_shared<const std::vector<vec3>>(now.board->colours());
    auto state = std::make_shared<const std::vector<PointState>>(now.board->states());
    replaceSnapshot([&](Snapshot& next) {
      if (now.ending == Ending::Discard) return;
      next.previewColour = std::move(colour);
      next.previewState = std::move(state);
    });
    if (options.changed) options.changed();
  }

  // ---- any thread --------------------------------------------------------------------------

  // The old snapshot, which may be the last to hold large columns, is let go outside the mutex.
  void replaceSnapshot(const std::function<void(Snapshot&)>& modify) {
    std::shared_ptr<const Snapshot> old;
    const std::lock_guard order(publishing);
    auto next = std::make_shared<Snapshot>(*snapshot());
    const Snapshot& before = *snapshot();
    modify(*next);
    bumpVersions(before, *next);
    const std::lock_guard lock(mutex);
    old = std::move(current);
    current = std::move(next);
  }

  std::shared_ptr<const Snapshot> snapshot() const {
    const std::lock_guard lock(mutex);
    return current;
  }

  std::shared_ptr<const Snapshot> firstSnapshot() const {
    auto first = std::make_shared<Snapshot>();
    first->document = history.document();
    first->history =
        std::make_shared<const std::vector<std::string>>(1, history.label(history.cursor()));
    return first;
  }

  void endByUser(Ending how) {
    bool discards = false;
    {
      const std::lock_guard lock(mutex);
      if (job) {
        job->byUser = true;
        job->end(how);
        discards = how == Ending::Discard;
      } else if (reader && how == Ending::Discard) {
        reader->end(how);
      }
    }
    // The picture is as before at once, however long the job takes to notice.
    if (!discards) return;
    replaceSnapshot(
        [](Snapshot& next) { next.previewColour = nullptr, next.previewState = nullptr; });
    if (options.changed) options.changed();
  }

  bool busy() const {
    return handling || !queue.empty() || job || reader || (live && somethingTouched);
  }

  enum class Wake { Quit, JobDone, ReaderDone, NewCommand, Touched };

  const EngineOptions options;
  Workers jobWorkers, quickWorkers, openWorkers, readerWorkers;
  PauseGate gate;
  std::unique_ptr<RegionField> regionField;  // of the job's thread

  // Of the engine thread alone.
  EditHistory history;
  std::optional<Command> head;  // taken from the queue
  std::shared_ptr<const DocumentFile> file;
  bool waiting = false;        // head waits for the end of a job
  bool editedBeside = false;   // a step was made since the job began: what can be redone is newer
  std::set<RegionId> touched;  // to be synthesized again by themselves
  bool borders = false;        // to be blended again by themselves

  std::mutex publishing;  // one publisher at a time; taken before `mutex`
  mutable std::mutex mutex;
  std::condition_variable wake, idle;
  // Under `mutex`. The engine thread alone changes the jobs and may read it without.
  std::deque<Command> queue;
  bool quit = false, jobDone = false, readerDone = false, live = false;
  bool somethingTouched = false;  // `touched` or `borders`
  bool handling = false;  // the engine thread works, or has a command that waits for the job
  std::unique_ptr<Job> job, reader;
  std::shared_ptr<const Snapshot> current;
  EngineStatus status;

  std::thread thread;
};

Engine::Engine(EngineOptions options) : core_(std::make_unique<Core>(std::move(options))) {}
Engine::~Engine() = default;

void Engine::submit(Command command) {
  {
    const std::lock_guard lock(core_->mutex);
    core_->queue.push_back(std::move(command));
  }
  core_->wake.notify_all();
}

std::shared_ptr<const Snapshot> Engine::snapshot() const {
  return core_->snapshot();
}

EngineStatus Engine::status() const {
  const std::lock_guard lock(core_->mutex);
  EngineStatus status = core_->status;
  status.busy = core_->busy();
  const bool works = core_->job || core_->reader;
  status.waiting = core_->queue.size() + (core_->handling && works ? 1 : 0);
  return status;
}

void Engine::pause() {
  const std::lock_guard lock(core_->mutex);
  if (!core_->job) return;
  core_->gate.pause();
  core_->status.paused = true;
}

void Engine::resume() {
  const std::lock_guard lock(core_->mutex);
  core_->gate.resume();
  core_->status.paused = false;
}

void Engine::setLive(bool live) {
  {
    const std::lock_guard lock(core_->mutex);
    core_->live = live;
  }
  core_->wake.notify_all();
  core_->idle.notify_all();
}

void Engine::stop() {
  core_->endByUser(Ending::Keep);
}

void Engine::cancel() {
  core_->endByUser(Ending::Discard);
}

void Engine::finish() {
  std::unique_lock lock(core_->mutex);
  core_->idle.wait(lock, [&] { return !core_->busy(); });
}

}  // namespace dapple
