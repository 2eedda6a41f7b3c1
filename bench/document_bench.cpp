// Prints how long the engine alone takes on a sphere of 1 M points: selections, undo, the echo of
// an edit, cancel, saving. Medians; nothing is asserted. What a person sees of it, previews and
// memory are dapple_editor_bench's.
//
// dapple_document_bench [POINTS [--edits]]
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>

#include "document/engine.h"
#include "document/region_field.h"
#include "document/region_synthesis.h"
#include "io/ply.h"
#include "tests/fixtures.h"
#include "timing.h"

namespace {

using namespace dapple;
using bench::medianSeconds;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Of all threads: what a busy machine does not change much.
double cpuSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void print(const std::string& what, double seconds, const std::string& target = "") {
  fmt::print("{:<52} {:>9.1f} ms   {}\n", what, seconds * 1e3, target);
  std::fflush(stdout);
}

std::filesystem::path writeSphere(std::size_t count, Monitor& monitor) {
  const PointSet sphere = fixtures::makeSphere(count, 1);
  Element vertices{.name = "vertex", .count = count};
  std::vector<float> column(count);
  static constexpr const char* kNames[] = {"x", "y", "z", "nx", "ny", "nz"};
  for (int c = 0; c < 6; ++c) {
    for (std::size_t i = 0; i < count; ++i)
      column[i] = c < 3 ? sphere.positions[i][c] : sphere.normals[i][c - 3];
    setColumn(vertices, kNames[c], column);
  }
  std::vector<std::uint8_t> level(count);
  for (const char* name : {"red", "green", "blue"}) {
    for (std::size_t i = 0; i < count; ++i)
      level[i] = sphere.positions[i].x < 0 ? 200 : static_cast<std::uint8_t>(name[0]);
    setColumn(vertices, name, level);
  }
  RecordTable table;
  table.elements.push_back(std::move(vertices));
  const auto path = std::filesystem::temp_directory_path() / "dapple_document_bench.ply";
  savePly(path, table, false, monitor);
  return path;
}

void benchSelections(const Document& d, Monitor& monitor) {
  const Index seed = static_cast<Index>(d.size() / 3);
  const auto time = [&](const char* what, const Command& command, const Document& on) {
    Document out;
    double cpu = 1e9;  // least of all threads together
    const double seconds = medianSeconds(5, [&] {
      const double before = cpuSeconds();
      out = apply(on, command, {}, monitor);
      cpu = std::min(cpu, cpuSeconds() - before);
    });
    const std::size_t count = out.selection ? out.selection->count() : 0;
    print(fmt::format("{} ({} k selected)", what, count / 1000), seconds,
          fmt::format("<= 100 ms; {:.1f} ms of processor", 1e3 * cpu));
  };
  time("wand by normal, 30 degrees",
       SelectWand{.seed = seed, .wand = {.by = WandBy::Normal, .threshold = 30}}, d);
  time("wand by normal, all",
       SelectWand{.seed = seed, .wand = {.by = WandBy::Normal, .threshold = 180}}, d);
  time("wand by colour, half",
       SelectWand{.seed = seed, .wand = {.by = WandBy::Colour, .threshold = 0.1f}}, d);
  time("wand by colour, anywhere",
       SelectWand{.seed = seed,
                  .wand = {.by = WandBy::Colour, .threshold = 0.1f, .connected = false}},
       d);
  time("wand by distance, 100 spacings",
       SelectWand{.seed = seed, .wand = {.by = WandBy::Distance, .threshold = 100}}, d);
  time("wand by distance, all",
       SelectWand{.seed = seed, .wand = {.by = WandBy::Distance, .threshold = 1e6f}}, d);
  time("connected, all", SelectConnected{.seed = seed}, d);
  const Document half = apply(
      d, SelectWand{.seed = seed, .wand = {.by = WandBy::Colour, .threshold = 0.1f}}, {}, monitor);
  time("grow half", GrowSelection{}, half);
  time("shrink half", ShrinkSelection{}, half);
  time("invert half", InvertSelection{}, half);
  time("assign half", AssignSelection{.region = kUnassigned}, half);
  for (const int parts : {4, 12})
    print(fmt::format("segment into {} parts", parts),
          medianSeconds(1, [&] { apply(d, SegmentAutomatically{.parts = parts}, {}, monitor); }));
}

// From submit() to the snapshot that shows it.
double echo(Engine& engine, const Command& command) {
  const auto before = engine.snapshot();
  const auto start = Clock::now();
  engine.submit(command);
  while (engine.snapshot() == before) std::this_thread::yield();
  return secondsSince(start);
}

struct Watched {
  double total = 0, longestCall = 0;
};

// A window that looks at the engine every millisecond while a synthesis works.
Watched watch(Engine& engine) {
  Watched out;
  const auto start = Clock::now();
  engine.submit(Synthesize{});
  for (bool busy = true; busy;) {
    const auto call = Clock::now();
    const auto snapshot = engine.snapshot();
    busy = engine.status().busy;
    out.longestCall = std::max(out.longestCall, secondsSince(call));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  out.total = secondsSince(start);
  return out;
}

// The longest of several cancels at moments spread over the whole synthesis.
double longestCancel(Engine& engine, double total, int tries) {
  double longest = 0;
  for (int t = 0; t < tries; ++t) {
    engine.submit(Synthesize{});
    std::this_thread::sleep_for(std::chrono::duration<double>(total * (t + 0.5) / tries));
    const auto start = Clock::now();
    engine.cancel();
    engine.finish();
    longest = std::max(longest, secondsSince(start));
  }
  return longest;
}

void benchJobs(Engine& engine, Method method, const char* name) {
  TextureOptions options;
  options.method = method;
  engine.submit(SetRegion{.region = kUnassigned, .options = options});
  engine.finish();
  const Document ready = engine.snapshot()->document;
  Workers workers;
  Monitor monitor(workers);
  std::vector<double> aloneCpu;
  print(fmt::format("{}: synthesis alone", name), medianSeconds(3, [&] {
          const double before = cpuSeconds();
          apply(ready, Synthesize{}, {}, monitor);
          aloneCpu.push_back(cpuSeconds() - before);
        }));
  print(fmt::format("{}: processor time of it, least of 4", name),
        *std::min_element(aloneCpu.begin(), aloneCpu.end()));
  std::vector<Watched> runs;
  double cpu = 1e9;
  for (int r = 0; r < 4; ++r) {
    const double before = cpuSeconds();
    runs.push_back(watch(engine));
    cpu = std::min(cpu, cpuSeconds() - before);
    engine.submit(Undo{});
    engine.finish();
  }
  std::sort(runs.begin(), runs.end(),
            [](const Watched& a, const Watched& b) { return a.total < b.total; });
  const Watched w = runs[1];
  print(fmt::format("{}: processor time with previews and window", name), cpu);
  print(fmt::format("{}: synthesis with a window looking on", name), w.total);
  print(fmt::format("{}: longest snapshot() + status()", name), w.longestCall, "<= 33 ms");
  print(fmt::format("{}: longest of 20 cancels", name), longestCancel(engine, w.total, 20),
        "<= 100 ms");
  engine.submit(Synthesize{});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  double slowest = 0;
  for (Index i = 0; i < 20 && engine.status().job.size() > 0; ++i) {
    const auto start = Clock::now();
    const auto version = engine.snapshot()->of(Part::Selection);
    engine.submit(Select{.points = {i}});
    while (engine.snapshot()->of(Part::Selection) == version) std::this_thread::yield();
    slowest = std::max(slowest, secondsSince(start));
  }
  print(fmt::format("{}: slowest of 20 selections meanwhile", name), slowest, "<= 50 ms");
  engine.cancel();
  engine.finish();
}

// A short stroke eastwards from the point that is nearest to where the golden spiral puts it.
Stroke eastward(const Document& d, std::size_t number, std::size_t of, float turn) {
  const PointSet& points = d.points();
  const std::size_t start = points.size() * number / of;
  const vec3 from = points.positions[start], normal = points.normals[start];
  const vec3 east = glm::normalize(glm::cross(vec3(0, 1, 0.01f), normal));
  const vec3 way = std::cos(turn) * east + std::sin(turn) * glm::cross(normal, east);
  Stroke stroke;
  for (int step = 0; step < 8; ++step) {
    const vec3 wanted = from + way * (0.004f * static_cast<float>(step));
    Index at = stroke.points.empty() ? static_cast<Index>(start) : stroke.points.back();
    for (bool nearer = true; nearer;) {
      nearer = false;
      for (const Index j : d.scan->prepared.neighborhoods.of(at))
        if (glm::length(points.positions[j] - wanted) < glm::length(points.positions[at] - wanted))
          at = j, nearer = true;
    }
    if (!stroke.points.empty() && stroke.points.back() == at) continue;
    stroke.points.push_back(at);
    stroke.positions.push_back(points.positions[at]);
  }
  return stroke;
}

// One of many strokes is turned: what is synthesized again, and how long it takes.
void benchEdits(const Document& opened, Method method, const char* name) {
  constexpr std::size_t kStrokes = 98;  // so few that turning one concerns some 20,000 points
  Workers workers;
  Monitor monitor(workers);
  std::unique_ptr<RegionField> kept;
  CommandContext context{.field = &kept};
  std::size_t worked = 0;
  context.watch.begins = [&](std::span<const Index> points, std::size_t, std::size_t) {
    worked = points.size();
  };
  Document d =
      apply(opened, SetRegion{.region = kUnassigned, .options = TextureOptions{.method = method}},
            {}, monitor);
  for (std::size_t s = 0; s < kStrokes; ++s)
    d = apply(d, AddStroke{kUnassigned, eastward(d, s, kStrokes, 0)}, {}, monitor);
  const Synthesize again{.region = kUnassigned, .onlyChanged = true};
  const auto first = Clock::now();
  d = apply(d, again, context, monitor);
  print(fmt::format("{}: all of it, with {} strokes", name, kStrokes), secondsSince(first));
  float turn = 0.25f;
  double cpu = 1e9;  // least of all threads together
  const double seconds = medianSeconds(9, [&] {
    turn = -turn;
    const SetStroke edit{kUnassigned, kStrokes / 2, eastward(d, kStrokes / 2, kStrokes, turn)};
    const double before = cpuSeconds();
    d = apply(apply(d, edit, {}, monitor), again, context, monitor);
    cpu = std::min(cpu, cpuSeconds() - before);
  });
  print(fmt::format("{}: a stroke is turned ({:.1f} k points again)", name,
                    static_cast<double>(worked) / 1e3),
        seconds, fmt::format("<= 100 ms for 20 k; {:.1f} ms of processor", 1e3 * cpu));
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t count = argc > 1 ? std::stoul(argv[1]) : 1'000'000;
  const bool onlyEdits = argc > 2 && std::string_view(argv[2]) == "--edits";
  Workers workers;
  Monitor monitor(workers);
  const auto path = writeSphere(count, monitor);
  Engine engine({.readImage = [](const auto&) { return fixtures::bricks(128); }});
  const auto start = Clock::now();
  engine.submit(OpenScan{.path = path.string()});
  engine.finish();
  print(fmt::format("open {} points with neighbours", count), secondsSince(start));
  const Document d = engine.snapshot()->document;
  if (!onlyEdits) benchSelections(d, monitor);
  print("echo of a selection of 50 k points through the engine",
        medianSeconds(5,
                      [&] {
                        std::vector<Index> some(std::min<std::size_t>(50'000, count / 2));
                        for (std::size_t i = 0; i < some.size(); ++i)
                          some[i] = static_cast<Index>(i);
                        echo(engine, Select{.points = std::move(some)});
                      }),
        "<= 50 ms");
  engine.submit(SetSwatch{.region = kUnassigned, .reference = {.path = "bricks.png"}});
  engine.finish();
  benchEdits(engine.snapshot()->document, Method::Hybrid, "hybrid");
  benchEdits(engine.snapshot()->document, Method::Match, "match");
  benchEdits(engine.snapshot()->document, Method::Coordinates, "coordinates");
  if (onlyEdits) return 0;
  benchJobs(engine, Method::Hybrid, "hybrid");
  benchJobs(engine, Method::Patches, "patches");
  benchJobs(engine, Method::Match, "match");
  engine.submit(Synthesize{});
  engine.finish();
  print("undo of a whole synthesis", echo(engine, Undo{}), "<= 100 ms");
  print("redo of it", echo(engine, Redo{}), "<= 100 ms");
  const Document done = engine.snapshot()->document;
  const std::string project = path.string() + ".dapple";
  const CommandContext context{.readImage = [](const auto&) { return fixtures::bricks(128); }};
  print("save the project",
        medianSeconds(1, [&] { apply(done, SaveProject{.path = project}, context, monitor); }));
  print("open the project", medianSeconds(1, [&] {
          apply(emptyDocument(), OpenProject{.path = project}, context, monitor);
        }));
  std::filesystem::remove(path);
  std::filesystem::remove(project);
}
