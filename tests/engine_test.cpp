#include "document/engine.h"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <thread>

#include "base/hash_rng.h"
#include "document_fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// True as soon as `holds`, false when it never does.
bool soon(const std::function<bool()>& holds, double seconds = 20) {
  const auto start = Clock::now();
  while (!holds()) {
    if (secondsSince(start) > seconds) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

EngineOptions testOptions() {
  return {.readImage = imageNamed};
}

TextureOptions optionsOf(Method method) {
  TextureOptions options;
  options.method = method;
  return options;
}

// A sphere whose synthesis takes long enough to interfere with: exhaustive matching.
void openSlow(Engine& engine, const TestFolder& folder, std::size_t count = 20000) {
  engine.submit(OpenScan{.path = writeSphere(folder, count), .neighbours = 16});
  TextureOptions slow = optionsOf(Method::Match);
  slow.coherent = false;
  engine.submit(SetRegion{.region = 0, .options = slow});
  engine.submit(SetSwatch{.region = 0, .reference = {.path = "bricks.png"}});
  engine.finish();
  REQUIRE(engine.status().errors == 0);
}

bool synthesizing(const Engine& engine) {
  return engine.status().job.starts_with("Synthesize");
}

bool previewed(const Engine& engine) {
  const auto snapshot = engine.snapshot();
  if (!snapshot->previewState) return false;
  return std::any_of(snapshot->previewState->begin(), snapshot->previewState->end(),
                     [](PointState s) { return s != PointState::Free; });
}

// What must hold of any snapshot, whenever it is taken.
void checkConsistent(const Snapshot& snapshot) {
  const Document& d = snapshot.document;
  const std::size_t n = d.size();
  REQUIRE(snapshot.cursor < snapshot.history->size());
  REQUIRE(findRegion(d, kUnassigned) != nullptr);
  REQUIRE((d.labels ? d.labels->size() : 0) == n);
  if (d.labels)
    for (const RegionId id : *d.labels) REQUIRE(findRegion(d, id) != nullptr);
  if (d.selection) REQUIRE(d.selection->size() == n);
  if (snapshot.previewColour) REQUIRE(snapshot.previewColour->size() == n);
  if (snapshot.previewState) REQUIRE(snapshot.previewState->size() == n);
  if (!d.results.source) {
    REQUIRE(!d.results.colour);
    return;
  }
  REQUIRE(d.results.colour->size() == n);
  REQUIRE(d.results.texel->size() == n);
  REQUIRE(d.results.order->size() == n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint16_t s = (*d.results.source)[i];
    REQUIRE((s == kNoSource || s < d.results.sources.size()));
    if (s == kNoSource) REQUIRE((*d.results.state)[i] == PointState::Free);
  }
}

}  // namespace

TEST_CASE("the engine does what the commands alone would do") {
  const TestFolder folder;
  Engine engine(testOptions());
  const std::vector<Command> commands{
      OpenScan{.path = writeSphere(folder, 2000), .neighbours = 16},
      SelectWand{.seed = 5, .wand = {.by = WandBy::Colour, .threshold = 0.2f}},
      AddRegion{.name = "One side"},
      SetSwatch{.region = 1, .reference = {.path = "bricks.png"}},
      SetSwatch{.region = 0, .reference = {.path = "noise.png"}},
      Synthesize{}};
  Document alone = emptyDocument();
  for (const Command& command : commands) {
    engine.submit(command);
    alone = applied(alone, command);
  }
  engine.finish();
  const auto done = engine.snapshot();
  CHECK(engine.status().errors == 0);
  CHECK(sameContent(done->document, alone));
  CHECK(*done->history ==
        std::vector<std::string>{"New", "Open sphere.xyz", "Wand", "Add region One side",
                                 "Swatch bricks.png for One side",
                                 "Swatch noise.png for Whole scan", "Synthesize all"});
  CHECK(done->cursor == 6);
  for (int back = 0; back < 6; ++back) engine.submit(Undo{});
  engine.finish();
  CHECK(!engine.snapshot()->document.scan);
  engine.submit(GoTo{.entry = 6});
  engine.finish();
  CHECK(sameContent(engine.snapshot()->document, alone));
}

TEST_CASE("versions grow for what a command changes and for nothing else") {
  const TestFolder folder;
  Engine engine(testOptions());
  engine.submit(OpenScan{.path = writeSphere(folder, 500), .neighbours = 16});
  engine.finish();
  const auto before = engine.snapshot();
  engine.submit(Select{.points = {1, 2, 3}});
  engine.finish();
  const auto after = engine.snapshot();
  for (std::size_t part = 0; part < kParts; ++part) {
    const bool changes = part == static_cast<std::size_t>(Part::Selection) ||
                         part == static_cast<std::size_t>(Part::History);
    CHECK((after->version[part] > before->version[part]) == changes);
  }
}

TEST_CASE("an error names the command and the engine goes on") {
  const TestFolder folder;
  Engine engine(testOptions());
  engine.submit(OpenScan{.path = folder / "none.ply"});
  engine.finish();
  EngineStatus status = engine.status();
  CHECK(status.errors == 1);
  CHECK(status.failed == "Open none.ply");
  CHECK(status.error.find("none.ply") != std::string::npos);
  engine.submit(Undo{});
  engine.submit(SelectAll{});
  engine.submit(Synthesize{});
  engine.finish();
  CHECK(engine.status().errors == 4);
  engine.submit(OpenScan{.path = writeSphere(folder, 500), .neighbours = 16});
  engine.finish();
  CHECK(engine.status().errors == 4);
  CHECK(engine.snapshot()->document.size() == 500);
}

TEST_CASE("a synthesis shows progress and previews, and cancel leaves the document as before") {
  const TestFolder folder;
  Engine engine(testOptions());
  openSlow(engine, folder);
  const auto before = engine.snapshot();
  engine.submit(Synthesize{});
  REQUIRE(soon([&] { return previewed(engine); }));
  const EngineStatus status = engine.status();
  CHECK(status.busy);
  CHECK(status.job == "Synthesize all");
  CHECK(status.progress.stage == Stage::Synthesis);
  CHECK(engine.snapshot()->of(Part::Preview) > before->of(Part::Preview));
  const auto start = Clock::now();
  engine.cancel();
  CHECK(!engine.snapshot()->previewColour);  // at once, whenever the job notices
  engine.finish();
  CHECK(secondsSince(start) < 1);  // the bench measures it; this machine may be busy
  CHECK(sameContent(engine.snapshot()->document, before->document));
  CHECK(!engine.snapshot()->previewColour);
  CHECK(engine.snapshot()->history->size() == before->history->size());
  CHECK(engine.status().errors == 0);
}

TEST_CASE("stop keeps what was shown as an edit of its own") {
  const TestFolder folder;
  Engine engine(testOptions());
  openSlow(engine, folder);
  const auto before = engine.snapshot();
  engine.submit(Synthesize{});
  REQUIRE(soon([&] { return previewed(engine); }));
  engine.stop();
  engine.finish();
  const auto stopped = engine.snapshot();
  CHECK(stopped->history->back() == "Synthesize all (stopped)");
  REQUIRE(stopped->document.results.sources.size() == 1);
  CHECK(stopped->document.results.sources[0]->partial);
  std::size_t kept = 0;
  for (const std::uint16_t s : *stopped->document.results.source) kept += s == 0 ? 1 : 0;
  CHECK(kept > 0);
  CHECK(kept < stopped->document.size());
  checkConsistent(*stopped);
  engine.submit(Undo{});
  engine.finish();
  CHECK(sameContent(engine.snapshot()->document, before->document));
}

TEST_CASE("a paused job stands still until it is resumed, and can be cancelled") {
  const TestFolder folder;
  Engine engine(testOptions());
  openSlow(engine, folder);
  engine.submit(Synthesize{});
  REQUIRE(soon([&] { return previewed(engine); }));
  engine.pause();
  CHECK(engine.status().paused);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // what is under way ends
  const double fraction = engine.status().progress.fraction;
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(engine.status().progress.fraction == fraction);
  engine.resume();
  CHECK(
      soon([&] { return engine.status().progress.fraction > fraction || !synthesizing(engine); }));
  engine.pause();
  engine.cancel();
  engine.finish();
  CHECK(!engine.status().paused);
  CHECK(!engine.snapshot()->document.results.source);
}

TEST_CASE("selections go on while a synthesis works, and its result is the same") {
  const TestFolder folder;
  Engine engine(testOptions());
  openSlow(engine, folder, 12000);
  const Document expected = applied(engine.snapshot()->document, Synthesize{});
  engine.submit(Synthesize{});
  REQUIRE(soon([&] { return synthesizing(engine); }));
  engine.submit(Select{.points = {4, 5}});
  engine.submit(SetRegion{.region = 0, .name = "Ball"});
  REQUIRE(soon([&] { return engine.snapshot()->document.selection != nullptr; }));
  CHECK(synthesizing(engine));  // not waited for
  engine.finish();
  const auto done = engine.snapshot();
  CHECK(*done->document.results.colour == *expected.results.colour);
  CHECK(done->document.selection->points() == std::vector<Index>{4, 5});
  CHECK(findRegion(done->document, 0)->name == "Ball");
  CHECK(done->history->back() == "Synthesize all");
}

TEST_CASE("a command that changes what a job works from stops the job first") {
  const TestFolder folder;
  Engine engine(testOptions());
  openSlow(engine, folder);
  for (const Command& edit : {Command(SetSwatch{.region = 0, .reference = {.path = "noise.png"}}),
                              Command(SegmentAutomatically{.parts = 2}), Command(GoTo{2})}) {
    engine.submit(GoTo{.entry = 3});
    engine.submit(Synthesize{});
    REQUIRE(soon([&] { return synthesizing(engine); }));
    engine.submit(edit);
    engine.finish();
    CHECK(engine.status().errors == 0);
    CHECK(!engine.snapshot()->document.results.source);
  }
  CHECK(engine.snapshot()->cursor == 2);
}

TEST_CASE("an undo while a synthesis works cancels it and nothing else") {
  const TestFolder folder;
  Engine engine(testOptions());
  openSlow(engine, folder);
  const auto before = engine.snapshot();
  engine.submit(Synthesize{});
  REQUIRE(soon([&] { return synthesizing(engine); }));
  engine.submit(Undo{});
  engine.finish();
  CHECK(engine.status().errors == 0);
  CHECK(engine.snapshot()->cursor == before->cursor);
  CHECK(sameContent(engine.snapshot()->document, before->document));
  engine.submit(Undo{});  // nothing works any more: the step before
  engine.finish();
  CHECK(engine.snapshot()->cursor == before->cursor - 1);
}

TEST_CASE("what was edited beside a synthesis is undone and redone beside it") {
  const TestFolder folder;
  Engine engine(testOptions());
  openSlow(engine, folder);
  const auto before = engine.snapshot();
  const Document expected = applied(before->document, Synthesize{});
  engine.submit(Synthesize{});
  engine.submit(Select{.points = {4, 5}});
  engine.submit(Select{.points = {6}});
  REQUIRE(soon([&] { return engine.snapshot()->cursor == before->cursor + 2; }));
  engine.submit(Undo{});
  engine.submit(Undo{});
  REQUIRE(soon([&] { return engine.snapshot()->cursor == before->cursor; }));
  engine.submit(Redo{});
  engine.submit(GoTo{before->cursor + 2});
  engine.submit(Undo{});
  REQUIRE(soon([&] {
    const auto now = engine.snapshot();
    return now->cursor == before->cursor + 1 && now->history->size() == before->cursor + 3;
  }));
  CHECK(synthesizing(engine));
  engine.finish();
  const auto done = engine.snapshot();
  CHECK(done->history->back() == "Synthesize all");
  CHECK(done->document.selection->points() == std::vector<Index>{4, 5});
  CHECK(*done->document.results.colour == *expected.results.colour);
}

TEST_CASE("an undo after stop takes back what was kept") {
  const TestFolder folder;
  Engine engine(testOptions());
  openSlow(engine, folder);
  const auto before = engine.snapshot();
  engine.submit(Synthesize{});
  REQUIRE(soon([&] { return previewed(engine); }));
  engine.stop();
  engine.submit(Undo{});
  engine.finish();
  const auto undone = engine.snapshot();
  CHECK(undone->cursor == before->cursor);
  CHECK(undone->history->back() == "Synthesize all (stopped)");
  CHECK(sameContent(undone->document, before->document));
}

TEST_CASE("a project is saved and a scan exported while a synthesis works") {
  const TestFolder folder;
  Engine engine(testOptions());
  openSlow(engine, folder);
  TextureOptions fast = optionsOf(Method::Triplanar);
  TextureOptions slow = engine.snapshot()->document.regions->front().options;
  engine.submit(SetRegion{.region = 0, .options = fast});
  engine.submit(SetSwatch{.region = 0, .reference = {.path = folder / "bricks.png"}});
  engine.submit(Synthesize{});
  engine.finish();
  engine.submit(SetRegion{.region = 0, .options = slow});
  engine.finish();
  const Document present = engine.snapshot()->document;
  engine.submit(Synthesize{});
  REQUIRE(soon([&] { return synthesizing(engine); }));
  engine.pause();  // and even while it stands still
  const std::string project = folder / "beside.dapple", scan = folder / "beside.ply";
  engine.submit(SaveProject{.path = project});
  engine.submit(ExportScan{.path = scan});
  REQUIRE(soon([&] { return std::filesystem::exists(project) && std::filesystem::exists(scan); }));
  engine.submit(Select{.points = {1}});  // nor does anything wait for them
  REQUIRE(soon([&] { return engine.snapshot()->document.selection != nullptr; }));
  CHECK(synthesizing(engine));
  CHECK(engine.status().paused);
  engine.cancel();
  engine.finish();
  CHECK(engine.status().errors == 0);
  CHECK(sameContent(applied(emptyDocument(), OpenProject{.path = project}), present));
  const Document exported = applied(emptyDocument(), OpenScan{.path = scan, .neighbours = 16});
  CHECK(exported.size() == present.size());
}

TEST_CASE("the points of a scan are shown before it is open, and no longer than that") {
  const TestFolder folder;
  const std::string path = writeSphere(folder, 200000);
  Engine engine(testOptions());
  engine.submit(OpenScan{.path = path, .neighbours = 16});
  auto opening = engine.snapshot();
  REQUIRE(soon([&] { return (opening = engine.snapshot())->opening != nullptr; }));
  CHECK(!opening->document.scan);
  CHECK(opening->opening->size() == 200000);
  engine.finish();
  const auto done = engine.snapshot();
  CHECK(!done->opening);
  CHECK(opening->opening->positions == done->document.points().positions);
}

TEST_CASE("the region that is being synthesized is the only one that edits must not touch") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 1000);
  d = applied(d, Select{.points = half(d, true)});
  d = applied(d, AddRegion{});
  const Command job = Synthesize{.region = 1};
  CHECK(meeting(SetSwatch{.region = 1}, job, d) == Meeting::Stops);
  CHECK(meeting(SetSwatch{.region = 0}, job, d) == Meeting::Beside);
  CHECK(meeting(SetRegion{.region = 1, .name = "x"}, job, d) == Meeting::Beside);
  CHECK(meeting(SetRegion{.region = 1, .rotation = 3}, job, d) == Meeting::Stops);
  CHECK(meeting(AssignSelection{.region = 0}, job, d) == Meeting::Stops);  // takes points away
  CHECK(meeting(Undo{}, job, d) == Meeting::Stops);
  CHECK(meeting(Synthesize{.region = 0}, job, d) == Meeting::Waits);
  CHECK(meeting(SaveProject{}, job, d) == Meeting::Beside);
  CHECK(meeting(SaveProject{}, SaveProject{}, d) == Meeting::Waits);
  CHECK(meeting(Synthesize{}, SaveProject{}, d) == Meeting::Beside);
  d = applied(d, InvertSelection{});
  CHECK(meeting(AssignSelection{.region = 0}, job, d) == Meeting::Beside);
  CHECK(meeting(AssignSelection{.region = 1}, job, d) == Meeting::Stops);
  CHECK(meeting(Undo{}, SaveProject{}, d) == Meeting::Beside);
  CHECK(meeting(SelectAll{}, OpenScan{}, d) == Meeting::Waits);
  CHECK(meeting(OpenScan{}, OpenProject{}, d) == Meeting::Stops);
}

TEST_CASE("200 random walks of starts, edits, stops and cancels end in consistent documents") {
  const TestFolder folder;
  Engine engine(testOptions());
  engine.submit(OpenScan{.path = writeSphere(folder, 1500), .neighbours = 16});
  engine.finish();
  std::atomic<bool> watching = true;
  std::thread viewer([&] {  // what a window does at its own rate
    while (watching) {
      checkConsistent(*engine.snapshot());
      engine.status();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  const Index n = 1500;
  for (std::uint64_t walk = 0; walk < 200; ++walk) {
    for (std::uint64_t step = 0; step < 8; ++step) {
      const auto below = [&](std::uint64_t count, std::uint64_t stream) {
        return hashBelow(count, 5, walk, step, stream);
      };
      const auto region = static_cast<RegionId>(below(4, 9));
      switch (below(16, 0)) {
        case 0:
          engine.cancel();
          break;
        case 1:
          engine.stop();
          break;
        case 2:
          engine.pause();
          break;
        case 3:
          engine.resume();
          break;
        case 4:
          engine.submit(Undo{});
          break;
        case 5:
          engine.submit(Redo{});
          break;
        case 6:
          engine.submit(SelectWand{.seed = static_cast<Index>(below(n, 1))});
          break;
        case 7:
          engine.submit(AddRegion{});
          break;
        case 8:
          engine.submit(AssignSelection{.region = region});
          break;
        case 9:
          engine.submit(RemoveRegion{.region = region});
          break;
        case 10:
          engine.submit(SetSwatch{.region = region, .reference = {.path = "bricks.png"}});
          break;
        case 11:
          engine.submit(ClearResult{});
          break;
        case 12:
          engine.submit(SegmentAutomatically{.parts = 3});
          break;
        case 13:
          engine.submit(
              SetRegion{.region = region, .options = optionsOf(static_cast<Method>(below(5, 2)))});
          break;
        case 14:
          engine.submit(SaveProject{.path = folder / "walk.dapple"});
          break;
        default:
          engine.submit(Synthesize{});
          break;
      }
      if (below(3, 3) == 0) std::this_thread::sleep_for(std::chrono::microseconds(below(3000, 4)));
    }
    engine.resume();
    engine.finish();
    checkConsistent(*engine.snapshot());
  }
  watching = false;
  viewer.join();
  // And it still works.
  engine.submit(Select{});
  engine.submit(SetRegion{.region = 0, .locked = false});
  engine.submit(GoTo{.entry = 0});
  engine.finish();
  CHECK(engine.snapshot()->cursor == 0);
}

TEST_CASE("an engine that is destroyed in the middle of a job stops it") {
  const TestFolder folder;
  const auto start = Clock::now();
  {
    Engine engine(testOptions());
    openSlow(engine, folder);
    engine.submit(Synthesize{});
    REQUIRE(soon([&] { return synthesizing(engine); }));
  }
  CHECK(secondsSince(start) < 20);
}
