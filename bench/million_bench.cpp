// What a person waits for when 1,000,000 points without normals are textured by their coordinates:
// the synthesis alone, the first picture of the whole surface, and `dapple texture` from file to
// file with its peak memory, on one and on two threads, beside what is asked. Medians; nothing is
// asserted.
//
// dapple_million_bench [--quick] [POINTS]
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "document/texture_job.h"
#include "io/image_io.h"
#include "io/ply.h"
#include "tests/fixtures.h"
#include "timing.h"

namespace {

using namespace dapple;
using bench::median;
using bench::secondsOf;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A file that goes with its owner.
struct TemporaryFile {
  fs::path path;
  explicit TemporaryFile(const char* name)
      : path(fs::temp_directory_path() /
             fmt::format("dapple_million_bench.{}.{}", getpid(), name)) {}
  ~TemporaryFile() { fs::remove(path); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
};

// A sphere without normals.
void writeSphere(const fs::path& path, std::size_t count) {
  Workers workers;
  Monitor monitor(workers);
  const PointSet sphere = fixtures::makeSphere(count, 1);
  Element vertices{.name = "vertex", .count = count};
  std::vector<float> column(count);
  static constexpr const char* kNames[] = {"x", "y", "z"};
  for (int c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < count; ++i) column[i] = sphere.positions[i][c];
    setColumn(vertices, kNames[c], column);
  }
  RecordTable table;
  table.elements.push_back(std::move(vertices));
  savePly(path, table, false, monitor);
}

// The options of the run: those of the program unless it says so.
TextureOptions coordinateOptions() {
  TextureOptions options;
  options.method = Method::Coordinates;
  return options;
}

struct Spent {
  double seconds = 0, gigabytes = 0;
};

// The program from file to file, in a process of its own. Throws when it fails.
Spent endToEnd(const fs::path& scan, const fs::path& out, unsigned threads) {
  std::vector<std::string> words{DAPPLE_PROGRAM,          "texture",  scan.string(), "--swatch",
                                 DAPPLE_BENCH_SWATCH,     "--method", "coordinates", "--threads",
                                 std::to_string(threads), "--quiet",  "-o",          out.string()};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const auto start = Clock::now();
  // Not spawned: the memory that the parent ever had would count as the child's.
  const pid_t child = fork();
  if (child == 0) {
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0)
    throw std::runtime_error(
        fmt::format("{} texture: failed with status {}", DAPPLE_PROGRAM, status));
  return {secondsSince(start), static_cast<double>(usage.ru_maxrss) * 1024 / 1e9};
}

// Seconds of a synthesis that nobody watches, as `dapple texture` has it, and of one with previews.
// `firstWhole` counts from its start to the first preview in which no point is free; the end when
// there is none.
struct Watched {
  double directions = 0, synthesis = 0, shown = 0, firstWhole = 0;
  TexturedPoints result;
};

Watched watched(const PreparedScan& prepared, const Swatch& swatch, Workers& workers) {
  const TextureOptions options = coordinateOptions();
  const PointSet& points = prepared.scan.points;
  Watched out;
  Clock::time_point start;
  const auto look = [&](const Preview& preview) {
    const auto& states = preview.states;
    if (out.firstWhole > 0 ||
        std::find(states.begin(), states.end(), PointState::Free) != states.end())
      return;
    out.firstWhole = secondsSince(start);
  };
  Monitor monitor(workers, {}, {.preview = look});
  OrientationField field;
  out.directions = secondsOf(
      [&] { field = directionsOf(points, prepared.neighborhoods, {}, options, monitor); });
  const SynthesisInput input{.points = points,
                             .neighborhoods = prepared.neighborhoods,
                             .swatch = swatch,
                             .frames = field.frames,
                             .unit = prepared.spacing * static_cast<float>(options.scale),
                             .scale = field.scale};
  Monitor unwatched(workers);
  out.synthesis = secondsOf([&] { out.result.map = synthesize(input, options, unwatched).map; });
  start = Clock::now();
  synthesize(input, options, monitor);
  out.shown = secondsSince(start);
  if (out.firstWhole <= 0) out.firstWhole = out.shown;
  out.result.frames = std::move(field.frames);
  return out;
}

// A figure on one and on two threads.
struct Row {
  const char* name;
  const char* format;
  std::vector<double> figures;
  const char* target;
};

void print(const Row& row) {
  fmt::print("{:<44}", row.name);
  for (const double figure : row.figures)
    fmt::print(" {:>11}", fmt::format(fmt::runtime(row.format), figure));
  fmt::print("   {}\n", row.target);
  std::fflush(stdout);
}

void printEndToEnd(const fs::path& scan, int runs) {
  const TemporaryFile out("out.ply");
  Row seconds{"dapple texture, file to file", "{:.2f} s", {}, "<= 5 s; <= 3 s"};
  Row memory{"  its peak memory", "{:.3f} GB", {}, "<= 0.35 GB"};
  for (const unsigned threads : {1u, 2u}) {
    std::vector<double> times, peaks;
    for (int r = 0; r < runs; ++r) {
      const Spent spent = endToEnd(scan, out.path, threads);
      times.push_back(spent.seconds), peaks.push_back(spent.gigabytes);
    }
    seconds.figures.push_back(median(times));
    memory.figures.push_back(median(peaks));
  }
  print(seconds);
  print(memory);
}

void printSynthesis(const fs::path& scan, int runs) {
  Row rate{"synthesis alone", "{:.2f} M/s", {}, ">= 0.5 M points/s; >= 0.9 M"};
  Row shown{"  with pictures while it runs", "{:.2f} M/s", {}, ""};
  Row first{"  first picture of the whole surface", "{:.2f} s", {}, "<= 0.5 s; <= 0.3 s"};
  Row directions{"directions before it", "{:.2f} s", {}, ""};
  Row before{"load, neighbours and normals before them", "{:.2f} s", {}, ""};
  Row free{"its F", "{:.2f}", {}, "(methods: CCS .67, as the mean of 8 swatches on a bunny)"};
  Row oriented{"  oriented", "{:.2f}", {}, "(.73)"};
  for (const unsigned threads : {1u, 2u}) {
    Workers workers(threads);
    Monitor monitor(workers);
    const TextureOptions options = coordinateOptions();
    const Swatch swatch = makeSwatch(readImage(DAPPLE_BENCH_SWATCH), options.tileable,
                                     stackLevels(options), "pebbles");
    const PreparedScan prepared = prepareScan(scan, {}, options.neighbours, {}, monitor);
    std::vector<double> rates, shownRates, firsts, fields;
    const double millions = static_cast<double>(prepared.scan.points.size()) / 1e6;
    for (int r = 0; r < runs; ++r) {
      const Watched w = watched(prepared, swatch, workers);
      rates.push_back(millions / w.synthesis), shownRates.push_back(millions / w.shown);
      firsts.push_back(w.firstWhole), fields.push_back(w.directions);
      if (r > 0 || threads == 1) continue;  // of the same bytes once
      const TextureScore score = scorePoints(prepared,
                                             {.colours = w.result.map.colour,
                                              .swatch = swatch,
                                              .unit = w.result.map.unit,
                                              .map = &w.result.map,
                                              .frames = &w.result.frames},
                                             monitor);
      free.figures.push_back(score.F);
      oriented.figures.push_back(score.orientedF.value_or(0));
    }
    rate.figures.push_back(median(rates));
    shown.figures.push_back(median(shownRates));
    first.figures.push_back(median(firsts));
    directions.figures.push_back(median(fields));
    before.figures.push_back(prepared.seconds.load + prepared.seconds.neighbours +
                             prepared.seconds.normals);
  }
  for (const Row& row : {rate, shown, first, directions, before, free, oriented}) print(row);
}

}  // namespace

int main(int argc, char** argv) try {
  std::size_t count = 1'000'000;
  int runs = 5;
  for (int a = 1; a < argc; ++a) {
    if (std::string(argv[a]) == "--quick")
      runs = 1;
    else
      count = std::stoul(argv[a]);
  }
  const TemporaryFile scan("scan.ply");
  writeSphere(scan.path, count);
  fmt::print(
      "\ncoordinates on a sphere of {} points, median of {} runs\n{:<44} {:>11} {:>11}   {}\n",
      count, runs, "", "1 thread", "2 threads", "to reach (1 M points)");
  // First, while this process is small: a child starts with its parent's memory.
  printEndToEnd(scan.path, runs);
  printSynthesis(scan.path, runs);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "dapple_million_bench: {}\n", error.what());
  return 2;
}
