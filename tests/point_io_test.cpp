#include "io/point_io.h"

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <sstream>

#include "base/hash_rng.h"
#include "scan_files.h"

using namespace dapple;
using namespace dapple::testing;

namespace {

const std::string kHeader =
    "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty "
    "double z\n{}end_header\n{}";

std::string makePly(std::size_t count, const std::string& properties, const std::string& rows) {
  return fmt::format(fmt::runtime(kHeader), count, properties, rows);
}

// Points on a wavy sheet, with floats as a file has them.
RecordTable makeCloud(std::size_t n, float scale) {
  std::array<std::vector<float>, 3> columns;
  for (std::size_t i = 0; i < n; ++i) {
    const float x = hashUniform(1, i, 0) * 3 + 7, y = hashUniform(1, i, 1);
    columns[0].push_back(scale * x);
    columns[1].push_back(scale * y);
    columns[2].push_back(scale * (x * y - 2));
  }
  RecordTable table;
  Element vertex{.name = "vertex", .count = n};
  setColumn(vertex, "x", std::span<const float>(columns[0]));
  setColumn(vertex, "y", std::span<const float>(columns[1]));
  setColumn(vertex, "z", std::span<const float>(columns[2]));
  table.elements.push_back(vertex);
  return table;
}

}  // namespace

TEST_CASE("points with holes and twins are set aside and their records found again") {
  const Folder folder;
  const Scan scan = load(folder.write(
      "a.ply",
      makePly(7,
              "property float nx\nproperty float ny\nproperty float nz\nproperty uchar "
              "red\nproperty uchar green\nproperty uchar blue\nelement face 4\nproperty list "
              "uchar int vertex_indices\n",
              "1 0 0 0 0 2 255 0 0\n"
              "nan 0 0 0 0 1 1 1 1\n"
              "0 0 0 0 0 1 0 255 0\n"
              "1 -0 0 0 1 0 9 9 9\n"
              "0 1 0 0 0 0 0 0 255\n"
              "0 inf 0 0 0 1 1 1 1\n"
              "1 1 0 0 3 0 0 0 51\n"
              "3 2 0 4\n3 2 3 4\n3 0 1 2\n3 0 3 4\n")));
  CHECK(scan.nonFinite == 2);
  CHECK(scan.duplicates == 1);
  CHECK(scan.table.find("vertex")->count == 7);
  CHECK(scan.record == std::vector<std::size_t>{2, 0, 4, 6});
  CHECK(scan.pointOf == std::vector<Index>{1, kNone, 0, 1, 2, kNone, 3});
  CHECK(scan.points.origin == dvec3(0.5, 0.5, 0));
  CHECK(scan.points.modelUnits == 1);
  CHECK(scan.points.positions[0] == vec3(-0.5f, -0.5f, 0));
  // The first record wins over its twin; a point without a normal takes its neighbour's.
  const std::vector<vec3> normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 1, 0}};
  CHECK(scan.points.normals == normals);
  const std::vector<vec3> colours = {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 0, 0.2f}};
  CHECK(scan.points.colours == colours);
  const std::vector<std::array<Index, 3>> triangles = {{0, 1, 2}, {0, 1, 2}};
  CHECK(scan.mesh.triangles == triangles);
  CHECK(byRecord(scan, std::vector<int>{10, 11, 12, 13}, -1) ==
        std::vector<int>{11, -1, 10, 11, 12, -1, 13});
}

TEST_CASE("every name and type of coordinates, normals and colours is understood") {
  const Folder folder;
  for (const char* names :
       {"x y z nx ny nz red green blue", "X Y Z normal_x normal_y normal_z r g b",
        "px py pz nx ny nz diffuse_red diffuse_green diffuse_blue",
        "position_x position_y position_z nx ny nz red green blue"})
    for (const char* type : {"uchar", "char", "ushort", "int", "float", "float1"}) {
      CAPTURE(names);
      CAPTURE(type);
      const bool fraction = std::string(type) == "float1";
      std::string text = "ply\nformat ascii 1.0\nelement vertex 2\n";
      std::istringstream words(names);
      std::string word;
      for (int i = 0; words >> word; ++i)
        text += fmt::format("property {} {}\n", i < 6 ? "float" : fraction ? "float" : type, word);
      const std::string full = fraction ? "1" : std::string(type) == "char" ? "-1" : "255";
      text += "end_header\n0 0 0 0 0 9 " + full + " 0 0\n1 2 4 0 0 -1 0 " + full + " 0\n";
      const Scan scan = load(folder.write("a.ply", text));
      REQUIRE(scan.points.size() == 2);
      CHECK(scan.points.normals[0] == vec3(0, 0, 1));
      CHECK(scan.points.colours[0] == vec3(1, 0, 0));
      CHECK(scan.points.colours[1] == vec3(0, 1, 0));
      CHECK(scan.points.modelUnits == 4);
    }
  const Scan deep = load(folder.write(
      "a.ply", makePly(2, "property ushort red\nproperty ushort green\nproperty ushort blue\n",
                       "0 0 0 65535 0 13107\n1 1 1 0 0 0\n")));
  CHECK(deep.points.colours[0] == vec3(1, 0, 0.2f));
}

TEST_CASE("a Gaussian splat's colour is its constant part, and normals of zero are none") {
  const Folder folder;
  const Scan scan = load(folder.write(
      "a.ply", makePly(2,
                       "property float nx\nproperty float ny\nproperty float nz\nproperty float "
                       "f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n",
                       "0 0 0 0 0 0 1 -9 9\n1 1 1 0 0 0 0 0 0\n")));
  CHECK(scan.points.normals.empty());
  CHECK(scan.points.colours[0].x == doctest::Approx(0.78209479));
  CHECK(scan.points.colours[0].y == 0);
  CHECK(scan.points.colours[0].z == 1);
  CHECK(scan.points.colours[1] == vec3(0.5f));
}

TEST_CASE("a scan 1024 times as large has the same local bits") {
  const Folder folder;
  save(folder / "a.ply", makeCloud(3000, 1));
  save(folder / "b.ply", makeCloud(3000, 1024));
  const Scan small = load(folder / "a.ply"), large = load(folder / "b.ply");
  CHECK(small.points.positions == large.points.positions);
  CHECK(small.record == large.record);
  CHECK(large.points.modelUnits == 1024 * small.points.modelUnits);
  CHECK(large.points.origin == 1024.0 * small.points.origin);
}

TEST_CASE("local points are in Morton order, within 1 of the origin, and lead back exactly") {
  const Folder folder;
  save(folder / "a.ply", makeCloud(3000, 0.01f));
  const Scan scan = load(folder / "a.ply");
  const std::vector<Index> order = mortonOrder(scan.points.positions);
  for (std::size_t i = 0; i < order.size(); ++i) REQUIRE(order[i] == i);
  const Element& vertex = *scan.table.find("vertex");
  float extent = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const vec3& p = scan.points.positions[i];
    const std::size_t r = scan.record[i];
    const dvec3 model(vertex.find("x")->at(r), vertex.find("y")->at(r), vertex.find("z")->at(r));
    REQUIRE(glm::distance(scan.points.origin + scan.points.modelUnits * dvec3(p), model) <
            1e-7 * scan.points.modelUnits);
    for (int c = 0; c < 3; ++c) extent = std::max(extent, 2 * std::abs(p[c]));
  }
  CHECK(extent >= 1);
  CHECK(extent < 2);
}

TEST_CASE("coordinates far from zero keep what doubles hold") {
  const Folder folder;
  const Scan scan = load(folder.write("a.xyz",
                                      "4500000.001 5400000 100\n4500000.002 5400000 100\n"
                                      "4500001 5400000.5 100\n"));
  CHECK(scan.points.size() == 3);
  const double step = static_cast<double>(scan.points.positions[scan.pointOf[1]].x) -
                      static_cast<double>(scan.points.positions[scan.pointOf[0]].x);
  CHECK(step * scan.points.modelUnits == doctest::Approx(0.001).epsilon(1e-3));
}

TEST_CASE("a scan of one place is one point in units of 1, and huge coordinates are no overflow") {
  const Folder folder;
  const Scan one = load(folder.write("a.xyz", "5 6 7\n5 6 7\n5 6 7\n"));
  CHECK(one.points.size() == 1);
  CHECK(one.duplicates == 2);
  CHECK(one.points.modelUnits == 1);
  CHECK(one.points.origin == dvec3(5, 6, 7));
  const Scan huge = load(folder.write("a.xyz", "1.7e308 0 0\n-1.7e308 0 0\n0 1e308 0\n"));
  CHECK(huge.points.size() == 3);
  for (const vec3& p : huge.points.positions) CHECK(std::isfinite(p.x + p.y + p.z));
}

TEST_CASE("points crowded into one cell by one far away take no longer than others") {
  const Folder folder;
  std::string text;
  for (int i = 0; i < 20000; ++i) text += fmt::format("{} 0 0\n", 1e-9 * (i % 500));
  text += "1000 0 0\n";
  const auto start = std::chrono::steady_clock::now();
  const Scan scan = load(folder.write("a.xyz", text));
  CHECK(scan.points.size() + scan.duplicates == 20001);
  CHECK(scan.duplicates >= 19500);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(2));
}

TEST_CASE("samples of a mesh replace its vertices") {
  const Folder folder;
  const fs::path path = folder.write(
      "a.ply", makePly(4, "element face 1\nproperty list uchar int vertex_indices\ncomment kept\n",
                       "0 0 5\n2 0 5\n2 2 5\n0 2 5\n4 0 1 2 3\n"));
  const Scan scan = load(path, {.samples = 1000, .seed = 3});
  CHECK(scan.pointOf.size() == 1000);
  CHECK(scan.points.size() == 1000);
  CHECK(scan.mesh.triangles.empty());
  CHECK(scan.table.elements.size() == 1);
  CHECK(scan.table.comments == std::vector<std::string>{"kept"});
  for (const vec3& n : scan.points.normals) REQUIRE(n == vec3(0, 0, 1));
  const Element& vertex = *scan.table.find("vertex");
  CHECK(vertex.find("x")->type == ScalarType::Float64);
  for (std::size_t r = 0; r < 1000; ++r) REQUIRE(vertex.find("z")->at(r) == 5);
  CHECK(contains(whyNot(folder.write("b.ply", makePly(1, "", "0 0 0\n")), {.samples = 10}),
                 "needs a mesh"));
}

TEST_CASE("what is no scan is refused with cause and remedy") {
  const Folder folder;
  CHECK(contains(whyNot(folder / "none.ply"), "no such file. Check"));
  CHECK(contains(whyNot(folder.path()), "a folder, not a file"));
  CHECK(contains(whyNot("/dev/zero"), "a device"));
  CHECK(contains(whyNot(folder.write("a.ply", "")), "empty"));
  CHECK(contains(whyNot(folder.write("a.ply", "solid cube\n")), "not a PLY file"));
  CHECK(contains(whyNot(folder.write("a.ply", makePly(0, "", ""))), "no points"));
  const std::string nan = makePly(3, "", "nan 0 0\n0 nan 0\n0 0 inf\n");
  CHECK(contains(whyNot(folder.write("a.ply", nan)), "none of the 3 points"));
  CHECK_THROWS_AS(load(folder / "a.ply"), InvalidInput);
}

TEST_CASE("a PLY under the name of an OBJ is read as what it is") {
  const Folder folder;
  CHECK(load(folder.write("a.obj", makePly(1, "", "0 0 0\n"))).format == "ply");
}

TEST_CASE("one thread and three give the same scan") {
  const Folder folder;
  save(folder / "a.ply", makeCloud(50000, 1));
  const auto loadWith = [&](unsigned threads) {
    Workers workers(threads);
    Monitor monitor(workers);
    return loadScan(folder / "a.ply", {}, monitor);
  };
  const Scan one = loadWith(1), three = loadWith(3);
  CHECK(one.points.positions == three.points.positions);
  CHECK(one.record == three.record);
}

TEST_CASE("loading and saving stop at once and leave nothing") {
  const Folder folder;
  const RecordTable table = makeCloud(200000, 1);
  save(folder / "a.ply", table);
  const std::string before = readBytes(folder / "a.ply");
  Workers workers(1);
  std::stop_source stop;
  std::size_t reports = 0;
  Monitor monitor(workers, stop.get_token(), {.progress = [&](const Progress&) {
                    if (++reports == 1) stop.request_stop();
                  }});
  CHECK_THROWS_AS(savePly(folder / "a.ply", makeCloud(200000, 2), false, monitor), Cancelled);
  CHECK_THROWS_AS(loadScan(folder / "a.ply", {}, monitor), Cancelled);
  CHECK(readBytes(folder / "a.ply") == before);
  CHECK(folder.files() == 1);
}

TEST_CASE("saving reports its progress") {
  const Folder folder;
  Workers workers(1);
  double last = 0;
  Stage stage = Stage::Load;
  Monitor monitor(workers, {}, {.progress = [&](const Progress& p) {
                    last = p.fraction;
                    stage = p.stage;
                  }});
  savePly(folder / "a.ply", makeCloud(500000, 1), true, monitor);
  CHECK(stage == Stage::Save);
  CHECK(last == 1.0);
}

TEST_CASE("a save that fails says why and leaves the old file alone") {
  const Folder folder;
  const RecordTable table = makeCloud(100000, 1);
  save(folder / "a.ply", table);
  const std::string before = readBytes(folder / "a.ply");
  const auto why = [&](const fs::path& path) {
    try {
      save(path, table);
    } catch (const IoError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(contains(why(folder / "none" / "b.ply"), "there is no folder"));
  CHECK(contains(why(folder / "a.ply" / "b.ply"), "is not a folder"));
  CHECK(contains(why(folder.path()), "a folder, not a file"));
  CHECK(contains(why(folder / (std::string(300, 'n') + ".ply")), "too long"));
  fs::create_symlink("/dev/full", folder / "full.ply");
  CHECK(contains(why(folder / "full.ply"), "the disk is full. Free some space"));
  CHECK(fs::is_character_file("/dev/full"));
  CHECK(readBytes(folder / "a.ply") == before);
  CHECK(folder.files() == 2);
}

TEST_CASE("saving through a link replaces what it leads to and keeps its permissions") {
  const Folder folder;
  save(folder / "real.ply", makeCloud(10, 1));
  ::chmod((folder / "real.ply").c_str(), 0640);
  fs::create_directory(folder / "links");
  fs::create_symlink("../real.ply", folder / "links" / "link.ply");
  save(folder / "links" / "link.ply", makeCloud(20, 1));
  CHECK(fs::is_symlink(folder / "links" / "link.ply"));
  CHECK(load(folder / "real.ply").points.size() == 20);
  CHECK((static_cast<int>(fs::status(folder / "real.ply").permissions()) & 0777) == 0640);
  CHECK(folder.files() == 2);
  // A link that leads to nothing yet.
  fs::create_symlink("new.ply", folder / "dangling.ply");
  save(folder / "dangling.ply", makeCloud(5, 1));
  CHECK(load(folder / "new.ply").points.size() == 5);
}

TEST_CASE("the shared scans load with the counts of their manifest") {
  struct Expected {
    const char* name;
    std::size_t records, triangles, duplicates;
    bool normals, colours;
  };
  for (const Expected& e : {Expected{"bunny.ply", 35947, 69451, 0, false, false},
                            Expected{"bunny_raw.ply", 362272, 0, 0, false, false},
                            Expected{"armadillo.obj", 43243, 86482, 0, false, false},
                            Expected{"parasaurolophus.ply", 28291, 54839, 0, true, false},
                            Expected{"lion.ply", 341989, 0, 134, false, true},
                            Expected{"kitten.xyz", 5210, 0, 0, true, false},
                            Expected{"train_3dgs_1000.ply", 1000, 0, 0, false, true}}) {
    const fs::path path = sharedModel(e.name);
    if (path.empty()) continue;
    CAPTURE(e.name);
    const Scan scan = load(path);
    CHECK(scan.pointOf.size() == e.records);
    CHECK(scan.duplicates == e.duplicates);
    CHECK(scan.nonFinite == 0);
    CHECK(scan.points.size() == e.records - e.duplicates);
    CHECK(scan.mesh.triangles.size() == e.triangles);
    CHECK(scan.points.normals.empty() == !e.normals);
    CHECK(scan.points.colours.empty() == !e.colours);
  }
}

TEST_CASE("a shared binary scan is saved as the bytes it came from") {
  const fs::path path = sharedModel("lion.ply");
  if (path.empty()) return;
  const Folder folder;
  save(folder / "lion.ply", load(path).table);
  CHECK(readBytes(folder / "lion.ply") == readBytes(path));
}
