#include <doctest/doctest.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/render/image_compare.h"
#include "cli_program.h"
#include "document/apply.h"
#include "io/image_io.h"

namespace dapple {
namespace {

using namespace testing;
using Json = nlohmann::json;

const std::vector<Arguments> kMethods{
    {"--method", "patches"},
    {"--method", "match"},
    {"--method", "coordinates"},
    {"--method", "mapping"},
    {"--method", "mapping", "--no-follow"},
    {"--method", "hybrid", "--gaps", "cut"},
    {"--method", "hybrid", "--gaps", "match"},
    {"--method", "triplanar"},
    {"--method", "random"},
};
constexpr std::size_t kPoints = 3000;

std::string swatch() {
  return asset("swatches/pebbles.png");
}

Arguments textureArguments(const std::string& scan, const std::string& output,
                           const Arguments& more = {}) {
  Arguments all{"texture", scan, "--swatch", swatch(), "-o", output};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

Arguments operator+(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != text.npos;
}

// A scan with everything that a reader may not know: colours, a list, other elements, comments.
std::string strangePly(const std::vector<Position>& points) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment keep me\nelement camera 1\nproperty float fov\nelement "
      "vertex "
      "{}\nproperty ushort intensity\nproperty double x\nproperty double y\nproperty double z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty list uchar int "
      "tags\n"
      "element marker 2\nproperty list uchar short codes\nend_header\n42.5\n",
      points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    text += fmt::format("{} {} {} {} 1 2 3 2 {} -7\n", i, points[i][0], points[i][1], points[i][2],
                        i * 3);
  return text + "2 5 -6\n0\n";
}

std::vector<std::array<int, 3>> coloursOf(const std::string& path) {
  std::vector<std::array<int, 3>> colours;
  for (const std::string& line : readPlyText(path).body) {
    const auto words = wordsOf(line);
    REQUIRE(words.size() == 6);
    colours.push_back({std::stoi(words[3]), std::stoi(words[4]), std::stoi(words[5])});
  }
  return colours;
}

std::vector<std::string> propertiesOf(const PlyText& ply, const std::string& element) {
  std::vector<std::string> names;
  bool inside = false;
  for (const std::string& line : ply.header) {
    if (line.starts_with("element ")) inside = wordsOf(line)[1] == element;
    if (inside && line.starts_with("property ")) names.push_back(wordsOf(line).back());
  }
  return names;
}

std::size_t countOf(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::count(names.begin(), names.end(), name));
}

bool allNumbersFinite(const Json& json) {
  if (json.is_structured())
    return std::all_of(json.begin(), json.end(), [](const Json& j) { return allNumbersFinite(j); });
  return !json.is_null() && (!json.is_number() || std::isfinite(json.get<double>()));
}

// The one figure that is not known of every swatch: those here have no direction.
void takeOutDirection(Json& score) {
  REQUIRE(score.contains("direction_error"));
  CHECK(score["direction_error"].is_null());
  score.erase("direction_error");
}

const std::vector<const char*> kScoreKeys{
    "F", "F_oriented", "c1", "c2", "c4", "defects", "sw", "seam_error", "breaks", "gap_contrast"};

TEST_CASE("every method colours the points in their order and keeps the rest of the file") {
  const TemporaryFolder folder;
  const auto points = spherePoints(kPoints, 1);
  const std::string scan = folder.write("in.ply", strangePly(points)), out = folder / "out.ply";
  for (const Arguments& method : kMethods) {
    const std::string name = method.back();
    CAPTURE(name);
    const Run run = dapple(textureArguments(scan, out, method + Arguments{"--ascii", "--quiet"}));
    REQUIRE_MESSAGE(run.code == 0, run.err);
    const PlyText ply = readPlyText(out);
    CHECK(countOf(ply.header, "comment keep me") == 1);
    CHECK(propertiesOf(ply, "camera") == std::vector<std::string>{"fov"});
    CHECK(propertiesOf(ply, "marker") == std::vector<std::string>{"codes"});
    CHECK(countOf(ply.header, "property list uchar int tags") == 1);
    CHECK(countOf(ply.header, "property ushort intensity") == 1);
    CHECK(countOf(ply.header, "property double y") == 1);
    for (const char* colour : {"red", "green", "blue"})
      CHECK(countOf(propertiesOf(ply, "vertex"), colour) == 1);
    REQUIRE(ply.body.size() == kPoints + 3);
    CHECK(ply.body.front() == "42.5");
    CHECK(ply.body[kPoints + 1] == "2 5 -6");
    CHECK(ply.body[kPoints + 2] == "0");
    std::size_t wrong = 0, replaced = 0;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const auto words = wordsOf(ply.body[i + 1]);
      REQUIRE(words.size() == 10);
      bool same = words[0] == std::to_string(i) && words[7] == "2" &&
                  words[8] == std::to_string(3 * i) && words[9] == "-7";
      for (std::size_t c = 0; c < 3; ++c) same = same && std::stod(words[c + 1]) == points[i][c];
      wrong += !same;
      replaced += words[4] != "1" || words[5] != "2" || words[6] != "3";
    }
    CHECK(wrong == 0);
    CHECK(replaced > kPoints * 99 / 100);
  }
}

TEST_CASE("the source map, the old colours and the picture are written when asked for") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.ply", strangePly(spherePoints(kPoints, 1)));
  const std::string out = folder / "out.ply", picture = folder / "picture.png";
  const Run run = dapple(textureArguments(scan, out,
                                          {"--ascii", "--source-map", "--keep-colours", "--picture",
                                           picture, "--size", "400x300", "--quiet"}));
  REQUIRE_MESSAGE(run.code == 0, run.err);
  const PlyText ply = readPlyText(out);
  const auto names = propertiesOf(ply, "vertex");
  for (const char* name : {"swatch", "texel_x", "texel_y", "frame_sx", "frame_tz", "patch", "state",
                           "original_red", "original_green", "original_blue", "red"})
    CHECK_MESSAGE(countOf(names, name) == 1, name);
  const auto red = static_cast<std::size_t>(std::find(names.begin(), names.end(), "original_red") -
                                            names.begin());
  // The list of two is longer by two words, and comes after the old colours.
  CHECK(wordsOf(ply.body[1])[red] == "1");
  CHECK(wordsOf(ply.body[kPoints])[red + 2] == "3");
  const Image image = readImage(picture);
  CHECK(image.width == 400);
  CHECK(image.height == 300);
  const auto [low, high] = std::minmax_element(image.pixels.begin(), image.pixels.end());
  CHECK(*high - *low > 0.3f);
}

TEST_CASE("PLY, OBJ and XYZ with the same points give the same colours") {
  const TemporaryFolder folder;
  const auto points = spherePoints(kPoints, 1);
  const std::string inputs[] = {folder.write("a.ply", plyText(points)),
                                folder.write("b.obj", objText(points)),
                                folder.write("c.xyz", xyzText(points))};
  std::vector<std::vector<std::array<int, 3>>> colours;
  for (const std::string& scan : inputs) {
    const Run run = dapple(textureArguments(scan, folder / "out.ply", {"--ascii", "--quiet"}));
    REQUIRE_MESSAGE(run.code == 0, run.err);
    colours.push_back(coloursOf(folder / "out.ply"));
  }
  CHECK(colours[0].size() == kPoints);
  CHECK(colours[1] == colours[0]);
  CHECK(colours[2] == colours[0]);
}

TEST_CASE("one, two and three threads write the same bytes") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.xyz", xyzText(spherePoints(kPoints, 1)));
  for (const Arguments& method : kMethods) {
    std::string first;
    for (const char* threads : {"1", "2", "3"}) {
      CAPTURE(method.back());
      CAPTURE(threads);
      const Run run = dapple(
          textureArguments(scan, folder / "out.ply",
                           method + Arguments{"--threads", threads, "--source-map", "--quiet"}));
      REQUIRE_MESSAGE(run.code == 0, run.err);
      const std::string bytes = bytesOf(folder / "out.ply");
      if (first.empty()) first = bytes;
      CHECK(bytes.size() > kPoints * 15);
      CHECK((bytes == first));
    }
  }
}

TEST_CASE("millimetres or metres make no difference") {
  const TemporaryFolder folder;
  for (const Arguments& method : {kMethods[0], kMethods[1], kMethods[2]}) {
    std::vector<std::vector<std::array<int, 3>>> colours;
    for (const double factor : {1.0, 1000.0, 1024.0}) {
      const std::string scan = folder.write("in.xyz", xyzText(spherePoints(kPoints, factor)));
      const Run run = dapple(
          textureArguments(scan, folder / "out.ply", method + Arguments{"--ascii", "--quiet"}));
      REQUIRE_MESSAGE(run.code == 0, run.err);
      colours.push_back(coloursOf(folder / "out.ply"));
    }
    CAPTURE(method.back());
    CHECK((colours[2] == colours[0]));
    // 1000 is no power of two: coordinates round differently, and a tie may fall the other way,
    // which the repair of seams carries on to neighbours.
    std::size_t different = 0;
    for (std::size_t i = 0; i < kPoints; ++i) different += colours[1][i] != colours[0][i];
    CHECK(different <= kPoints / 25);
  }
}

// One run for all three: measuring the score takes seconds, however small the scan.
TEST_CASE("the report and the score are complete, and points set aside are written back in place") {
  const TemporaryFolder folder;
  auto points = spherePoints(kPoints, 1);
  points[5] = points[700];
  points[6] = points[700];
  points[10] = {std::nan(""), 0, 0};
  const std::string scan = folder.write("in.ply", plyText(points)), out = folder / "out.ply";
  const Run run = dapple(textureArguments(
      scan, out, {"--ascii", "--source-map", "--quiet", "--report", folder / "report.json"}));
  REQUIRE_MESSAGE(run.code == 0, run.err);

  const PlyText ply = readPlyText(out);
  REQUIRE(ply.body.size() == kPoints);
  for (const std::size_t i : {4u, 5u, 6u, 7u, 700u})
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::stod(wordsOf(ply.body[i])[c]) == points[i][c]);
  CHECK(std::isnan(std::stod(wordsOf(ply.body[10])[0])));
  for (const std::size_t c : {3u, 4u, 5u}) {
    CHECK(wordsOf(ply.body[5])[c] == wordsOf(ply.body[700])[c]);
    CHECK(wordsOf(ply.body[6])[c] == wordsOf(ply.body[700])[c]);
  }

  Json report = Json::parse(bytesOf(folder / "report.json"));
  for (const char* key : {"version", "method", "options", "seed", "threads", "points", "neighbours",
                          "spacing", "seconds", "points_per_second", "patches", "gap_share",
                          "matched_share", "distortion", "mapping", "peak_memory", "score"})
    CHECK_MESSAGE(report.contains(key), key);
  for (const char* key : {"load", "neighbours", "normals", "synthesis", "save"})
    CHECK_MESSAGE(report["seconds"].contains(key), key);
  for (const char* key : {"mean", "max"}) CHECK_MESSAGE(report["distortion"].contains(key), key);
  takeOutDirection(report["score"]);
  CHECK(allNumbersFinite(report));
  CHECK(report["points"] == kPoints - 3);
  CHECK(report["duplicates"] == 2);
  CHECK(report["non_finite"] == 1);
  CHECK(report["method"] == "hybrid");

  const Run scored = dapple({"score", out, "--swatch", swatch(), "--json", "--quiet"});
  REQUIRE_MESSAGE(scored.code == 0, scored.err);
  CHECK(scored.err.empty());
  Json score = Json::parse(scored.out);
  takeOutDirection(score);
  for (const char* key : kScoreKeys) {
    CHECK_MESSAGE(report["score"].contains(key), key);
    CHECK_MESSAGE(score.contains(key), key);
  }
  CHECK(allNumbersFinite(score));
  CHECK(score["F"].get<double>() ==
        doctest::Approx(report["score"]["F"].get<double>()).epsilon(0.1));
  // One definition: against the directions asked for, not against the patches' own frames.
  CHECK(score["F_oriented"].get<double>() ==
        doctest::Approx(report["score"]["F_oriented"].get<double>()).epsilon(0.1));
}

// What a refusal must be: code 2, a message that names the culprit and more, nothing new in the
// folder.
void checkRefused(const TemporaryFolder& folder, const Arguments& arguments,
                  const std::string& culprit, const std::string& remedy) {
  const auto before = folder.names();
  const Run run = dapple(arguments + Arguments{"--quiet"});
  CAPTURE(run.err);
  CHECK(run.code == 2);
  CHECK(contains(run.err, culprit));
  CHECK(contains(run.err, remedy));
  CHECK(run.out.empty());
  CHECK(folder.names() == before);
}

TEST_CASE("a scan that cannot be worked with is refused") {
  const TemporaryFolder folder;
  const std::string good = plyText(spherePoints(kPoints, 1));
  std::string lies = good;
  lies.replace(lies.find("vertex 3000"), 11, "vertex 90000000000");
  std::string binaryLies =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\n"
      "property float x\nproperty float y\nproperty float z\nend_header\n";
  binaryLies += std::string(1200, 'x');
  const std::vector<Position> nans(kPoints, {std::nan(""), std::nan(""), std::nan("")});
  const std::vector<Position> equal(kPoints, {1, 2, 3});
  folder.write("text.ply", "this is no scan\n");
  folder.write("short.ply", good.substr(0, good.size() / 2));
  folder.write("lies.ply", lies);
  folder.write("binarylies.ply", binaryLies);
  folder.write("nan.ply", plyText(nans));
  folder.write("few.ply", plyText(spherePoints(7, 1)));
  folder.write("equal.ply", plyText(equal));
  folder.write("empty.ply", "");
  const std::vector<std::array<std::string, 2>> bad{{"missing.ply", "Check the name"},
                                                    {".", "Name a file in it"},
                                                    {"text.ply", ". "},
                                                    {"short.ply", ". "},
                                                    {"lies.ply", ". "},
                                                    {"binarylies.ply", ". "},
                                                    {"nan.ply", "Export the scan"},
                                                    {"few.ply", "fewer neighbours"},
                                                    {"equal.ply", "scan of more points"},
                                                    {"empty.ply", "Export or copy"}};
  for (const auto& [name, remedy] : bad) {
    CAPTURE(name);
    checkRefused(folder, textureArguments(folder / name, folder / "out.ply"), folder / name,
                 remedy);
  }
  checkRefused(folder, {"info", folder / "missing.ply"}, "missing.ply", "Check the name");
  checkRefused(folder, {"render", folder / "text.ply", "-o", folder / "out.png"}, "text.ply", ". ");
}

TEST_CASE("a swatch that cannot be worked with is refused") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.ply", plyText(spherePoints(kPoints, 1)));
  writeImage(folder / "one.png", Image{1, 1, 3, {0.5f, 0.5f, 0.5f}});
  folder.write("text.png", "this is no image\n");
  folder.write("short.png", bytesOf(swatch()).substr(0, 5000));
  const std::vector<std::array<std::string, 2>> bad{{"one.png", "larger image"},
                                                    {"text.png", ". "},
                                                    {"short.png", ". "},
                                                    {"missing.png", "Check the name"}};
  for (const auto& [name, remedy] : bad) {
    CAPTURE(name);
    checkRefused(folder, {"texture", scan, "--swatch", folder / name, "-o", folder / "out.ply"},
                 folder / name, remedy);
  }
}

TEST_CASE("an output that cannot be written is refused, and leaves nothing") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.ply", plyText(spherePoints(kPoints, 1)));
  const std::string out = folder / "out.ply", nowhere = folder / "nowhere/file";
  checkRefused(folder, textureArguments(scan, nowhere), nowhere, "Create it");
  checkRefused(folder, textureArguments(scan, out, {"--picture", nowhere + ".png"}), nowhere,
               "Create it");
  checkRefused(folder, textureArguments(scan, out, {"--report", nowhere}), nowhere, "Create it");
  checkRefused(folder, {"render", scan, "-o", nowhere + ".png"}, nowhere, "Create it");
  checkRefused(folder, textureArguments(scan, folder / "."), folder / ".", "Add a file name");
  checkRefused(folder, textureArguments(scan, folder / "out.stl"), "out.stl", ".ply");
  // Known before the work is done: nothing has been saved yet.
  checkRefused(folder, textureArguments(scan, out, {"--picture", folder / "p.foo"}), "p.foo",
               ".png");
  checkRefused(folder, {"render", scan, "-o", folder / "p.foo"}, "p.foo", ".png");
  if (!fs::exists("/dev/full")) {
    MESSAGE("skipped: no /dev/full");
    return;
  }
  fs::create_symlink("/dev/full", folder / "full.ply");
  checkRefused(folder,
               textureArguments(scan, folder / "full.ply", {"--picture", folder / "picture.png"}),
               "the disk is full", "Free some space");
}

TEST_CASE("options that make no sense are refused") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.ply", plyText(spherePoints(kPoints, 1)));
  const std::string out = folder / "out.ply";
  const std::vector<std::array<std::string, 3>> bad{{"--neighbours", "3", "8 to 128"},
                                                    {"--neighbours", "many", "8 to 128"},
                                                    {"--method", "magic", "hybrid|"},
                                                    {"--threads", "-1", "0 to 256"},
                                                    {"--up", "0,0,0", "not all 0"},
                                                    {"--scale", "nan", "0.01 to 100"},
                                                    {"--view", "inside", "front"},
                                                    {"--size", "0x7", "WIDTHxHEIGHT"},
                                                    {"--progress", "dots", "bar|lines"},
                                                    {"--tileable", "perhaps", "auto|yes|no"},
                                                    {"--field", "magnetic", "smooth|spread"},
                                                    {"--symmetry", "45", "none|180|90"},
                                                    {"--creases", "iron", "carry|break"},
                                                    {"--texels", "some", "auto|on|off"},
                                                    {"--show", "feelings", "colour"},
                                                    {"--shading", "sunny", "headlight"},
                                                    {"--background", "#12345g", "#rrggbb"},
                                                    {"--background", "1,2,256", "0 to 255"},
                                                    {"--renderer", "ray", "auto|gl|cpu"},
                                                    {"--sparkle", "9", "--help"}};
  for (const auto& [option, value, remedy] : bad) {
    CAPTURE(option);
    Arguments arguments = textureArguments(scan, out, {option, value});
    if (option == "--progress") {  // --quiet overrides it
      const Run run = dapple(arguments);
      CHECK(run.code == 2);
      CHECK(contains(run.err, remedy));
      continue;
    }
    checkRefused(folder, arguments, option == "--sparkle" ? option : value, remedy);
  }
  checkRefused(folder, {"render", scan, "-o", folder / "p.png", "--view", "inside"}, "inside",
               "front");
  checkRefused(folder, {"texture", scan, "-o", out}, "--swatch", "--help");
  // Before the work, not after it.
  checkRefused(folder, textureArguments(scan, out, {"--show", "patch", "--texels", "on"}),
               "--texels on", "--show colour");
  CHECK(dapple({"texture", scan, "-o", out}).err.starts_with("dapple: "));
  CHECK(dapple({"paint"}).code == 2);
  const Run edit = dapple({});  // the editor, which has no display here
  CHECK(edit.code == 2);
  CHECK(edit.err.find("display") != std::string::npos);
  CHECK(dapple({"texture", "--help"}).code == 0);
}

TEST_CASE("Ctrl-C stops a long job and leaves no file") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.xyz", xyzText(spherePoints(300000, 1)));
  const auto before = folder.names();
  Program program(textureArguments(scan, folder / "out.ply",
                                   {"--method", "match", "--no-coherent", "--progress", "lines"}));
  for (int i = 0; i < 500 && program.errors().empty(); ++i)  // a busy machine starts it late
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto sent = std::chrono::steady_clock::now();
  program.signal(SIGINT);
  const Run run = program.wait();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - sent;
  MESSAGE("from the signal to the end: ", taken.count(), " s");
  CHECK(run.code == 130);
  CHECK(contains(run.err, "nothing was written"));
  CHECK(taken.count() < 5);
  CHECK(folder.names() == before);
}

TEST_CASE("progress is JSON on request, and nothing with --quiet") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.xyz", xyzText(spherePoints(kPoints, 1)));
  const Run quiet = dapple(textureArguments(scan, folder / "out.ply", {"--quiet"}));
  CHECK(quiet.code == 0);
  CHECK(quiet.out.empty());
  CHECK(quiet.err.empty());

  const Run run = dapple(textureArguments(scan, folder / "out.ply", {"--progress", "json"}));
  REQUIRE(run.code == 0);
  std::vector<std::string> stages;
  for (const std::string& line : linesOf(run.err)) {
    const Json progress = Json::parse(line);
    for (const char* key : {"fraction", "points_per_second", "seconds_left"})
      REQUIRE_MESSAGE(progress.at(key).is_number(), line);
    CHECK(progress["fraction"] >= 0);
    CHECK(progress["fraction"] <= 1);
    stages.push_back(progress.at("stage"));
  }
  for (const char* stage : {"load", "neighbours", "normals", "synthesis", "save"})
    CHECK_MESSAGE(countOf(stages, stage) > 0, stage);
}

TEST_CASE("info describes a swatch by what auto goes by") {
  const Run run = dapple({"info", asset("swatches/bricks.png"), "--json", "--quiet"});
  REQUIRE_MESSAGE(run.code == 0, run.err);
  const Json info = Json::parse(run.out);
  CHECK(info["pattern"] == "regular");
  CHECK(info["symmetry"] == 1);
  CHECK(info["width"] == 144);
  CHECK(info["feature"] > 5);
}

TEST_CASE("auto says what it has chosen and why, and a named method is used as it is") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.xyz", xyzText(spherePoints(kPoints, 1)));
  const std::string report = folder / "report.json";
  const Run run = dapple({"texture", scan, "--swatch", asset("swatches/pebbles.png"), "-o",
                          folder / "out.ply", "--report", report});
  REQUIRE_MESSAGE(run.code == 0, run.err);
  CHECK(run.out.starts_with("auto: hybrid, repair 11, no follow\n  method hybrid: "));
  const Json automatic = Json::parse(bytesOf(report));
  CHECK(automatic["method"] == "hybrid");
  CHECK(automatic["options"]["follow"] == "no");
  CHECK(automatic["auto"]["swatch"]["pattern"] == "isotropic");
  CHECK(automatic["options"]["repair"] == "11");
  CHECK(automatic["auto"]["reasons"].size() == 3);
  const Run named = dapple({"texture", scan, "--swatch", asset("swatches/pebbles.png"), "-o",
                            folder / "out.ply", "--report", report, "--method", "hybrid"});
  REQUIRE(named.code == 0);
  CHECK(named.out.find("auto") == std::string::npos);
  CHECK(Json::parse(bytesOf(report))["auto"].is_null());
  CHECK(Json::parse(bytesOf(report))["options"]["follow"] == "yes");
}

TEST_CASE("info describes a scan as JSON") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.ply", strangePly(spherePoints(kPoints, 2)));
  const Run run = dapple({"info", scan, "--json", "--quiet"});
  REQUIRE_MESSAGE(run.code == 0, run.err);
  const Json info = Json::parse(run.out);
  for (const char* key : {"unit_guess", "normals", "components", "bounds"})
    CHECK_MESSAGE(info.contains(key), key);
  CHECK(info["points"] == kPoints);
  CHECK(info["colour"] == true);
  CHECK(info["normals"] == false);
  CHECK(info["components"] == 1);
  CHECK(info["duplicates"] == 0);
  CHECK(info["non_finite"] == 0);
  CHECK(info["bounds"]["high"][1].get<double>() == doctest::Approx(2).epsilon(0.01));
  // One point has about 4 pi r^2 / n of the surface.
  const double side = std::sqrt(4 * 3.14159 * 4 / kPoints);
  CHECK(info["spacing"].get<double>() == doctest::Approx(side).epsilon(0.2));
}

// Strokes up the scan's side, as a file.
std::string strokesFile(const TemporaryFolder& folder, const std::string& more = "") {
  return folder.write("strokes.json", R"({"format": "dapple-strokes", "version": 1, "strokes": [)"
                                      R"({"positions": [[2, 0, 0], [1.4, 0, 1.4], [0, 0, 2]])" +
                                          more + "}]}");
}

// The directions (up) of a scan that was written with them as text, by point.
std::vector<Position> directionsIn(const std::string& path) {
  const PlyText ply = readPlyText(path);
  const std::vector<std::string> names = propertiesOf(ply, "vertex");
  const auto column = [&](const char* name) {
    const auto at = std::find(names.begin(), names.end(), name);
    REQUIRE(at != names.end());
    return static_cast<std::size_t>(at - names.begin());
  };
  const std::array<std::size_t, 3> up{column("frame_tx"), column("frame_ty"), column("frame_tz")};
  std::vector<Position> out;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const auto words = wordsOf(ply.body[i]);
    out.push_back({std::stod(words[up[0]]), std::stod(words[up[1]]), std::stod(words[up[2]])});
  }
  return out;
}

TEST_CASE("field writes directions that follow the strokes of a file, and says how smooth") {
  const TemporaryFolder folder;
  const std::vector<Position> points = spherePoints(kPoints, 2);
  const std::string scan = folder.write("in.ply", plyText(points));
  const std::string out = folder / "field.ply";
  const Run plain = dapple({"field", scan, "-o", out, "--ascii", "--progress", "lines"});
  REQUIRE_MESSAGE(plain.code == 0, plain.err);
  CHECK(contains(plain.out, "their indices sum to 2;"));
  CHECK(countOf(propertiesOf(readPlyText(out), "vertex"), "scale") == 0);
  const std::vector<Position> upright = directionsIn(out);

  const std::string strokes = strokesFile(folder, R"(, "scale": 2)");
  const Run drawn = dapple({"field", scan, "-o", out, "--ascii", "--strokes", strokes});
  REQUIRE_MESSAGE(drawn.code == 0, drawn.err);
  CHECK(countOf(propertiesOf(readPlyText(out), "vertex"), "scale") == 1);
  const std::vector<Position> along = directionsIn(out);
  std::size_t near = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const auto& [x, y, z] = points[i];
    if (std::abs(y) > 0.1 || x < 0.2 || z < 0.2) continue;
    ++near;  // along the circle from x to z, where the upright field points to y
    CHECK(along[i][0] * -z / 2 + along[i][2] * x / 2 > 0.95);
    CHECK(upright[i][1] > 0.9);
  }
  CHECK(near > 10);
}

Document applied(const Document& document, const Command& command) {
  Workers workers;
  Monitor monitor(workers);
  return apply(document, command, {.readImage = readImage}, monitor);
}

// A sphere whose points with x > 0 are the region "Right", each half with a swatch of its own.
Document halves(const TemporaryFolder& folder) {
  const std::vector<Position> points = spherePoints(kPoints, 2);
  Document d = applied(emptyDocument(), OpenScan{.path = folder.write("in.ply", plyText(points))});
  std::vector<Index> right;
  for (Index i = 0; i < d.size(); ++i)
    if (d.points().positions[i].x > 0) right.push_back(i);
  d = applied(d, Select{.points = right});
  d = applied(d, AddRegion{.name = "Right"});
  d = applied(d, Select{});
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = swatch()}});
  return applied(d, SetSwatch{.region = 1, .reference = {.path = asset("swatches/scales.png")}});
}

TEST_CASE("bake textures a project's regions as the editor would, on any number of threads") {
  const TemporaryFolder folder;
  const Document document = halves(folder);
  const std::string project = folder / "work.dapple", out = folder / "out.ply",
                    again = folder / "again.ply", saved = folder / "saved.dapple";
  applied(document, SaveProject{project});
  applied(applied(document, Synthesize{}), ExportScan{.path = again});
  const Run run = dapple({"bake", project, "-o", out, "--save", saved, "--threads", "1"});
  REQUIRE_MESSAGE(run.code == 0, run.err);
  CHECK(contains(run.out, fmt::format("{} points in 2 regions", kPoints)));
  const std::string expected = bytesOf(again);
  CHECK(bytesOf(out) == expected);
  // What was saved needs nothing more; nor does a second bake of everything change anything.
  for (const Arguments& more : {Arguments{"--only-changed"}, Arguments{"--threads", "3"}}) {
    REQUIRE(dapple(Arguments{"bake", saved, "-o", out} + more).code == 0);
    CHECK(bytesOf(out) == expected);
  }
  // Borders in place of the project's: only points near x = 0 differ.
  REQUIRE(dapple({"bake", project, "-o", out, "--border", "hard", "--ascii"}).code == 0);
  const std::vector<std::array<int, 3>> hard = coloursOf(out);
  REQUIRE(
      dapple({"bake", project, "-o", out, "--border", "blend", "--border-width", "8", "--ascii"})
          .code == 0);
  const std::vector<std::array<int, 3>> blended = coloursOf(out);
  const std::vector<Position> points = spherePoints(kPoints, 2);
  const double spacing = std::sqrt(4 * 3.14159 * 4 / kPoints);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    if (hard[i] == blended[i]) continue;
    ++changed;
    CHECK(std::abs(points[i][0]) < 8 * spacing);
  }
  CHECK(changed > 100);
}

TEST_CASE("a project that cannot be baked is refused, and leaves nothing") {
  const TemporaryFolder folder;
  const std::string project = folder / "work.dapple", out = folder / "out.ply",
                    bare = folder / "bare.dapple";
  Document document = halves(folder);
  applied(applied(document, SetSwatch{.region = 0}), SaveProject{bare});
  const std::string image = folder.write("mine.png", bytesOf(swatch()));
  document = applied(document, SetSwatch{.region = 1, .reference = {.path = image}});
  applied(document, SaveProject{project});
  fs::remove(image);
  const Run gone = dapple({"bake", project, "-o", out});
  CHECK(gone.code == 2);
  CHECK(contains(gone.err, "\"Right\""));
  CHECK(contains(gone.err, image));
  const std::vector<std::string> before = folder.names();
  for (const auto& [more, why] : std::vector<std::pair<Arguments, std::string>>{
           {{"--border", "soft"}, "hard|blend|cut"},
           {{"--border-width", "-1"}, "border width"},
           {{"--scan", folder / "none.ply"}, "none.ply"},
           {{"--save", folder / "no/saved.dapple"}, "no/saved.dapple"}}) {
    const Run run = dapple(Arguments{"bake", bare, "-o", out} + more);
    CHECK(run.code == 2);
    CHECK_MESSAGE(contains(run.err, why), run.err);
  }
  CHECK(folder.names() == before);
  CHECK(dapple({"bake", folder / "in.ply", "-o", out}).code == 2);
}

TEST_CASE("synth2d makes an image of any size, tile one that repeats, and bad orders are refused") {
  const TemporaryFolder folder;
  const std::string large = folder / "large.png", tile = folder / "tile.png";
  const Run made = dapple({"synth2d", swatch(), "--size", "150x40", "-o", large, "--threads", "1"});
  REQUIRE(made.code == 0);
  CHECK(contains(made.out, "150 x 40 pixels"));
  const Image image = readImage(large);
  CHECK(image.width == 150);
  CHECK(image.height == 40);
  const std::string once = bytesOf(large);
  REQUIRE(dapple({"synth2d", swatch(), "--size", "150x40", "-o", large, "--threads", "3"}).code ==
          0);
  CHECK(bytesOf(large) == once);
  REQUIRE(dapple({"synth2d", swatch(), "--size", "150x40", "-o", large, "--seed", "2"}).code == 0);
  CHECK(bytesOf(large) != once);
  REQUIRE(dapple({"tile", swatch(), "--tileable", "no", "--size", "64x64", "-o", tile}).code == 0);
  CHECK(readImage(tile).width == 64);
  for (const Arguments& bad : {Arguments{"synth2d", swatch(), "-o", large},
                               {"synth2d", swatch(), "--size", "0x4", "-o", large},
                               {"tile", folder / "none.png", "-o", tile},
                               {"tile", swatch(), "-o", folder / "tile.txt"}}) {
    const Run run = dapple(bad);
    CHECK(run.code == 2);
    CHECK(!run.err.empty());
  }
}

TEST_CASE("texture follows the strokes of a file, and a bad one is refused") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.ply", plyText(spherePoints(kPoints, 2)));
  const std::string out = folder / "out.ply";
  REQUIRE(dapple(textureArguments(scan, out, {"--quiet"})).code == 0);
  const std::string without = bytesOf(out);
  const std::string strokes = strokesFile(folder);
  REQUIRE(dapple(textureArguments(scan, out, {"--quiet", "--strokes", strokes})).code == 0);
  CHECK(bytesOf(out) != without);
  fs::remove(out);
  strokesFile(folder, R"(, "weight": -1)");
  checkRefused(folder, textureArguments(scan, out, {"--strokes", strokes}), "stroke 0", "above 0");
  checkRefused(folder, textureArguments(scan, out, {"--strokes", scan}), "in.ply", "project");
  checkRefused(folder, {"field", scan, "-o", folder / "f.obj"}, "f.obj", ".ply");
  checkRefused(folder, {"field", scan, "-o", folder / "f.ply", "--strokes", folder / "no.json"},
               "no.json", "");
}

// DAPPLE_UPDATE_GOLDEN=1 rewrites the pictures: look at them before committing.
void checkGolden(const std::string& picture, const std::string& name) {
  CAPTURE(name);
  const std::string golden = fmt::format("{}/{}.png", DAPPLE_GOLDEN, name);
  if (std::getenv("DAPPLE_UPDATE_GOLDEN")) {
    fs::create_directories(DAPPLE_GOLDEN);
    fs::copy_file(picture, golden, fs::copy_options::overwrite_existing);
    MESSAGE("rewrote ", golden);
    return;
  }
  REQUIRE_MESSAGE(fs::exists(golden), golden, ": run once with DAPPLE_UPDATE_GOLDEN=1");
  const double error = structuralSimilarityError(readImage(picture), readImage(golden));
  const std::string actual = fmt::format("{}/{}.png", DAPPLE_GOLDEN_ACTUAL, name);
  if (error > 0.04) {
    fs::create_directories(DAPPLE_GOLDEN_ACTUAL);
    fs::copy_file(picture, actual, fs::copy_options::overwrite_existing);
  }
  CHECK_MESSAGE(error <= 0.04, "if the new picture is right: cp ", actual, " ", golden);
}

TEST_CASE("the demo scan looks as it did") {
  const TemporaryFolder folder;
  for (const std::string method : {"patches", "match", "hybrid"}) {
    const std::string picture = folder / (method + ".png");
    const Run run =
        dapple({"texture", asset("scans/creature.ply"), "--swatch", asset("swatches/pebbles.png"),
                "--method", method, "-o", folder / "out.ply", "--picture", picture, "--size",
                "300x300", "--quiet"});
    REQUIRE_MESSAGE(run.code == 0, run.err);
    checkGolden(picture, method);
  }
}

TEST_CASE("a turntable is as many pictures, half a turn apart front and back") {
  const TemporaryFolder folder;
  const std::string scan = asset("scans/creature.ply");
  const Run run = dapple({"render", scan, "-o", folder / "turn.png", "--turntable", "4", "--size",
                          "120x100", "--shading", "--quiet"});
  REQUIRE_MESSAGE(run.code == 0, run.err);
  CHECK(!fs::exists(folder / "turn.png"));
  CHECK(!fs::exists(folder / "turn_004.png"));
  std::vector<Image> pictures;
  for (int k = 0; k < 4; ++k)
    pictures.push_back(readImage(folder / fmt::format("turn_00{}.png", k)));
  // The outline from behind is the outline from the front, mirrored, but for perspective.
  const auto covered = [](const Image& image, int x, int y) { return image.at(x, y, 1) < 0.95f; };
  int same = 0, either = 0;
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 120; ++x) {
      const bool front = covered(pictures[0], x, y), back = covered(pictures[2], 119 - x, y);
      same += front && back, either += front || back;
    }
  CHECK(either > 1000);
  CHECK(same > 0.8 * either);
  CHECK(pictures[0].pixels != pictures[1].pixels);
  checkRefused(folder, {"render", scan, "-o", folder / "p.png", "--turntable", "1"}, "--turntable",
               "720");
}

TEST_CASE("a turntable is one file where the format can be animated") {
  const TemporaryFolder folder;
  const std::string scan = asset("scans/creature.ply");
  const auto before = folder.names();
  const Run run = dapple({"render", scan, "-o", folder / "turn.gif", "--turntable", "5", "--fps",
                          "20", "--size", "80x60", "--quiet"});
  REQUIRE_MESSAGE(run.code == 0, run.err);
  CHECK(folder.names().size() == before.size() + 1);
  const std::string bytes = bytesOf(folder / "turn.gif"), control("\x21\xf9\x04", 3);
  int pictures = 0;
  for (std::size_t at = bytes.find(control); at != bytes.npos; at = bytes.find(control, at + 1))
    ++pictures;
  CHECK(pictures == 5);
  checkRefused(folder, {"render", scan, "-o", folder / "p.gif", "--turntable", "5", "--fps", "0"},
               "--fps", "1");
}

TEST_CASE("every view looks as it did, drawn by OpenGL and by the processor") {
  const TemporaryFolder folder;
  const std::string scan = folder / "out.ply", picture = folder / "view.png";
  const Run run =
      dapple({"texture", asset("scans/creature.ply"), "--swatch", asset("swatches/pebbles.png"),
              "--method", "patches", "--source-map", "-o", scan, "--quiet"});
  REQUIRE_MESSAGE(run.code == 0, run.err);
  for (const std::string view : {"colour", "normals", "state", "patch", "distortion", "order"})
    for (const char* renderer : {"gl", "cpu"}) {
      CAPTURE(renderer);
      const Run drawn = dapple({"render", scan, "-o", picture, "--show", view, "--view", "iso",
                                "--size", "240x200", "--renderer", renderer, "--quiet"});
      REQUIRE_MESSAGE(drawn.code == 0, drawn.err);
      checkGolden(picture, "view_" + view);
    }
  for (const char* renderer : {"gl", "cpu"}) {
    CAPTURE(renderer);
    const Run drawn = dapple({"render", scan, "-o", picture, "--orthographic", "--size", "240x200",
                              "--renderer", renderer, "--quiet"});
    REQUIRE_MESSAGE(drawn.code == 0, drawn.err);
    checkGolden(picture, "orthographic");
  }
}

// The scan of a textured ascii PLY in three regions and what is in none, by height and side.
std::string withRegions(const PlyText& ply) {
  std::string text;
  std::size_t points = 0;
  bool inside = false;
  for (const std::string& line : ply.header) {
    if (line.starts_with("element ") || line == "end_header") {
      if (inside) text += "property int region\n";
      inside = line.starts_with("element vertex ");
      if (inside) points = std::stoul(wordsOf(line)[2]);
    }
    text += line + "\n";
  }
  std::vector<std::array<double, 2>> places;
  double low = 1e9, high = -1e9, left = 1e9, right = -1e9;
  for (std::size_t i = 0; i < points; ++i) {
    const auto words = wordsOf(ply.body[i]);
    places.push_back({std::stod(words[0]), std::stod(words[1])});
    left = std::min(left, places[i][0]), right = std::max(right, places[i][0]);
    low = std::min(low, places[i][1]), high = std::max(high, places[i][1]);
  }
  for (std::size_t i = 0; i < points; ++i) {
    const double across = (places[i][0] - left) / (right - left),
                 up = (places[i][1] - low) / (high - low);
    const int region = up > 0.65 ? 0 : up < 0.2 ? -1 : across > 0.5 ? 1 : 2;
    text += fmt::format("{} {}\n", ply.body[i], region);
  }
  for (std::size_t i = points; i < ply.body.size(); ++i) text += ply.body[i] + "\n";
  return text;
}

TEST_CASE("regions, coordinates, light, background and overlays look as they did") {
  const TemporaryFolder folder;
  const std::string picture = folder / "view.png";
  const Run run =
      dapple({"texture", asset("scans/creature.ply"), "--swatch", swatch(), "--method", "patches",
              "--source-map", "--ascii", "-o", folder / "out.ply", "--quiet"});
  REQUIRE_MESSAGE(run.code == 0, run.err);
  const std::string scan =
      folder.write("regions.ply", withRegions(readPlyText(folder / "out.ply")));
  const std::vector<std::pair<std::string, Arguments>> cases{
      {"view_regions", {"--show", "regions"}},
      {"view_coordinates", {"--show", "coordinates", "--swatch", swatch()}},
      {"shading_headlight", {"--shading"}},
      {"shading_studio", {"--shading", "studio"}},
      {"background_black", {"--show", "distortion", "--background", "black"}},
      {"overlay_regions", {"--overlay", "regions"}},
      {"overlay_directions", {"--overlay", "directions"}},
      {"view_bottom", {"--view", "bottom", "--background", "#203050"}}};
  for (const auto& [name, more] : cases)
    for (const char* renderer : {"gl", "cpu"}) {
      CAPTURE(renderer);
      Arguments all{"render", scan, "-o", picture, "--size", "240x200", "--renderer", renderer};
      if (name != "view_bottom") all = all + Arguments{"--view", "iso"};
      const Run drawn = dapple(all + more + Arguments{"--quiet"});
      REQUIRE_MESSAGE(drawn.code == 0, drawn.err);
      checkGolden(picture, name);
    }
  // Without the columns that they need.
  const std::string plain = asset("scans/creature.ply");
  for (const std::string overlay : {"directions", "regions"})
    checkRefused(folder, {"render", plain, "-o", folder / "p.png", "--overlay", overlay},
                 "--overlay " + overlay, overlay == "directions" ? "--source-map" : "'region'");
  checkRefused(folder, {"render", plain, "-o", folder / "p.png", "--show", "regions"}, "regions",
               "'region'");
  checkRefused(folder, {"render", plain, "-o", folder / "p.png", "--overlay", "stars"}, "stars",
               "directions");
}

TEST_CASE("--shading takes a word after it or none, wherever the scan stands") {
  const TemporaryFolder folder;
  const std::string scan = folder.write("in.xyz", xyzText(spherePoints(kPoints, 1)));
  const auto pixels = [&](const Arguments& arguments) {
    const Run run = dapple(Arguments{"render"} + arguments +
                           Arguments{"-o", folder / "p.png", "--size", "60x60", "--quiet"});
    REQUIRE_MESSAGE(run.code == 0, run.err);
    return readImage(folder / "p.png").pixels;
  };
  const auto lit = pixels({scan, "--shading", "headlight"});
  CHECK(pixels({"--shading", scan}) == lit);
  CHECK(pixels({scan, "--shading"}) == lit);
  CHECK(pixels({scan}) == lit);  // without colours: flat grey would show nothing
  CHECK(pixels({scan, "--shading", "off"}) != lit);
}

}  // namespace
// A map of one value all over, as large as the swatch.
Image evenMap(const std::vector<float>& value) {
  const Image colour = readImage(swatch());
  Image map{
      .width = colour.width, .height = colour.height, .channels = static_cast<int>(value.size())};
  for (int p = 0; p < map.width * map.height; ++p)
    map.pixels.insert(map.pixels.end(), value.begin(), value.end());
  return map;
}

TEST_CASE("a folder as a swatch gives its colours and channels, and without them its colours") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "stone");
  fs::copy_file(swatch(), folder / "stone/stone_diff_1k.png");
  writeImage(folder / "stone/stone_rough_1k.png", evenMap({0.25f}), true);
  writeImage(folder / "stone/stone_nor_gl_1k.png", evenMap({0.5f, 0.5f, 1}), true);
  const std::string scan = folder.write("s.xyz", xyzText(spherePoints(1000, 1)));
  const auto textured = [&](const std::string& given, const Arguments& more) {
    const Arguments all{"texture", scan, "--swatch", given, "-o", folder / "out.ply", "--ascii"};
    const Run run = dapple(all + more);
    REQUIRE_MESSAGE(run.code == 0, run.err);
    return readPlyText(folder / "out.ply");
  };
  const PlyText whole = textured(folder / "stone", {});
  const std::vector<std::string> columns = propertiesOf(whole, "vertex");
  const auto rough = std::find(columns.begin(), columns.end(), "roughness");
  REQUIRE(rough != columns.end());
  CHECK(countOf(columns, "mapped_nx") == 1);
  CHECK(countOf(columns, "height") == 0);
  REQUIRE(whole.body.size() >= 1000);
  for (std::size_t i = 0; i < 1000; ++i) {
    const double value =
        std::stod(wordsOf(whole.body[i])[static_cast<std::size_t>(rough - columns.begin())]);
    CHECK(std::abs(value - 0.25) < 1e-4);
  }
  const PlyText bare = textured(folder / "stone", {"--channel", "none"});
  CHECK(countOf(propertiesOf(bare, "vertex"), "roughness") == 0);
  CHECK(bare.body == textured(swatch(), {"--channel", "none"}).body);
}

TEST_CASE("channels of a swatch are written by point, found or named, and pictured") {
  const TemporaryFolder folder;
  fs::copy_file(swatch(), folder / "stone.png");
  writeImage(folder / "stone_rough.png", evenMap({0.25f}), true);
  writeImage(folder / "n.exr", evenMap({0.5f, 0.5f, 1}));
  const std::string scan = folder.write("s.xyz", xyzText(spherePoints(1000, 1)));
  const std::string out = folder / "out.ply";
  Run run = dapple({"texture", scan, "--swatch", folder / "stone.png", "-o", out, "--ascii",
                    "--channel", "auto", "--channel", "normal=" + (folder / "n.exr")});
  REQUIRE_MESSAGE(run.code == 0, run.err);
  const PlyText ply = readPlyText(out);
  std::vector<std::string> columns;
  for (const std::string& line : ply.header)
    if (line.starts_with("property")) columns.push_back(wordsOf(line).back());
  const auto at = [&](const std::string& name) {
    const auto found = std::find(columns.begin(), columns.end(), name);
    REQUIRE(found != columns.end());
    return static_cast<std::size_t>(found - columns.begin());
  };
  const std::size_t x = at("x"), rough = at("roughness"), nx = at("mapped_nx");
  for (std::size_t i = 0; i < ply.body.size(); ++i) {
    const auto words = wordsOf(ply.body[i]);
    CHECK(std::abs(std::stod(words[rough]) - 0.25) < 1e-4);
    CHECK(std::abs(std::stod(words[nx]) - std::stod(words[x])) < 0.12);  // of a sphere of radius 1
  }
  run = dapple({"render", out, "-o", folder / "r.png", "--size", "64x64", "--show", "roughness"});
  CHECK_MESSAGE(run.code == 0, run.err);
  run = dapple({"render", out, "-o", folder / "h.png", "--size", "64x64", "--show", "height"});
  CHECK(run.code == 2);
  CHECK(contains(run.err, "--channel"));
  for (const std::string& channel :
       {std::string("shine=n.png"), std::string("roughness"), "roughness=" + (folder / "no.png"),
        "roughness=" + asset("pictures/demo.png")})
    CHECK(
        dapple({"texture", scan, "--swatch", folder / "stone.png", "-o", out, "--channel", channel})
            .code == 2);
}

}  // namespace dapple
