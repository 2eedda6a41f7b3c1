#include "document/strokes_file.h"

#include <doctest/doctest.h>

#include <fstream>

#include "base/errors.h"
#include "document/project_io.h"
#include "document_fixtures.h"
#include "fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

struct Scene {
  TestFolder folder;
  PointSet points = makeSphere(4000, 1);
  Neighborhoods neighborhoods = neighbourhoods(points);
  Workers workers{1};
  Monitor monitor{workers};

  Scene() {
    points.origin = {100, 200, 300};
    points.modelUnits = 4;
  }
  std::vector<NamedStroke> read(const std::string& text) {
    const std::string path = folder / "strokes.json";
    std::ofstream(path) << text;
    return readStrokes(path, points, neighborhoods, monitor);
  }
  std::vector<NamedStroke> readOne(const std::string& stroke) {
    return read(R"({"format": "dapple-strokes", "version": 1, "strokes": [)" + stroke + "]}");
  }
  // The message of the refusal, which has to name the file.
  std::string refusal(const std::string& text, bool whole = false) {
    try {
      whole ? read(text) : readOne(text);
    } catch (const InvalidInput& error) {
      CHECK(std::string(error.what()).find("strokes.json: ") != std::string::npos);
      return error.what();
    }
    return "";
  }
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != text.npos;
}

}  // namespace

TEST_CASE("a line in model units is laid onto the surface without gaps") {
  Scene scene;
  const auto strokes = scene.readOne(
      R"({"positions": [[104, 200, 300], [102.9, 202.9, 300], [100, 204, 300]],
          "weight": 3, "scale": 0.5, "region": "Roof"})");
  REQUIRE(strokes.size() == 1);
  const Stroke& stroke = strokes[0].stroke;
  CHECK(strokes[0].region == "Roof");
  CHECK(stroke.weight == 3);
  CHECK(stroke.scale == 0.5f);
  CHECK_NOTHROW(validate(stroke, scene.points.size()));
  CHECK(stroke.points.size() > 20);
  const auto spacing = static_cast<float>(meanSpacing(scene.neighborhoods, scene.points.positions));
  for (std::size_t i = 0; i < stroke.points.size(); ++i) {
    CHECK(std::abs(glm::length(stroke.positions[i]) - 1) < 0.02f);
    CHECK(distanceBetween(stroke.positions[i], scene.points.positions[stroke.points[i]]) < spacing);
    if (i > 0) CHECK(stroke.points[i] != stroke.points[i - 1]);
    if (i > 0) CHECK(distanceBetween(stroke.positions[i], stroke.positions[i - 1]) < 3 * spacing);
  }
  CHECK(distanceBetween(stroke.positions.front(), {1, 0, 0}) < spacing);
  CHECK(distanceBetween(stroke.positions.back(), {0, 1, 0}) < spacing);
}

TEST_CASE("strokes survive being written and read") {
  Scene scene;
  const auto once = scene.read(R"({"format": "dapple-strokes", "version": 1, "strokes": [
      {"positions": [[104, 200, 300], [100, 204, 300]], "weight": 2, "region": "a \"b\""},
      {"positions": [[100, 200, 304], [100, 204, 300]], "scale": 3}]})");
  const std::string path = scene.folder / "again.json";
  writeStrokes(path, once, scene.points);
  const auto twice = readStrokes(path, scene.points, scene.neighborhoods, scene.monitor);
  REQUIRE(twice.size() == 2);
  for (std::size_t s = 0; s < 2; ++s) {
    CHECK(twice[s].region == once[s].region);
    CHECK(twice[s].stroke.weight == once[s].stroke.weight);
    CHECK(twice[s].stroke.scale == once[s].stroke.scale);
    for (const Index i : once[s].stroke.points)
      CHECK(std::find(twice[s].stroke.points.begin(), twice[s].stroke.points.end(), i) !=
            twice[s].stroke.points.end());
  }
}

TEST_CASE("the strokes of a project are read for its own scan only") {
  TestFolder folder;
  Workers workers(1);
  Monitor monitor(workers);
  Document d = sphereDocument(folder, 600);
  const Stroke stroke = meridian(d);
  d = applied(d, AddStroke{.region = 0, .stroke = stroke});
  const std::string path = folder / "p.dapple";
  saveProject(d, path, monitor);
  const Neighborhoods& neighborhoods = d.scan->prepared.neighborhoods;
  const auto strokes = readStrokes(path, d.points(), neighborhoods, monitor);
  REQUIRE(strokes.size() == 1);
  CHECK(strokes[0].stroke == stroke);
  CHECK(strokes[0].region == findRegion(d, 0)->name);
  const PointSet other = makeSphere(500, 1);
  CHECK_THROWS_AS(readStrokes(path, other, neighbourhoods(other), monitor), InvalidInput);
  CHECK_THROWS_AS(readStrokes(folder / "none.json", d.points(), neighborhoods, monitor), IoError);
  CHECK(strokesFrom("", d.points(), neighborhoods, monitor).empty());
}

TEST_CASE("what is wrong with a file of strokes is said, with the stroke's number") {
  Scene scene;
  const std::string good = R"({"positions": [[104, 200, 300], [100, 204, 300]]})";
  CHECK(scene.readOne("").empty());
  CHECK(scene.readOne(good).size() == 1);
  CHECK(has(scene.refusal("no JSON", true), "dapple-strokes"));
  CHECK(has(scene.refusal("[]", true), "dapple-strokes"));
  CHECK(has(scene.refusal(R"({"format": "dapple-strokes", "version": 2, "strokes": []})", true),
            "version 2"));
  CHECK(has(scene.refusal(R"({"format": "dapple-strokes", "version": 1})", true), "\"strokes\""));
  CHECK(has(scene.refusal(good + ", 7"), "stroke 1: it is no object"));
  CHECK(has(scene.refusal("{}"), "stroke 0: it has no list \"positions\""));
  CHECK(has(scene.refusal(R"({"positions": [[104, 200, 300]]})"), "two or more"));
  CHECK(has(scene.refusal(R"({"positions": [[104, 200, 300], [100, 204]]})"), "position 1 is"));
  CHECK(has(scene.refusal(R"({"positions": [[104, 200, 300], [100, 204, "x"]]})"), "position 1"));
  CHECK(has(scene.refusal(R"({"positions": [[104, 200, 300], [1, 2, 3]]})"), "away from the scan"));
  CHECK(has(scene.refusal(R"({"positions": [[104, 200, 300], [104, 200, 300]]})"), "longer line"));
  CHECK(has(scene.refusal(R"({"weight": 0, "positions": [[104, 200, 300], [100, 204, 300]]})"),
            "stroke 0: its weight is 0"));
  CHECK(has(scene.refusal(R"({"scale": "b", "positions": [[104, 200, 300], [100, 204, 300]]})"),
            "its scale"));
  CHECK(has(scene.refusal(R"({"region": 7, "positions": [[104, 200, 300], [100, 204, 300]]})"),
            "its region"));
}
