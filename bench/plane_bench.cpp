// How good and how fast is Dapple in the plane, where other programs synthesize, too? 256 x 256
// pixels from the top left of each shared texture, measured beside G'MIC (Debian's package gmic)
// and the figures that Resynthesizer had on the same samples; and beside pictures that are bad in
// known ways, so that a measure that is broken is noticed. A time is that of the whole process less
// that of one that does nothing, each the least of five, as others may be using the machine.
//
// dapple_plane_bench [--quick] [--only NAME] [--keep FOLDER]
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "io/image_io.h"
#include "plane_measures.h"
#include "swatch/gaussian_blur.h"
#include "swatch/swatch.h"

namespace {

using namespace dapple;
using bench::measurePlane;
using bench::PlaneMeasures;
namespace fs = std::filesystem;

constexpr int kSize = 256, kSample = 128, kRuns = 5;
constexpr int kBlock = 32;     // side of the squares of a bad picture, pixels
constexpr double kBlur = 1.5;  // sigma of another, pixels
constexpr std::uint64_t kSeed = 5;

// What was measured before, on the same samples with other code: coh7, seam, com15, per.
struct Figures {
  double coh7, seam, com15, per;
};
struct Case {
  const char* file;
  Figures gmic, resynthesizer;  // matchpatch; patches of 30 pixels
};
constexpr Case kCases[] = {
    {"efros_olives.png", {4.8, 18.7, 6.5, .31}, {4.0, 20.8, 3.5, .23}},
    {"efros_berries.png", {4.9, 17.9, 5.7, .29}, {4.2, 22.4, 8.4, .15}},
    {"acg_rocks023.png", {3.2, 12.0, 4.5, .40}, {4.3, 13.8, 5.8, .07}},
    {"acg_fabric015.png", {8.0, 22.4, 4.2, .08}, {3.4, 14.5, 2.2, .06}},
    {"acg_woodfloor020.png", {4.1, 16.6, 2.7, .10}, {3.2, 14.9, 2.6, .09}},
    {"acg_terrazzo009.png", {4.6, 17.0, 11.1, .13}, {5.3, 21.3, 5.3, .08}},
    {"acg_wood004.png", {1.0, 2.8, 1.2, .27}, {1.1, 3.2, 1.2, .04}},
    {"gimp_burlap.png", {4.5, 17.6, 7.1, .08}, {5.3, 20.5, 4.0, .04}},
    {"ph_aerial_rocks.png", {3.6, 11.7, 3.5, .20}, {3.7, 12.6, 5.7, .05}},
    {"ps_reptil_skin.png", {7.7, 27.0, 10.5, .27}, {5.6, 29.1, 7.3, .09}},
    {"efros_basketweave.png", {2.9, 11.6, 4.3, .26}, {3.1, 13.6, 5.0, .06}},
};

// The gate: times the worse of the two peers, or an absolute. Beside it stands the peers' level,
// where as much of a period is let pass as the worse of them has: they do not all pass the gate.
constexpr double kCohFactor = 1.15, kComFactor = 1.5, kMostGrad = 3, kMostAcf = 0.12,
                 kMostPer = 0.15;

struct Arguments {
  bool quick = false;
  std::string only;
  fs::path folder;  // of samples and outputs
  bool keep = false;
};

// Top left square of `side` pixels, RGB.
Image sampleOf(const Image& image, int side) {
  Image out{std::min(side, image.width), std::min(side, image.height), 3, {}};
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int c = 0; c < 3; ++c) out.pixels.push_back(image.at(x, y, image.channels >= 3 ? c : 0));
  return out;
}

// A picture whose pixel (x, y) is the sample's at place(x, y).
Image pictureOf(const Image& sample, const std::function<ivec2(int, int)>& place) {
  Image out{kSize, kSize, 3, {}};
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const ivec2 at = place(x, y);
      for (int c = 0; c < 3; ++c) out.pixels.push_back(sample.at(at.x, at.y, c));
    }
  return out;
}

Image tiled(const Image& sample) {
  return pictureOf(sample,
                   [&](int x, int y) { return ivec2(x % sample.width, y % sample.height); });
}

ivec2 randomPlace(ivec2 room, std::uint64_t id) {
  return {static_cast<int>(hashBelow(static_cast<std::uint64_t>(room.x), kSeed, id, 0)),
          static_cast<int>(hashBelow(static_cast<std::uint64_t>(room.y), kSeed, id, 1))};
}

Image randomPixels(const Image& sample) {
  return pictureOf(sample, [&](int x, int y) {
    return randomPlace({sample.width, sample.height}, static_cast<std::uint64_t>(y * kSize + x));
  });
}

Image randomBlocks(const Image& sample) {
  const ivec2 room(sample.width - kBlock + 1, sample.height - kBlock + 1);
  return pictureOf(sample, [&](int x, int y) {
    const int block = y / kBlock * (kSize / kBlock) + x / kBlock;
    return randomPlace(room, static_cast<std::uint64_t>(block)) + ivec2(x % kBlock, y % kBlock);
  });
}

Image blurred(const Image& image) {
  Image out{image.width, image.height, 3, {}};
  for (const vec3& colour : blurSwatch(makeSwatch(image, Tileable::No, 1, "picture"), kBlur))
    for (int c = 0; c < 3; ++c) out.pixels.push_back(colour[c]);
  return out;
}

// Seconds of the command; none when it fails.
std::optional<double> secondsOf(const std::string& command) {
  const auto start = std::chrono::steady_clock::now();
  const int code = std::system((command + " >/dev/null 2>&1").c_str());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  return code == 0 ? std::optional(took.count()) : std::nullopt;
}

// The least of some runs.
std::optional<double> leastSeconds(const std::string& command) {
  std::vector<double> times;
  for (int run = 0; run < kRuns; ++run) {
    const auto seconds = secondsOf(command);
    if (!seconds) return std::nullopt;
    times.push_back(*seconds);
  }
  return *std::min_element(times.begin(), times.end());
}

std::string quoted(const fs::path& path) {
  return "'" + path.string() + "'";  // neither folder nor samples have quotes in their names
}

struct Program {
  std::string name;
  std::function<std::string(const fs::path&in, const fs::path&out)> command, nothing;
};

const Program kGmic{"G'MIC matchpatch",
                    [](const fs::path& in, const fs::path& out) {
                      return fmt::format("gmic {} syntexturize_matchpatch {},{} -o {}", quoted(in),
                                         kSize, kSize, quoted(out));
                    },
                    [](const fs::path& in, const fs::path& out) {
                      return fmt::format("gmic {} -o {}", quoted(in), quoted(out));
                    }};
const Program kDapple{"dapple synth2d",
                      [](const fs::path& in, const fs::path& out) {
                        return fmt::format("'{}' synth2d {} --size {}x{} -o {}", DAPPLE_PROGRAM,
                                           quoted(in), kSize, kSize, quoted(out));
                      },
                      // As G'MIC's: a picture is read, and another written.
                      [](const fs::path& in, const fs::path& out) {
                        return fmt::format("'{}' synth2d {} --size 2x2 -o {}", DAPPLE_PROGRAM,
                                           quoted(in), quoted(out));
                      }};

void printRow(const std::string& name, const PlaneMeasures& m, std::optional<double> seconds = {}) {
  fmt::print("  {:<18}{:7.2f}{:7.2f}{:7.2f}{:7.2f}{:7.2f}{:7.2f}{:7.2f}{:7.2f}{:7.2f}{:>9}\n", name,
             m.coh7, m.seam, m.coh15, m.com7, m.com15, m.swd, m.grad, m.acf, m.per,
             seconds ? fmt::format("{:.0f} ms", *seconds * 1e3) : "");
}

// Runs a program on a sample and measures what it made; none when it fails.
std::optional<PlaneMeasures> measured(const Program& program, const Image& sample,
                                      const fs::path& in, Workers& workers) {
  fs::path out = in;
  out.replace_filename(in.stem().string() + (program.name == kGmic.name ? "_gmic" : "_dapple") +
                       ".png");
  const auto seconds = leastSeconds(program.command(in, out));
  const auto nothing = leastSeconds(program.nothing(in, out.string() + ".start.png"));
  if (!seconds || !nothing || !fs::exists(out)) {
    fmt::print("  {:<18}failed\n", program.name);
    return std::nullopt;
  }
  const PlaneMeasures measures = measurePlane(sample, sampleOf(readImage(out), kSize), workers);
  printRow(program.name, measures, *seconds - *nothing);
  return measures;
}

// What must hold of pictures that are bad in known ways, whatever the sample.
void checkControls(const PlaneMeasures& tiling, const PlaneMeasures& pixels,
                   const PlaneMeasures& blocks, const PlaneMeasures& blur) {
  const std::pair<const char*, bool> checks[] = {
      {"tiling: the sample is all there", tiling.com7 < 0.01 && tiling.com15 < 0.01},
      {"tiling: a period", tiling.per > 0.2},
      {"random pixels: colours right, patches wrong",
       pixels.swd < 1 && pixels.coh7 > 3 * tiling.coh7 && pixels.com15 > pixels.com7},
      {"random pixels and blur: gradients", pixels.grad > tiling.grad && blur.grad > tiling.grad},
      {"random blocks: seams", blocks.seam > tiling.seam && blocks.coh7 > tiling.coh7},
      {"blur: something missing", blur.com7 > blocks.com7}};
  std::string broken;
  for (const auto& [what, holds] : checks)
    if (!holds) broken += std::string(broken.empty() ? "" : "; ") + what;
  fmt::print("  controls: {}\n", broken.empty() ? "as they should be" : "NOT HELD: " + broken);
}

struct Verdict {
  bool gate = false, level = false;
};

// One line.
Verdict judged(const std::string& name, const PlaneMeasures& m, const Figures& gmic,
               const Figures& resynthesizer) {
  const auto worse = [&](double Figures::*f) { return std::max(gmic.*f, resynthesizer.*f); };
  const std::tuple<const char*, double, double> rows[] = {
      {"coh7", m.coh7, kCohFactor * worse(&Figures::coh7)},
      {"seam", m.seam, kCohFactor * worse(&Figures::seam)},
      {"com15", m.com15, kComFactor * worse(&Figures::com15)},
      {"grad", m.grad, kMostGrad},
      {"acf", m.acf, kMostAcf}};
  bool passed = true;
  std::string text;
  for (const auto& [what, value, most] : rows) {
    passed &= value <= most;
    text += fmt::format("  {} {:.2f} {} {:.2f}", what, value, value <= most ? "<=" : ">", most);
  }
  const double level = std::max(kMostPer, worse(&Figures::per));
  const Verdict out{.gate = passed && m.per <= kMostPer, .level = passed && m.per <= level};
  fmt::print("  gate {}: {}{}  per {:.2f} {} {:.2f} (peers' level {:.2f}: {})\n", name,
             out.gate ? "PASS" : "FAIL", text, m.per, m.per <= kMostPer ? "<=" : ">", kMostPer,
             level, out.level ? "passed" : "missed");
  return out;
}

// Which programs there are, and how many samples they have passed.
struct Standing {
  struct Count {
    int gate = 0, level = 0;
    void add(Verdict verdict) { gate += verdict.gate, level += verdict.level; }
  };
  bool hasGmic = false;
  int cases = 0;
  Count gmic, dapple;
};

void runCase(const Case& c, const Arguments& arguments, Workers& workers, Standing& standing) {
  const fs::path from = fs::path(DAPPLE_SHARED_DATA) / "textures" / c.file;
  if (!fs::exists(from)) return fmt::print("{}: not there\n", from.string());
  const Image whole = readImage(from);
  const Image sample = sampleOf(whole, kSample);
  const fs::path in = arguments.folder / c.file;
  writeImage(in, sample);
  fmt::print("{} ({} x {})\n  {:<18}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}\n", c.file,
             sample.width, sample.height, "", "coh7", "seam", "coh15", "com7", "com15", "swd",
             "grad", "acf", "per");
  std::vector<PlaneMeasures> controls;
  for (const auto& [name, picture] :
       {std::pair("tiling", tiled(sample)), std::pair("random pixels", randomPixels(sample)),
        std::pair("random blocks", randomBlocks(sample)),
        std::pair("blurred tiling", blurred(tiled(sample)))}) {
    controls.push_back(measurePlane(sample, picture, workers));
    printRow(name, controls.back());
  }
  checkControls(controls[0], controls[1], controls[2], controls[3]);
  ++standing.cases;
  Figures gmic = c.gmic;
  for (const auto& [name, f] :
       {std::pair("G'MIC, earlier", c.gmic), std::pair("Resynthesizer p30", c.resynthesizer)})
    fmt::print("  {:<18}{:7.2f}{:7.2f}{:>21.2f}{:>28.2f}\n", name, f.coh7, f.seam, f.com15, f.per);
  if (!standing.hasGmic) {
    fmt::print("  {:<18}not there\n", kGmic.name);
  } else if (const auto m = measured(kGmic, sample, in, workers)) {
    gmic = {m->coh7, m->seam, m->com15, m->per};
    standing.gmic.add(judged(kGmic.name, *m, gmic, c.resynthesizer));
  }
  if (const auto m = measured(kDapple, sample, in, workers))
    standing.dapple.add(judged(kDapple.name, *m, gmic, c.resynthesizer));
}

Arguments parsed(int argc, char** argv) {
  Arguments out;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--quick")
      out.quick = true;
    else if (word == "--only" && i + 1 < argc)
      out.only = argv[++i];
    else if (word == "--keep" && i + 1 < argc)
      out.folder = argv[++i], out.keep = true;
    else
      throw InvalidInput(fmt::format("{}: give [--quick] [--only NAME] [--keep FOLDER]", word));
  }
  if (!out.keep)
    out.folder = fs::temp_directory_path() / fmt::format("dapple_plane_bench.{}", getpid());
  fs::create_directories(out.folder);
  return out;
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments arguments = parsed(argc, argv);
  Workers workers;
  Standing standing;
  standing.hasGmic = secondsOf("gmic -version").has_value();
  if (!standing.hasGmic)
    fmt::print("gmic is not there (Debian's package gmic): its earlier figures count\n");
  for (const Case& c : kCases) {
    if (!arguments.only.empty() && std::string(c.file).find(arguments.only) == std::string::npos)
      continue;
    runCase(c, arguments, workers, standing);
    if (arguments.quick && standing.cases == 3) break;
  }
  for (const auto& [what, count] : {std::pair("gate passed", &Standing::Count::gate),
                                    std::pair("peers' level reached", &Standing::Count::level)})
    fmt::print("{}: G'MIC {}, Dapple {} of {}\n", what,
               standing.hasGmic ? fmt::format("{}", standing.gmic.*count) : "not there",
               standing.dapple.*count, standing.cases);
  if (!arguments.keep) fs::remove_all(arguments.folder);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "dapple_plane_bench: {}\n", error.what());
  return 2;
}
