#include "document/project_io.h"

#include <doctest/doctest.h>

#include <fstream>
#include <sstream>

#include "base/errors.h"
#include "document_fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

namespace fs = std::filesystem;

// Two regions, strokes, a crop, blended gaps, a locked region, a selection.
Document fullDocument(const TestFolder& folder) {
  Document d = sphereDocument(folder, 1200);
  d = applied(d, Select{.points = half(d, true)});
  d = applied(d, AddRegion{.name = "Left \"half\"\n# Größe"});
  d = applied(
      d, SetSwatch{.region = 1,
                   .reference = {.path = folder / "bricks.png", .crop = PixelRect{3, 4, 30, 32}}});
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = folder / "noise.png"}});
  TextureOptions options;
  options.method = Method::Patches, options.repair = 0;  // blends
  options.scale = 1.25;
  d = applied(d, SetRegion{.region = 0, .rotation = 12.5, .borderWidth = 2, .options = options});
  Stroke stroke = meridian(d);
  stroke.scale = 1.5f;
  d = applied(d, AddStroke{.region = 0, .stroke = stroke});
  d = applied(d, AddStroke{.region = 1, .stroke = meridian(d, 3)});
  d = applied(d, Synthesize{});
  d = applied(d, SetRegion{.region = 1, .visible = false, .locked = true});
  d = applied(d, MoveRegion{.region = 1, .position = 0});
  return applied(d, Select{.points = {0, 7, 1199}});
}

Document opened(const std::string& path, const std::string& scan = "",
                std::vector<std::string>* notes = nullptr) {
  CommandContext context = testContext();
  context.note = [&](const std::string& text) {
    if (notes) notes->push_back(text);
  };
  return applied(emptyDocument(), OpenProject{.path = path, .scan = scan}, context);
}

std::string contentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// The file with the first `from` replaced, which is there.
std::string replaced(std::string bytes, const std::string& from, const std::string& to) {
  const std::size_t at = bytes.find(from);
  REQUIRE(at != std::string::npos);
  return bytes.replace(at, from.size(), to);
}

std::string messageOf(const std::string& path) {
  try {
    opened(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a project that is saved and opened again is the same document, byte for byte") {
  const TestFolder folder;
  const Document d = fullDocument(folder);
  REQUIRE(!d.results.sources[0]->blended.empty());
  applied(d, SaveProject{.path = folder / "a.dapple"});
  const Document again = opened(folder / "a.dapple");
  CHECK(sameContent(again, d));
  CHECK(*again.results.texel == *d.results.texel);
  CHECK(findRegion(again, 1)->swatch->width == 30);
  CHECK(again.results.sources[0]->swatch ==
        findRegion(again, d.results.sources[0]->region)->swatch);
  applied(again, SaveProject{.path = folder / "b.dapple"});
  CHECK(contentOf(folder / "a.dapple") == contentOf(folder / "b.dapple"));
}

TEST_CASE("a project without regions, selection or results is saved too") {
  const TestFolder folder;
  const Document d = sphereDocument(folder, 400);
  applied(d, SaveProject{.path = folder / "a.dapple"});
  CHECK(sameContent(opened(folder / "a.dapple"), d));
  CHECK_THROWS_AS(applied(emptyDocument(), SaveProject{.path = folder / "b.dapple"}), InvalidInput);
  CHECK(!fs::exists(folder / "b.dapple"));
}

TEST_CASE("random directions of a project from before there were fields are a random field") {
  const TestFolder folder;
  applied(sphereDocument(folder, 400), SaveProject{.path = folder / "a.dapple"});
  std::string bytes = contentOf(folder / "a.dapple");
  bytes = replaced(bytes, "\"field\": \"smooth\"", "\"random-directions\": \"yes\"");
  std::ofstream(folder / "b.dapple", std::ios::binary) << bytes;
  CHECK(findRegion(opened(folder / "a.dapple"), 0)->options.field == FieldMethod::Smooth);
  CHECK(findRegion(opened(folder / "b.dapple"), 0)->options.field == FieldMethod::Random);
}

TEST_CASE("a folder with project and scan can be moved as a whole") {
  const TestFolder folder;
  fs::create_directories(folder / "one");
  writeSphere(folder, 400, "one/scan.xyz");
  const Document d = applied(emptyDocument(), OpenScan{.path = folder / "one/scan.xyz"});
  applied(d, SaveProject{.path = folder / "one/p.dapple"});
  fs::rename(folder / "one", folder / "two");
  CHECK(opened(folder / "two/p.dapple").scan->path == folder / "two/scan.xyz");
  // And the project alone: its absolute place still holds.
  fs::rename(folder / "two", folder / "one");
  fs::create_directories(folder / "three/four");
  fs::rename(folder / "one/p.dapple", folder / "three/four/p.dapple");
  CHECK(opened(folder / "three/four/p.dapple").size() == 400);
}

TEST_CASE("a missing scan is named with both places, and can be pointed to") {
  const TestFolder folder;
  const Document d = fullDocument(folder);
  applied(d, SaveProject{.path = folder / "a.dapple"});
  fs::rename(folder / "sphere.xyz", folder / "moved.xyz");
  const std::string message = messageOf(folder / "a.dapple");
  CHECK(message.find(folder / "sphere.xyz") != std::string::npos);
  CHECK(message.find("put it there") != std::string::npos);
  const Document again = opened(folder / "a.dapple", folder / "moved.xyz");
  CHECK(*again.results.colour == *d.results.colour);
  writeSphere(folder, 1200, "sphere.xyz");
  std::ofstream(folder / "sphere.xyz", std::ios::app) << "# changed\n";
  CHECK(messageOf(folder / "a.dapple").find("is not the scan") != std::string::npos);
}

TEST_CASE("a missing swatch is noted and the result stays") {
  const TestFolder folder;
  const Document d = fullDocument(folder);
  applied(d, SaveProject{.path = folder / "a.dapple"});
  std::string bytes = contentOf(folder / "a.dapple");
  for (int place = 0; place < 2; ++place) bytes = replaced(bytes, "noise.png", "absent.png");
  write(folder / "b.dapple", bytes);
  std::vector<std::string> notes;
  const Document again = opened(folder / "b.dapple", "", &notes);
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("Whole scan") != std::string::npos);
  CHECK(!findRegion(again, 0)->swatch);
  CHECK(*again.results.colour == *d.results.colour);
}

TEST_CASE("a project that is cut off anywhere is refused by name") {
  const TestFolder folder;
  applied(fullDocument(folder), SaveProject{.path = folder / "a.dapple"});
  const std::string bytes = contentOf(folder / "a.dapple");
  for (std::size_t piece = 0; piece < 64; ++piece) {
    const std::size_t length = bytes.size() * piece / 64;
    write(folder / "cut.dapple", bytes.substr(0, length));
    CAPTURE(length);
    CHECK(messageOf(folder / "cut.dapple").find("cut.dapple") != std::string::npos);
  }
}

TEST_CASE("projects of another version, or that do not fit together, are refused with the reason") {
  const TestFolder folder;
  applied(fullDocument(folder), SaveProject{.path = folder / "a.dapple"});
  const std::string bytes = contentOf(folder / "a.dapple");
  struct Damage {
    std::string from, to, expected;
  };
  for (const Damage& damage : {
           Damage{"\"version\": 1", "\"version\": 7", "version 7"},
           Damage{"\"version\": 1", "\"version\": \"\"", "no version"},
           Damage{"Dapple project", "Another project", "no Dapple project"},
           Damage{"\"points\": 1200", "\"points\": 1100", "1200 points"},
           Damage{"\"regions\"", "\"regons\"", "regions"},
           Damage{"property ushort source\nproperty float texel_x",
                  "property ushort source\nproperty float texel_q", "texel_x"},
           Damage{"property uchar region", "property char region", "'region'"},
           Damage{"\"method\": \"patches\"", "\"method\": \"magic\"", "magic"},
           Damage{"\"id\": 1", "\"id\": 0", "two regions"},
           Damage{"\"id\": 1", "\"id\": 9", "region 1"},
           Damage{"\"id\": 1", "\"id\": -1", "id"},
           Damage{"\"hash\": \"", "\"hash\": \"0", "is not the scan"},
           Damage{"comment {", "comment [", "no JSON"},
       }) {
    write(folder / "bad.dapple", replaced(bytes, damage.from, damage.to));
    const std::string message = messageOf(folder / "bad.dapple");
    CAPTURE(damage.to);
    CAPTURE(message);
    CHECK(message.find("bad.dapple") != std::string::npos);
    CHECK(message.find(damage.expected) != std::string::npos);
  }
  write(folder / "text.dapple", "hello");
  CHECK(messageOf(folder / "text.dapple").find("no Dapple project") != std::string::npos);
}

TEST_CASE("random bytes changed in a project never crash it") {
  const TestFolder folder;
  applied(fullDocument(folder), SaveProject{.path = folder / "a.dapple"});
  const std::string bytes = contentOf(folder / "a.dapple");
  for (std::size_t round = 0; round < 60; ++round) {
    std::string bad = bytes;
    // Two thirds of them in the header, where they hurt.
    const std::size_t span = round % 3 < 2 ? 6000 : bytes.size();
    for (std::size_t c = 0; c < 4; ++c)
      bad[(round * 7919 + c * 104729) % std::min(span, bad.size())] ^=
          static_cast<char>(1 + (round + c) % 255);
    write(folder / "bad.dapple", bad);
    try {
      const Document d = opened(folder / "bad.dapple");
      CHECK(d.labels->size() == d.size());
    } catch (const std::runtime_error& error) {
      CHECK(std::string(error.what()).size() > 10);
    }
  }
}

TEST_CASE("a save that fails leaves the old project as it was") {
  const TestFolder folder;
  const Document d = sphereDocument(folder, 400);
  applied(d, SaveProject{.path = folder / "a.dapple"});
  const std::string before = contentOf(folder / "a.dapple");
  std::stop_source stop;
  stop.request_stop();
  Workers workers;
  Monitor monitor(workers, stop.get_token());
  CHECK_THROWS_AS(saveProject(fullDocument(folder), folder / "a.dapple", monitor), Cancelled);
  CHECK_THROWS_AS(applied(d, SaveProject{.path = folder / "no/folder/a.dapple"}), IoError);
  CHECK(contentOf(folder / "a.dapple") == before);
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(folder / "a.dapple").parent_path()))
    files += entry.path().filename().string().starts_with(".") ? 1 : 0;
  CHECK(files == 0);
}
